/// A scene that a chip builds by itself, one voxel at a time: solid spheres, each one voxel more of itself at
/// every step, as the paper built its world.
#pragma once

#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/picture/pixel.h"
#include "thimble/tree/octree.h"

namespace thimble::apps {

/// Gives the voxels of one sphere after the other; the same ones on every machine.
class SphereBuilder {
 public:
  /// Starts again in a world of 2^level voxels a side (4 .. 12).
  void begin(int level) {
    state_ = 20240229;
    finished_ = 0;
    last_ = kMostSpheres;
    level_ = level;
    choose();
  }

  /// Looks at one place of the current sphere's box. Whether it is in the sphere: `*voxel` is then the next
  /// voxel of the scene. Constant time.
  bool next(Voxel* voxel) {
    const Vec3i at = at_;
    const Vec3i away{at.x - center_.x, at.y - center_.y, at.z - center_.z};
    advance();
    if (away.x * away.x + away.y * away.y + away.z * away.z > radius_ * radius_) {
      return false;
    }
    voxel->position = at;
    voxel->material = material_;
    return true;
  }

  /// Spheres that are complete.
  uint32_t finished() const { return finished_; }
  /// Stops when that many spheres are complete.
  void end_after(uint32_t spheres) { last_ = spheres < kMostSpheres ? spheres : kMostSpheres; }
  bool is_done() const { return finished_ >= last_; }

  static Span<const Rgb8> palette() {
    static constexpr Rgb8 kColors[] = {{230, 230, 230}, {214, 69, 65},  {244, 179, 80},  {65, 131, 196},
                                       {38, 166, 120},  {155, 89, 182}, {236, 240, 241}, {230, 126, 34}};
    return Span<const Rgb8>(kColors);
  }

 private:
  static constexpr uint32_t kMostSpheres = 4096;

  /// A number 0 .. 2^level - 1: the upper bits of a linear congruential generator (the multiplier is that of
  /// Numerical Recipes).
  int32_t random() {
    state_ = state_ * 1664525U + 1013904223U;
    return static_cast<int32_t>(state_ >> (32 - level_));
  }
  void choose() {
    const int32_t side = 1 << level_;
    // 1/16 to 3/16 of the world, wholly within it.
    radius_ = side / 16 + (random() >> 3);
    const auto within = [side, this] { return radius_ + random() * (side - 2 * radius_) / side; };
    center_ = {within(), within(), within()};
    material_ = static_cast<uint8_t>(1 + finished_ % 7);
    at_ = {center_.x - radius_, center_.y - radius_, center_.z - radius_};
  }
  /// Along x, then y, then z of the box; at its end the next sphere.
  void advance() {
    if (++at_.x < center_.x + radius_ + 1) {
      return;
    }
    at_.x = center_.x - radius_;
    if (++at_.y < center_.y + radius_ + 1) {
      return;
    }
    at_.y = center_.y - radius_;
    if (++at_.z < center_.z + radius_ + 1) {
      return;
    }
    ++finished_;
    choose();
  }

  uint32_t state_ = 0;
  uint32_t finished_ = 0;
  uint32_t last_ = 0;
  int level_ = 6;
  int32_t radius_ = 0;
  uint8_t material_ = 0;
  Vec3i center_;
  Vec3i at_;
};

}  // namespace thimble::apps
