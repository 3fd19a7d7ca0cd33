// A million rays from one place, all around, and how far each goes: lidar FILE > distances.f32, in rows of 2,000.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "thimble/files.h"

using namespace thimble;

int main(int count, char** words) {
  std::string error = "usage: lidar FILE";
  const auto scene = count < 2 ? nullptr : files::Scene::open(words[1], {}, &error);
  if (scene == nullptr) {
    std::fprintf(stderr, "lidar: %s\n", error.c_str());
    return 1;
  }
  constexpr int kAround = 2000, kRows = 500;
  constexpr double kPi = 3.14159265358979;
  const VoxelBox& box = scene->tree().bounds();
  std::vector<Ray> rays;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kAround; ++column) {
      const double up = (row + 0.5) * kPi / kRows - kPi / 2, turn = column * 2 * kPi / kAround;
      const auto along = [](double part) {
        return static_cast<std::int32_t>(std::lround(part * kMaxDirection));
      };
      Ray ray;  // from above the middle; units are 1/256 voxel
      ray.origin = {Q8::from_raw(128 * (box.low.x + box.high.x)),
                    Q8::from_raw(128 * (box.low.y + box.high.y)), Q8::from_raw(256 * box.high.z)};
      ray.direction = {along(std::cos(up) * std::cos(turn)), along(std::cos(up) * std::sin(turn)),
                       along(std::sin(up))};
      rays.push_back(ray);
    }
  }
  std::vector<Hit> hits(rays.size());
  const auto start = std::chrono::steady_clock::now();
  if (scene->trace({rays.data(), rays.size()}, {hits.data(), hits.size()}) != Status::kOk) return 1;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::vector<float> distances;
  std::size_t hit_count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& hit = hits[i];
    const double length = std::hypot(rays[i].direction.x, rays[i].direction.y, rays[i].direction.z);
    hit_count += hit.kind == HitKind::kHit ? 1 : 0;
    distances.push_back(hit.kind == HitKind::kHit
                            ? static_cast<float>(double(hit.t_numerator) / hit.t_denominator * length)
                            : std::numeric_limits<float>::infinity());
  }
  std::fprintf(stderr, "%zu rays in %.3f s, %.1f million a second; %zu hit\n", rays.size(), seconds,
               static_cast<double>(rays.size()) / seconds / 1e6, hit_count);
  return std::fwrite(distances.data(), sizeof(float), distances.size(), stdout) == distances.size() ? 0 : 1;
}
