/// @file baked_damage.h
/// What must hold for any bytes whatever that are handed over as a baked scene: used by the tests and by the
/// fuzz target.
#ifndef THIMBLE_TESTS_SUPPORT_BAKED_DAMAGE_H
#define THIMBLE_TESTS_SUPPORT_BAKED_DAMAGE_H

#include <cstddef>
#include <cstdint>

#include "support/compact_damage.h"
#include "thimble/baked_scene.h"

namespace thimble::tests {

/// Opens `bytes` and does with the scene what a program may do: reads every section, makes the camera, traces
/// rays through the tree. Returns a phrase when a promise is broken, else nullptr. Reads outside the bytes
/// are for AddressSanitizer to see, so `bytes` should end where their memory ends.
inline const char* use_damaged(ConstBytes bytes, const Vec3i& direction) {
  const char* fault = BakedScene::validate(bytes);
  BakedScene scene;
  if (BakedScene::open(bytes, &scene) != Status::kOk) {
    return fault == nullptr ? "what does not open is valid" : nullptr;
  }
  if (scene.validate() != (fault == nullptr ? Status::kOk : Status::kDamaged)) {
    return "the two validate differ";
  }
  std::uint32_t sum = 0;
  for (std::uint32_t kind = 0; kind < 8; ++kind) {
    for (const std::uint8_t byte : scene.section(static_cast<SectionKind>(kind))) {
      sum += byte;
    }
  }
  for (const Rgb8& color : scene.palette()) {
    sum += color.g;
  }
  if (scene.bytes().size > bytes.size || scene.palette().size > kMaxPaletteColors || sum == UINT32_MAX) {
    return "more than there is";
  }
  if (scene.has_camera()) {
    Camera camera;
    // Square and one pixel: only what is wrong with the view itself could be refused.
    const Status status = make_camera(scene.camera(), 1, 1, scene.tree().level(), &camera);
    if (status == Status::kBadArgument) {
      return "a camera that makes no view";
    }
    if (status == Status::kOk) {
      if (const char* text = trace_damaged(scene.tree(), camera.ray(0, 0))) {
        return text;
      }
    }
  }
  const std::int32_t half = Q8::kOne << scene.tree().level() >> 1;
  Ray ray;
  for (int axis = 0; axis < 3; ++axis) {
    ray.direction[axis] = direction[axis] % (kMaxDirection + 1);
    ray.origin[axis] = Q8::from_raw(half - (ray.direction[axis] > 0 ? 3 * half : -3 * half));
  }
  if (check_ray(ray, scene.tree().level()) != Status::kOk) {
    return nullptr;  // no direction
  }
  return trace_damaged(scene.tree(), ray);
}

/// Puts the right checksum into a baked scene, and into its tree where it has one that opens; for damage that
/// they are not to catch. Bytes shorter than a header stay.
inline void repair_baked_checksums(Bytes bytes) {
  constexpr std::size_t kChecksumOffset = 8;
  BakedScene scene;
  if (BakedScene::open(bytes, &scene) == Status::kOk) {
    const std::size_t at = static_cast<std::size_t>(scene.tree().bytes() - bytes.data);
    repair_checksum(bytes.subspan(at, scene.tree().size_bytes()));
  }
  if (bytes.size < kBakedHeaderBytes) {
    return;
  }
  const std::size_t said = static_cast<std::size_t>(bytes[4]) | static_cast<std::size_t>(bytes[5]) << 8 |
                           static_cast<std::size_t>(bytes[6]) << 16 |
                           static_cast<std::size_t>(bytes[7]) << 24;
  const ConstBytes all = bytes.subspan(0, said);
  const std::uint32_t checksum =
      crc32(all.subspan(kChecksumOffset + 4), crc32(all.subspan(0, kChecksumOffset)));
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[kChecksumOffset + i] = static_cast<std::uint8_t>(checksum >> (8 * i));
  }
}

}  // namespace thimble::tests

#endif
