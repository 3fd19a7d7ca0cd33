// Cameras of many kinds, and the CRC-32 of their rays that was written down: whatever changes a ray is seen here first. Whether they are right others say. The portable cases do the same for any-time frames and cut-offs.
#include <doctest/doctest.h>

#include <cstdint>
#include <random>

#include "support/scene_under_test.h"
#include "thimble/base/memory.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/render.h"

namespace thimble::tests {
namespace {

// A CRC-32 over numbers, whatever the machine's order of bytes.
struct Written {
  void add(std::int64_t number) {
    std::uint8_t bytes[8];
    for (int i = 0; i < 8; ++i) {
      bytes[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(number) >> (8 * i));
    }
    crc = crc32({bytes, 8}, crc);
  }
  void add(const Vec3i& vector) {
    for (int axis = 0; axis < 3; ++axis) {
      add(vector[axis]);
    }
  }
  std::uint32_t crc = 0;
};

std::int32_t up_to(std::mt19937_64& random, int bits) {
  const auto number = random();  // in an order that every compiler keeps
  const auto most = static_cast<unsigned>(1 + random() % static_cast<unsigned>(bits));
  const auto size = static_cast<std::int32_t>(number & ((std::uint64_t{1} << most) - 1));
  return random() % 2 == 0 ? -size : size;
}

void add_camera(const Camera& camera, Written* written) {
  for (const std::int32_t x : {0, camera.width_px() / 3, camera.width_px() - 1}) {
    for (const std::int32_t y : {0, camera.height_px() / 2, camera.height_px() - 1}) {
      const Ray ray = camera.ray(x, y);
      written->add(Vec3i{ray.origin.x.raw, ray.origin.y.raw, ray.origin.z.raw});
      written->add(ray.direction);
    }
  }
  written->add(camera.direction_bits());
  written->add(camera.depth_per_t_q8());
  written->add(camera.error_bound_px_q16());
  const std::int32_t side = std::int32_t{1} << camera.level();
  for (const VoxelBox& box :
       {VoxelBox{{0, 0, 0}, {side, side, side}}, VoxelBox{{1, 0, side / 2}, {2, 1, side}}}) {
    const DepthRange range = depth_range(camera, box);
    written->add(range.near_q8);
    written->add(range.far_q8);
  }
  for (const std::int32_t pixels_q16 : {1, 65536, 70000, 10 << 16, 512 << 16}) {
    Cutoff cutoff;
    written->add(static_cast<int>(cutoff.set(camera, Q16::from_raw(pixels_q16))));
    written->add(cutoff.level());
    for (const std::int32_t largest : {1, 100, 4095, 1 << 20}) {
      written->add(cutoff.reach_q8(largest));
    }
  }
}

// Numbers of every size, which a uniform choice would never give.
std::uint32_t cameras(bool perspective, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Written written;
  int made = 0;
  for (int number = 0; number < 3000; ++number) {
    const int level = static_cast<int>(1 + random() % 12);
    Vec3Q8 eye;
    Vec3i forward;
    Vec3i up;
    for (int axis = 0; axis < 3; ++axis) {
      eye[axis] = Q8::from_raw(up_to(random, 20));
      forward[axis] = number % 7 == 0 && axis != number % 3 ? 0 : up_to(random, 20);
      up[axis] = up_to(random, 14);
    }
    up = number % 2 == 0 ? default_up(forward) : up;
    const auto width = static_cast<std::int32_t>(1 + random() % (number % 5 == 0 ? 4096 : 300));
    const auto height = static_cast<std::int32_t>(1 + random() % (number % 5 == 0 ? 4096 : 300));
    const int bits = number % 3 == 0 ? static_cast<int>(8 + random() % 13) : 0;
    Camera camera;
    Status status = Status::kOk;
    if (perspective) {
      const Q16 fov = Q16::from_raw(static_cast<std::int32_t>(65536 + random() % (119 << 16)));
      status = camera.set(PerspectiveView{eye, forward, up, fov, width, height, bits}, level);
    } else {
      const Q14 span = Q14::from_raw(std::abs(up_to(random, 27)) + width * 400);
      status = camera.set(OrthographicView{eye, forward, up, span, width, height, bits}, level);
    }
    written.add(static_cast<int>(status));
    if (status == Status::kOk) {
      ++made;
      add_camera(camera, &written);
    }
  }
  CHECK(made > 500);
  return written.crc;
}

TEST_CASE("picture written: cameras of numbers of every size -> the CRC-32 of rays, depths and cut-offs") {
  CHECK(cameras(true, 20260901) == 401325518U);
  CHECK(cameras(false, 20260902) == 102344967U);
}

}  // namespace
}  // namespace thimble::tests
