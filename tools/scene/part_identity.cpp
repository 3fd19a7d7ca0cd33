#include "scene/part_identity.h"

#include <zlib.h>

#include <array>
#include <string>
#include <vector>

#include "scene/scene_source.h"

namespace thimble::tools {
namespace {

// A structure that is no compact tree, by the bytes that it would have as one; a grid by its bits.
void add_structure(const BuiltScene& built, CrcSum* sum) {
  const Structure& traced = built.traced();
  if (traced.kind == StructureKind::kDense) {
    const Vec3i size = traced.dense.size();
    std::vector<std::uint8_t> row(static_cast<std::size_t>(size.x + 7) / 8);
    for (Vec3i at; at.z < size.z; ++at.z) {
      for (at.y = 0; at.y < size.y; ++at.y) {
        row.assign(row.size(), 0);
        for (at.x = 0; at.x < size.x; ++at.x) {
          row[static_cast<std::size_t>(at.x) / 8] |=
              static_cast<std::uint8_t>(traced.dense.solid_at(at) ? 1U << (at.x & 7) : 0U);
        }
        sum->add(row);
      }
    }
    return;
  }
  if (traced.kind == StructureKind::kCompact) {
    sum->add({traced.compact.bytes(), traced.compact.size_bytes()});
    return;
  }
  std::vector<std::uint8_t> bytes(compact_bytes(compact_shape(traced.pool)));
  CompactTree tree;
  if (CompactTree::make(traced.pool, {bytes.data(), bytes.size()}, &tree) != Status::kOk) {
    throw InputError("is too large for parts of a picture with --structure pool");
  }
  sum->add(bytes);
}

}  // namespace

void CrcSum::add(std::span<const std::uint8_t> bytes) {
  crc_ = static_cast<std::uint32_t>(crc32_z(crc_, bytes.data(), bytes.size()));
}

void CrcSum::add(std::string_view text) {
  add(static_cast<std::int64_t>(text.size()));
  add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void CrcSum::add(std::int64_t number) {
  std::array<std::uint8_t, 8> bytes{};
  for (unsigned i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(number) >> (8 * i));
  }
  add(bytes);
}

std::uint32_t scene_crc32(const SceneSource& source, const BuiltScene& built) {
  CrcSum sum;
  sum.add_all(built.level(), built.structure() == StructureKind::kDense);
  add_structure(built, &sum);
  for (const Rgb8& color : built.palette()) {
    sum.add_all(color.r, color.g, color.b);
  }
  if (built.structure() == StructureKind::kCompact) {
    LitDescription lit = source.lighting();
    const UsedMaterials used = used_materials(built.compact());
    lit.find_glow(built.compact());
    add_lighting(lit, used, called_for(lit, used), built.level(), &sum);
  }
  return sum.value();
}

void add_camera(const SceneCamera& camera, CrcSum* sum) {
  sum->add_all(camera.is_perspective, camera.direction_bits, camera.fov_degrees.raw, camera.span.raw);
  sum->add_all(camera.eye.x.raw, camera.eye.y.raw, camera.eye.z.raw);
  sum->add_all(camera.target.x.raw, camera.target.y.raw, camera.target.z.raw);
  sum->add_all(camera.forward.x, camera.forward.y, camera.forward.z);
  sum->add_all(camera.up.x, camera.up.y, camera.up.z);
}

void add_lighting(const LitDescription& lit, const UsedMaterials& used, EffectSet effects, int level,
                  CrcSum* sum) {
  sum->add_all(effects, lit.rest.bounces);
  try {
    sum->add(lighting_section(lit, used, effects, level));
  } catch (const InputError&) {
    sum->add_all(lit.lights.size());  // beyond what bytes can say; drawing says why, or does without
  }
}

void add_look(const Look& look, int level, CrcSum* sum) {
  add_lighting(look.lighting, look.used, look.effects, level, sum);
  for (const Rgb8& color : look.palette) {
    sum->add_all(color.r, color.g, color.b);
  }
  const Rgb8 behind = look.background.color;
  sum->add_all(look.kind, look.has_own_colors, look.has_backdrop, look.background.kind, behind.r, behind.g,
               behind.b);
  sum->add_all(look.has_ground, look.ground_z, look.toward_sun.x, look.toward_sun.y, look.toward_sun.z,
               look.reach, look.across);
}

}  // namespace thimble::tools
