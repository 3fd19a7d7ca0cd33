// Draws a band tile by tile: sweeps a tile where that pays, else follows its beam to the first slab that is not empty, and
// from there has the rays of the tile's quads traced. Internal to src/.
#pragma once

#include "beam.h"
#include "sweep.h"
#include "thimble/picture/render.h"
#include "tile.h"

namespace thimble::bricks {
namespace {

// Makes what the rays of a band share, but for the background's ink.
template <bool kDeep = false>
BrickFrame brick_frame(const CompactTree& tree, const BrickMap& map, const Camera& camera,
                       const Shading& shading, PixelFormat format) {
  BrickFrame frame{tree, map, camera, shading, format, false, 0, {}, {}, {}, {}, {}, {}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    frame.side[axis] = map.box().high[axis] - map.box().low[axis];
    frame.eye[axis] = camera.eye()[axis].raw - map.box().low[axis] * (4 * Q8::kOne);
  }
  if constexpr (kDeep) {
    frame.stride = {deep_place::kStride[0], deep_place::kStride[1], deep_place::kStride[2]};
  } else {
    frame.stride = {2, 2 * frame.side.x, 2 * frame.side.x * frame.side.y};
  }
  margins_of(camera, kTileAcrossPx, kTileDownPx, &frame.tile_low, &frame.tile_high);
  margins_of(camera, kQuadAcrossPx, kQuadDownPx, &frame.quad_low, &frame.quad_high);
  return frame;
}

// Whether a solid voxel touches the eye: then rays may begin in it or on its surface.
template <bool kDeep = false>
bool touches_solid(const BrickFrame& frame) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    int32_t offset = 0;
    uint32_t bit = 0;
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t cell = (frame.eye[axis] - static_cast<int32_t>(corner >> axis & 1U)) >> 8;
      inside = inside && cell >= 0 && cell < 4 * frame.side[axis];
      offset += (cell >> 2) * frame.stride[axis];
      bit |= (static_cast<uint32_t>(cell) & 3U) << 2 * axis;
    }
    if (inside) {
      const int32_t brick = 8 * static_cast<int32_t>(number_at<kDeep>(frame.map.directory(), offset));
      if ((half_at(frame.map.bricks(), brick + 2 * static_cast<int32_t>(bit >> 4)) >> (bit & 15U) & 1U) !=
          0) {
        return true;
      }
    }
  }
  return false;
}

// `Own`, which is made of this, says what becomes of the pixels:
//
//   miss(tile)                           its rays meet nothing
//   trace_quad(quad, value, fan, slab)   its rays are to be traced from `slab` on; where !fan.usable(), from anywhere
//
// and where tiles are swept (with `sweep`)
//
//   place_of(tile), paint(first, place)  what TileSweep<Own::Paint> takes
//   miss(place, pixels)                  these pixels show nothing
template <class OneCourse, class Own>
class TilePainter {
 public:
  [[THIMBLE_HOT]] void draw_tile(const Tile& tile) {
    if (frame_.map.empty()) {
      own().miss(tile);
      return;
    }
    Camera::Vec3Q32 value;
    const Camera::Affine& affine = frame_.camera.affine();
    for (int axis = 0; axis < 3; ++axis) {
      value[axis] = affine.base[axis] + wide_multiple(tile.x0, affine.step_x[axis]) +
                    wide_multiple(tile.y0, affine.step_y[axis]);
    }
    const Fan fan(value, frame_.tile_low, frame_.tile_high);
    int32_t slab = 0;
    bool begun = false;  // by the sweep
    if (fan.usable()) {
      use(fan.mirrored, fan.c);
      if (kSlots != 0 && sweep_ != nullptr && fan.mixed == 0) {
        const int32_t origin = course_.origin[fan.c];
        slab = origin < 0 ? 0 : origin >> 8;
        if (slab >= 4 * frame_.side[fan.c]) {
          own().miss(tile);
          return;
        }
        begun = sweep_tile(tile, value, fan, &slab);
        if (begun && sweep_->done()) {
          return;
        }
      }
      if (!begun) {
        slab = first_slab_along<OneCourse::kDeep>(course_, fan, slab);
        if (slab == 4 * frame_.side[fan.c]) {
          own().miss(tile);
          return;
        }
      }
    }
    Camera::Vec3Q32 row = value;
    for (int32_t y = tile.y0; y < tile.y1; y += kQuadDownPx) {
      Camera::Vec3Q32 at = row;
      for (int32_t x = tile.x0; x < tile.x1; x += kQuadAcrossPx) {
        if (!begun || sweep_->has_quad(x - tile.x0, y - tile.y0)) {
          const Tile quad{x, x + kQuadAcrossPx < tile.x1 ? x + kQuadAcrossPx : tile.x1, y,
                          y + kQuadDownPx < tile.y1 ? y + kQuadDownPx : tile.y1};
          draw_quad(quad, at, fan, slab);
        }
        for (int axis = 0; axis < 3; ++axis) {
          at[axis] += wide_multiple(kQuadAcrossPx, affine.step_x[axis]);
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        row[axis] += wide_multiple(kQuadDownPx, affine.step_y[axis]);
      }
    }
  }

 protected:
  TilePainter(const BrickFrame& frame, Sweep* sweep) : frame_(frame), sweep_(sweep) {
    course_.frame = &frame;
    course_.directory = frame.map.directory();
    course_.bricks = frame.map.bricks();
    course_.wide = frame.camera.direction_bits() > kNarrowDirectionBits;
    course_.most_cells = (1U << (23 - frame.camera.direction_bits())) - 1;
    if constexpr (OneCourse::kDeep) {
      course_.empty_page = empty_page_of(frame.side);
    }
    set_course<OneCourse::kDeep>(course_, 0);  // NOLINT: where rays start is set_start's
    course_.set_signs();
  }

  // Calls `trace(direction)` for the pixels of a quad whose rays have different signs, row by row: each takes its own
  // course along c.
  template <class Trace>
  [[gnu::always_inline]] void trace_each(const Tile& quad, const Camera::Vec3Q32& value, int c, int32_t slab,
                                         Trace&& trace) {
    const Camera::Affine& affine = frame_.camera.affine();
    Camera::Vec3Q32 row = value;
    for (int32_t y = quad.y0; y < quad.y1; ++y) {
      Camera::Vec3Q32 at = row;
      for (int32_t x = quad.x0; x < quad.x1; ++x) {
        const Vec3i d{Camera::rounded(at.x), Camera::rounded(at.y), Camera::rounded(at.z)};
        const unsigned signs = signs_of(d);
        if (signs != course_.mirrored) {
          set(signs, c);
          set_start(course_, slab);
        }
        const auto size = [](int32_t part) { return static_cast<uint32_t>(part < 0 ? -part : part); };
        trace(x, y, Vec3<uint32_t>{size(d.x), size(d.y), size(d.z)});
        for (int axis = 0; axis < 3; ++axis) {
          at[axis] += affine.step_x[axis];
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        row[axis] += affine.step_y[axis];
      }
    }
  }

  const BrickFrame& frame_;
  Sweep* sweep_;  // null where tiles are not swept
  OneCourse course_;

 private:
  Own& own() { return static_cast<Own&>(*this); }

  // Draws a tile face by face, as far as that pays. Returns false when nothing was drawn; else quads may be left, which
  // are to be drawn from `slab` on.
  [[gnu::noinline, THIMBLE_HOT]] bool sweep_tile(const Tile& tile, const Camera::Vec3Q32& value,
                                                 const Fan& fan, int32_t* slab) {
    Sweep& sweep = *sweep_;
    set_sweep_course(course_, &sweep);
    const TilePlace place = own().place_of(tile);
    const FirstDirection first = first_direction(course_, value);
    TileSweep<typename Own::Paint> tile_sweep(own().paint(first, place));
    course_.waiting = kWaiting;
    set_start(course_, *slab);
    *slab = tile_sweep.run(fan, *slab);
    if (!tile_sweep.begun()) {
      return false;
    }
    if (*slab != 4 * frame_.side[fan.c]) {
      set_start(course_, *slab);
      tile_sweep.draw_parts_of_quads();
    } else if (!sweep.done()) {
      own().miss(place, sweep.left);
      sweep.left = {};
    }
    return true;
  }

  [[gnu::noinline, THIMBLE_HOT]] void set(unsigned mirrored, int c) {
    if (c != course_.c) {
      set_course<OneCourse::kDeep>(course_, c);
    }
    const unsigned differ = mirrored ^ course_.mirrored;
    for (int axis = 0; axis < 3; ++axis) {
      if ((differ >> axis & 1U) != 0) {
        flip_axis(course_, axis);
      }
    }
    course_.set_signs();
  }
  void use(unsigned mirrored, int c) {
    if (mirrored != course_.mirrored || c != course_.c) {
      set(mirrored, c);
    }
  }

  void draw_quad(const Tile& quad, const Camera::Vec3Q32& value, const Fan& tile_fan, int32_t slab) {
    const Fan fan(value, frame_.quad_low, frame_.quad_high);
    if (fan.usable()) {
      use(fan.mirrored, fan.c);
      slab = first_slab_along<OneCourse::kDeep>(course_, fan,
                                                tile_fan.usable() && tile_fan.c == fan.c ? slab : 0);
      if (slab == 4 * frame_.side[fan.c]) {
        own().miss(quad);
        return;
      }
      set_start(course_, slab);
    }
    own().trace_quad(quad, value, fan, slab);
  }
};

}  // namespace
}  // namespace thimble::bricks
