/// @file voxel_faces.h
/// The surface of a voxel model as rectangles, for what draws triangles: a face of a voxel each, or faces of one
/// plane and material joined as far as they go.
#ifndef THIMBLE_TESTS_BENCHMARKS_VOXEL_FACES_H
#define THIMBLE_TESTS_BENCHMARKS_VOXEL_FACES_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/scene_source.h"
#include "thimble/trace/ray.h"

namespace thimble::benchmarks {

/// Voxels `low` to `high`, both included, show their faces towards +axis (`up`) or -axis; they lie in one plane.
struct FaceRect {
  Vec3i low;
  Vec3i high;
  int axis = 0;
  bool up = false;
  std::uint8_t material = 0;
};

class VoxelFaces {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// `joined`: whether faces are joined. Takes 25 bytes for every voxel of the world: levels up to 8.
  VoxelFaces(const tools::SceneSource& source, bool joined) : side_(std::int32_t{1} << source.level()) {
    const auto cells =
        static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
    materials_.assign(cells, kEmpty);
    source.stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
          materials_[cell({x, y, z})] = material;
        },
        {});
    numbers_.assign(6 * cells, kNone);
    for (int face = 0; face < 6; ++face) {
      gather(face / 2, face % 2 != 0, joined);
    }
  }

  const std::vector<FaceRect>& rects() const { return rects_; }
  /// The rectangle with this face; kNone where there is none.
  std::uint32_t rect_of(const Vec3i& voxel, int axis, bool up) const {
    return numbers_[face_index(voxel, axis, up)];
  }
  /// The rectangle that `ray` shows by what it hit; kNone where it hit nothing, or begins in something solid.
  std::uint32_t rect_of(const Ray& ray, const Hit& hit) const {
    return hit.kind == HitKind::kHit && hit.axis >= 0
               ? rect_of(hit.voxel, hit.axis, ray.direction[hit.axis] < 0)
               : kNone;
  }

 private:
  static constexpr std::uint16_t kEmpty = 0x100;

  std::size_t cell(const Vec3i& at) const {
    const auto part = [&](std::int32_t value, std::size_t rest) {
      return rest * static_cast<std::size_t>(side_) + static_cast<std::size_t>(value);
    };
    return part(at.x, part(at.y, static_cast<std::size_t>(at.z)));
  }
  std::size_t face_index(const Vec3i& voxel, int axis, bool up) const {
    return 6 * cell(voxel) + static_cast<std::size_t>(2 * axis + (up ? 1 : 0));
  }
  bool is_inside(const Vec3i& at) const {
    return at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < side_ && at.y < side_ && at.z < side_;
  }
  bool shows(const Vec3i& voxel, int axis, bool up) const {
    Vec3i beside = voxel;
    beside[axis] += up ? 1 : -1;
    return materials_[cell(voxel)] != kEmpty && (!is_inside(beside) || materials_[cell(beside)] == kEmpty);
  }
  bool is_free(const Vec3i& voxel, int axis, bool up, std::uint16_t material) const {
    return is_inside(voxel) && materials_[cell(voxel)] == material && shows(voxel, axis, up) &&
           rect_of(voxel, axis, up) == kNone;
  }

  // All faces of one direction: from each that is left as far as they go, first along one axis, then along the other.
  void gather(int axis, bool up, bool joined) {
    const int a = (axis + 1) % 3;
    const int b = (axis + 2) % 3;
    Vec3i at;
    for (at[axis] = 0; at[axis] < side_; ++at[axis]) {
      for (at[b] = 0; at[b] < side_; ++at[b]) {
        for (at[a] = 0; at[a] < side_; ++at[a]) {
          const std::uint16_t material = materials_[cell(at)];
          if (material != kEmpty && is_free(at, axis, up, material)) {
            add(at, axis, up, joined ? grown(at, axis, up, material) : at);
          }
        }
      }
    }
  }
  // The high corner of the rectangle that begins at `low`.
  Vec3i grown(const Vec3i& low, int axis, bool up, std::uint16_t material) const {
    const int a = (axis + 1) % 3;
    const int b = (axis + 2) % 3;
    Vec3i high = low;
    const auto row_is_free = [&](std::int32_t row) {
      Vec3i at = low;
      at[b] = row;
      for (; at[a] <= high[a]; ++at[a]) {
        if (!is_free(at, axis, up, material)) {
          return false;
        }
      }
      return true;
    };
    for (Vec3i next = low; is_free(next, axis, up, material); ++next[a]) {
      high[a] = next[a];
    }
    while (row_is_free(high[b] + 1)) {
      ++high[b];
    }
    return high;
  }
  void add(const Vec3i& low, int axis, bool up, const Vec3i& high) {
    const auto number = static_cast<std::uint32_t>(rects_.size());
    Vec3i at;
    for (at.z = low.z; at.z <= high.z; ++at.z) {
      for (at.y = low.y; at.y <= high.y; ++at.y) {
        for (at.x = low.x; at.x <= high.x; ++at.x) {
          numbers_[face_index(at, axis, up)] = number;
        }
      }
    }
    rects_.push_back({low, high, axis, up, static_cast<std::uint8_t>(materials_[cell(low)])});
  }

  std::int32_t side_;
  std::vector<std::uint16_t> materials_;  // of every voxel, or kEmpty
  std::vector<std::uint32_t> numbers_;    // the rectangle of every face
  std::vector<FaceRect> rects_;
};

}  // namespace thimble::benchmarks

#endif
