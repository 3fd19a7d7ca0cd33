#include "scene/lit_description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "readers/oct.h"
#include "thimble/trace/secondary_ray.h"

namespace thimble::tools {
namespace {

// A face that shows: the voxel before it is empty.
struct GlowingFace {
  Vec3i voxel;
  int axis;
  int out;  // 1 or -1
  std::uint8_t material;

  // Its middle, and a little before it, in voxels.
  double place(int of, double before = 0) const {
    return voxel[of] + (of == axis ? (out > 0 ? 1 : 0) + out * before : 0.5);
  }
};

std::vector<GlowingFace> glowing_faces(const CompactTree& tree, const std::vector<Surface>& surfaces) {
  std::vector<GlowingFace> faces;
  const auto glows = [](const Surface& surface) {
    return surface.kind == SurfaceKind::kEmit && surface.emission_q8 != 0;
  };
  if (std::none_of(surfaces.begin(), surfaces.end(), glows)) {
    return faces;
  }
  walk_blocks(tree, [&](const Vec3i& corner, int level, std::uint8_t material) {
    const Surface& surface = surfaces[material];
    if (!glows(surface)) {
      return;
    }
    const std::int32_t side = std::int32_t{1} << level;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int out : {-1, 1}) {
        for (std::int32_t u = 0; u < side; ++u) {
          for (std::int32_t v = 0; v < side; ++v) {
            Vec3i voxel = corner;
            voxel[axis] += out > 0 ? side - 1 : 0;
            voxel[axis == 0 ? 1 : 0] += u;
            voxel[axis == 2 ? 1 : 2] += v;
            Vec3i before = voxel;
            before[axis] += out;
            if (!material_at(tree, before, nullptr)) {
              faces.push_back({voxel, axis, out, material});
            }
          }
        }
      }
    }
  });
  return faces;
}

using Cube = std::array<std::int32_t, 3>;
Cube cube_of(const GlowingFace& face, int k) {
  return {face.voxel.x >> k, face.voxel.y >> k, face.voxel.z >> k};
}

Light lamp_of(const CompactTree& tree, const std::vector<Surface>& surfaces,
              const std::vector<const GlowingFace*>& faces) {
  std::array<double, 3> middle{};
  std::array<double, 3> outwards{};
  std::array<double, 3> shine{};
  const auto area = static_cast<double>(faces.size());
  for (const GlowingFace* face : faces) {
    const Surface& surface = surfaces[face->material];
    const std::array<std::uint8_t, 3> albedo{surface.albedo.r, surface.albedo.g, surface.albedo.b};
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<std::size_t>(i);
      middle[at] += face->place(i) / area;
      shine[at] += albedo[at] / 255.0 * surface.emission_q8;
    }
    outwards[static_cast<std::size_t>(face->axis)] += face->out / area;
  }
  const double one_way = std::min(1.0, std::hypot(outwards[0], outwards[1], outwards[2]));
  Light lamp;
  lamp.is_point = true;
  lamp.reach = 1;
  std::array<std::int32_t, 3> place{};
  for (std::size_t i = 0; i < 3; ++i) {
    lamp.color_q8[i] = static_cast<std::uint16_t>(
        std::clamp(std::lround(shine[i] / M_PI * (1 + one_way)), long{0}, long{65535}));
    place[i] = static_cast<std::int32_t>(std::floor((middle[i] + outwards[i] / 2) * Q8::kOne));
  }
  // Within something that does not glow nothing would come out of it: before the nearest face instead.
  std::uint8_t material = 0;
  if (material_at(tree, {place[0] >> Q8::kBits, place[1] >> Q8::kBits, place[2] >> Q8::kBits}, &material) &&
      surfaces[material].kind != SurfaceKind::kEmit) {
    const auto distance = [&](const GlowingFace* face) {
      return std::hypot(face->place(0) - middle[0], face->place(1) - middle[1], face->place(2) - middle[2]);
    };
    const GlowingFace* nearest = *std::min_element(
        faces.begin(), faces.end(),
        [&](const GlowingFace* a, const GlowingFace* b) { return distance(a) < distance(b); });
    for (std::size_t i = 0; i < 3; ++i) {
      place[i] = static_cast<std::int32_t>(std::floor(nearest->place(static_cast<int>(i), 0.5) * Q8::kOne));
    }
  }
  lamp.place = {place[0], place[1], place[2]};
  return lamp;
}

}  // namespace

std::vector<Light> glow_lamps(const CompactTree& tree, const std::vector<Surface>& surfaces,
                              std::size_t most) {
  const std::vector<GlowingFace> faces = glowing_faces(tree, surfaces);
  std::vector<Light> lamps;
  if (most == 0 || faces.empty()) {
    return lamps;
  }
  std::map<Cube, std::vector<const GlowingFace*>> cubes;
  for (int k = 0; k == 0 || cubes.size() > most; ++k) {
    cubes.clear();
    for (const GlowingFace& face : faces) {
      cubes[cube_of(face, k)].push_back(&face);
      if (cubes.size() > most) {
        break;
      }
    }
  }
  for (const auto& [cube, of_cube] : cubes) {
    lamps.push_back(lamp_of(tree, surfaces, of_cube));
  }
  return lamps;
}

}  // namespace thimble::tools
