// Water that does not move, for rays in a world that has a brick map: a box. In such worlds coordinates have 16 bits, rays
// from a hit have directions of 15, and those of the camera are within `draws_fast`; so a distance times a direction stays
// below 2^31, and nothing here has more than 32 bits. What is met, and where, is what water.h says. Internal to src/.
#pragma once

#include "../../base/integers.h"
#include "thimble/light/water.h"

namespace thimble::lit {
namespace {

class StillWater {
 public:
  // Where a ray comes to a face of the box: at t = way / (256 * speed).
  struct Face {
    int axis = -1;  // the lowest of those crossed together
    uint32_t way = 0;
    uint32_t speed = 1;
  };

  // False where the water moves or leaves the world of `level`: then nothing else may be called.
  bool set(const WaterSurface& water, int level) {
    const int32_t side = Q8::kOne << level;
    const int32_t size[3] = {Q8::kOne * water.width, Q8::kOne * water.depth, water.highest_q8};
    bool fits = water.heights_q16 == nullptr;
    for (int i = 0; i < 3; ++i) {
      low_[i] = Q8::kOne * water.corner[i];
      high_[i] = low_[i] + size[i];
      fits = fits && low_[i] >= 0 && high_[i] <= side;
    }
    return fits;
  }

  // As `water_holds`.
  bool holds(const Ray& ray) const {
    for (int i = 0; i < 3; ++i) {
      const int32_t at = ray.origin[i].raw;
      if (ray.direction[i] < 0 ? at <= low_[i] || at > high_[i] : at < low_[i] || at >= high_[i]) {
        return false;
      }
    }
    return true;
  }

  // Where a ray that is in the water leaves it.
  Face leave(const Ray& ray) const {
    Face out;
    for (int i = 0; i < 3; ++i) {
      const uint32_t speed = magnitude_32(ray.direction[i]);
      const uint32_t way = way_out(ray, i);
      if (speed != 0 && (out.axis < 0 || way * out.speed < out.way * speed)) {
        out = {i, way, speed};
      }
    }
    return out;
  }

  // Where a ray that is not in the water enters it. False where it never does.
  bool enter(const Ray& ray, Face* in) const {
    for (int i = 0; i < 3; ++i) {
      const int32_t at = ray.origin[i].raw;
      const uint32_t speed = magnitude_32(ray.direction[i]);
      const bool down = ray.direction[i] < 0;
      if (speed == 0 ? at < low_[i] || at >= high_[i] : down ? at <= low_[i] : at >= high_[i]) {
        return false;
      }
      const int32_t way = down ? at - high_[i] : low_[i] - at;
      if (speed != 0 && way > 0 &&
          (in->axis < 0 || in->way * speed < static_cast<uint32_t>(way) * in->speed)) {
        *in = {i, static_cast<uint32_t>(way), speed};
      }
    }
    for (int i = 0; i < 3 && in->axis >= 0; ++i) {
      const uint32_t speed = magnitude_32(ray.direction[i]);
      if (speed != 0 && in->way * speed >= way_out(ray, i) * in->speed) {
        return false;
      }
    }
    return in->axis >= 0;
  }

  // The point where the ray comes to a face, entering or leaving, as `start_on_plane`. False where that lies on the edge
  // of a column: it counts as a side of that.
  bool find_point(const Ray& ray, const Face& face, bool enters, Vec3Q8* point) const {
    for (int i = 0; i < 3; ++i) {
      if (i == face.axis) {
        (*point)[i] = Q8::from_raw((ray.direction[i] < 0) == enters ? high_[i] : low_[i]);
        continue;
      }
      const uint32_t dividend = place_at(ray, face, i);
      const uint32_t place = dividend / face.speed;
      if (place * face.speed == dividend && ray.direction[i] != 0 && is_edge(i, place)) {
        return false;
      }
      (*point)[i] = Q8::from_raw(low_[i] + static_cast<int32_t>(place));
    }
    return true;
  }
  // The same without the point.
  bool is_on_edge(const Ray& ray, const Face& face) const {
    for (int i = 0; i < 2; ++i) {
      const uint32_t dividend = place_at(ray, face, i);
      if (i != face.axis && ray.direction[i] != 0 && (dividend & 255U) == 0 &&
          dividend % (face.speed << 8) == 0) {
        return true;
      }
    }
    return false;
  }

 private:
  // Where the ray comes to a face, from the lowest corner on and times `face.speed`.
  uint32_t place_at(const Ray& ray, const Face& face, int axis) const {
    return static_cast<uint32_t>(ray.origin[axis].raw - low_[axis]) * face.speed +
           face.way * static_cast<uint32_t>(ray.direction[axis]);
  }
  bool is_edge(int axis, uint32_t place) const {
    return axis == 2 ? static_cast<int32_t>(place) == high_[2] - low_[2] : (place & 255U) == 0;
  }
  uint32_t way_out(const Ray& ray, int axis) const {
    const int32_t at = ray.origin[axis].raw;
    return static_cast<uint32_t>(ray.direction[axis] < 0 ? at - low_[axis] : high_[axis] - at);
  }

  // In 1/256 voxel.
  int32_t low_[3];
  int32_t high_[3];
};

}  // namespace
}  // namespace thimble::lit
