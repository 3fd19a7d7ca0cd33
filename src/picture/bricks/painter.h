// Paints a band tile by tile: it follows each tile's beam to the first slab that is not empty, and from there traces
// the rays of the tile's quads. Internal to src/.
#ifndef THIMBLE_SRC_PICTURE_BRICKS_PAINTER_H
#define THIMBLE_SRC_PICTURE_BRICKS_PAINTER_H

#include "beam.h"
#include "brick_ray.h"
#include "far_ray.h"
#include "sweep.h"
#include "thimble/picture/render.h"
#include "tile.h"

namespace thimble::bricks {
namespace {

static_assert(kTileDownPx == kBrickTilePx);

template <class OneCourse>
int32_t trace_along(const OneCourse& course, const Vec3i& d) {
  const auto size = [](int32_t value) { return static_cast<uint32_t>(value < 0 ? -value : value); };
  const uint32_t x = size(d.x);
  const uint32_t y = size(d.y);
  const uint32_t z = size(d.z);
  return course.c == 0   ? trace_by_signs<0>(course, y, z, x)
         : course.c == 1 ? trace_by_signs<1>(course, x, z, y)
                         : trace_by_signs<2>(course, x, y, z);
}

// Traces a quad with rays of one course. `from`, the mirrored affine function and a half, is positive all over the
// quad, so rounding is cutting off. Returns a negative number when any answer is no ink.
template <int kC, unsigned kMirrored, class OneCourse>
[[gnu::noinline]] int32_t trace_quad(const OneCourse& course, const Camera::Vec3Q32& from, int32_t across,
                                     int32_t down, int32_t* inks) {
  constexpr int kA = kOtherA<kC>;
  constexpr int kB = kOtherB<kC>;
  Vec3<uint64_t> row{static_cast<uint64_t>(from.x), static_cast<uint64_t>(from.y),
                     static_cast<uint64_t>(from.z)};
  int32_t all = 0;
  for (; down > 0; --down) {
    uint64_t a = row[kA];
    uint64_t b = row[kB];
    uint64_t c = row[kC];
    for (const int32_t* end = inks + across; inks != end; ++inks) {
      const int32_t ink =
          trace_one<kC, kMirrored>(course, static_cast<uint32_t>(a >> 32), static_cast<uint32_t>(b >> 32),
                                   static_cast<uint32_t>(c >> 32));
      *inks = ink;
      all |= ink;
      a += static_cast<uint64_t>(course.step_x[kA]);
      b += static_cast<uint64_t>(course.step_x[kB]);
      c += static_cast<uint64_t>(course.step_x[kC]);
    }
    row.x += static_cast<uint64_t>(course.step_y.x);
    row.y += static_cast<uint64_t>(course.step_y.y);
    row.z += static_cast<uint64_t>(course.step_y.z);
  }
  return all;
}

#ifdef THIMBLE_FAST_RAM
// The same by one function for all courses. The rays start in slab `slab`, or from farther on (far_ray.h).
[[gnu::noinline]] int32_t trace_any_quad(Course& course, int32_t slab, const Camera::Vec3Q32& from,
                                         int32_t across, int32_t down, int32_t* inks) {
  const int c = course.c;
  const int a = other_a(c);
  const int b = other_b(c);
  const auto trace = c == 0   ? trace_one<0, kAnySigns, Course>
                     : c == 1 ? trace_one<1, kAnySigns, Course>
                              : trace_one<2, kAnySigns, Course>;
  const int32_t slabs = 4 * component(course.frame->side, c);
  int32_t begins = slab;  // as the course has it
  int64_t row[3] = {from.x, from.y, from.z};
  int32_t all = 0;
  for (; down > 0; --down) {
    int64_t at[3] = {row[0], row[1], row[2]};
    for (const int32_t* end = inks + across; inks != end; ++inks) {
      const auto whole = [&](int axis) { return static_cast<uint32_t>(at[axis] >> 32); };
      int32_t ink = kMissed;
      const int32_t start = course.far ? far_slab(course, slab, whole(a), whole(b), whole(c)) : slab;
      if (start < slabs) {
        if (start != begins) {
          set_start(course, start);
          begins = start;
        }
        ink = trace(course, whole(a), whole(b), whole(c));
      }
      *inks = ink;
      all |= ink;
      at[0] += course.step_x.x;
      at[1] += course.step_x.y;
      at[2] += course.step_x.z;
    }
    row[0] += course.step_y.x;
    row[1] += course.step_y.y;
    row[2] += course.step_y.z;
  }
  return all;
}
#endif

template <int kC, class OneCourse>
int32_t trace_quad_by_signs(const OneCourse& course, const Camera::Vec3Q32& from, int32_t across,
                            int32_t down, int32_t* inks) {
  return with_mirrored(course.mirrored, [&](auto axes) {
    return trace_quad<kC, decltype(axes)::kMirrored>(course, from, across, down, inks);
  });
}

// Traces a quad with rays that start in slab `slab`.
template <class OneCourse>
int32_t trace_quad_along(OneCourse& course, [[maybe_unused]] int32_t slab, const Camera::Vec3Q32& from,
                         int32_t across, int32_t down, int32_t* inks) {
#ifdef THIMBLE_FAST_RAM
  if constexpr (!OneCourse::kDeep) {
    return trace_any_quad(course, slab, from, across, down, inks);
  }
#endif
  return course.c == 0   ? trace_quad_by_signs<0>(course, from, across, down, inks)
         : course.c == 1 ? trace_quad_by_signs<1>(course, from, across, down, inks)
                         : trace_quad_by_signs<2>(course, from, across, down, inks);
}

// Draws the tiles of one band.
template <class OneCourse>
class BrickPainter {
 public:
  BrickPainter(const BrickFrame& frame, Inks& inks, Sweep* sweep, uint8_t* first_line, size_t stride,
               int32_t first_row, RenderCounts* counts)
      : frame_(frame),
        sweep_(sweep),
        first_line_(first_line),
        stride_(stride),
        first_row_(first_row),
        counts_(counts) {
    course_.frame = &frame;
    course_.inks = &inks;
    course_.directory = frame.map.directory();
    course_.bricks = frame.map.bricks();
    course_.exact_ties = !frame.tree.merged();
    course_.wide = frame.camera.direction_bits() > kNarrowDirectionBits;
    course_.most_cells = (1U << (23 - frame.camera.direction_bits())) - 1;
    if constexpr (OneCourse::kDeep) {
      const Vec3i& side = frame.side;
      const auto last = static_cast<uint32_t>((side.x - 1) * deep_place::kStride[0] +
                                              (side.y - 1) * deep_place::kStride[1] +
                                              (side.z - 1) * deep_place::kStride[2]);
      course_.empty_page = (4 * (deep_place::page_of(last) + 1) + 7) & ~uint32_t{7};
    }
    set_course<OneCourse::kDeep>(course_, 0, 0);  // NOLINT: where rays start is set_start's
  }

  [[THIMBLE_OWN_FUNCTION]] void draw_tile(const Tile& tile) {
    if (frame_.map.empty()) {
      fill(tile);
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
          fill(tile);
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
          fill(tile);
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

 private:
  // Draws a tile face by face, as far as that pays. Returns false when nothing was drawn; else quads may be left, which
  // are to be drawn from `slab` on.
  [[gnu::noinline]] bool sweep_tile(const Tile& tile, const Camera::Vec3Q32& value, const Fan& fan,
                                    int32_t* slab) {
    Sweep& sweep = *sweep_;
    set_sweep_course(course_, &sweep);
    const TilePlace place{line_of(tile.y0), row_stride(),      tile.x0,
                          tile.y0,          tile.x1 - tile.x0, tile.y1 - tile.y0};
    const FirstDirection first = first_direction(course_, value);
    TileSweep<InkPaint<OneCourse>> tile_sweep({sweep, course_, first, place});
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
      for (uint32_t& word : sweep.left.word) {
        misses_ += bits::popcount32(word);
      }
      store_pixels(place, sweep.left, frame_, frame_.background);
      sweep.left = {};
    }
    return true;
  }

  void use(unsigned mirrored, int c) {
    if (mirrored != course_.mirrored || c != course_.c) {
      set_course<OneCourse::kDeep>(course_, mirrored, c);
    }
  }

  void draw_quad(const Tile& quad, const Camera::Vec3Q32& value, const Fan& tile_fan, int32_t slab) {
    const Fan fan(value, frame_.quad_low, frame_.quad_high);
    const bool usable = fan.usable();
    if (usable) {
      use(fan.mirrored, fan.c);
      slab = first_slab_along<OneCourse::kDeep>(course_, fan,
                                                tile_fan.usable() && tile_fan.c == fan.c ? slab : 0);
      if (slab == 4 * frame_.side[fan.c]) {
        fill(quad);
        return;
      }
      set_start(course_, slab);
    }
    int32_t inks[kQuadPixels];
    const int32_t across = quad.x1 - quad.x0;
    const int32_t down = quad.y1 - quad.y0;
    if (!usable || fan.mixed != 0) {
      trace_mixed(value, usable ? fan.c : -1, slab, across, down, inks);
      answer(quad, inks);
    } else {
      Camera::Vec3Q32 from;
      for (int axis = 0; axis < 3; ++axis) {
        from[axis] = ((fan.mirrored >> axis & 1U) != 0 ? -value[axis] : value[axis]) + (int64_t{1} << 31);
      }
      const int32_t all = trace_quad_along(course_, slab, from, across, down, inks);
      if (all < 0) {
        answer(quad, inks);
      }
    }
    store(quad, inks);
  }

  // Traces a quad whose rays have different signs, so that each takes its own course; `c` is the fastest axis, or -1
  // when there is none, which leaves all rays to `answer`.
  [[gnu::noinline]] void trace_mixed(const Camera::Vec3Q32& value, int c, int32_t slab, int32_t across,
                                     int32_t down, int32_t* inks) {
    const Camera::Affine& affine = frame_.camera.affine();
    Camera::Vec3Q32 row = value;
    for (; down > 0; --down) {
      Camera::Vec3Q32 at = row;
      for (int32_t i = 0; i < across; ++i) {
        *inks = kAsk;
        if (c >= 0) {
          const Vec3i d{Camera::rounded(at.x), Camera::rounded(at.y), Camera::rounded(at.z)};
          const unsigned signs = signs_of(d);
          if (signs != course_.mirrored) {
            set_course<OneCourse::kDeep>(course_, signs, c);
            set_start(course_, slab);
          }
          *inks = trace_along(course_, d);
        }
        ++inks;
        for (int axis = 0; axis < 3; ++axis) {
          at[axis] += affine.step_x[axis];
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        row[axis] += affine.step_y[axis];
      }
    }
  }

  uint8_t* line_of(int32_t y) const {
    return first_line_ + stride_ * row_place(frame_.format, y - first_row_);
  }
  // Bytes from row to row of a tile: a page is as high as a tile, so all rows of a tile share their bytes.
  size_t row_stride() const { return has_pages(frame_.format) ? 0 : stride_; }

  void store(const Tile& quad, const int32_t* inks) {
    const int32_t across = quad.x1 - quad.x0;
    const size_t stride = row_stride();
    uint8_t* line = line_of(quad.y0);
    if (frame_.format == PixelFormat::kGray4 && across == kQuadAcrossPx) {
      line += quad.x0 >> 1;
      for (int32_t y = quad.y0; y < quad.y1; ++y, line += stride) {
        for (int32_t i = 0; i < kQuadAcrossPx / 2; ++i, inks += 2) {
          line[i] = static_cast<uint8_t>(inks[0] << 4 | inks[1]);  // NOLINT: all of a quad are set
        }
      }
      return;
    }
    if (frame_.halfwords) {
      for (int32_t y = quad.y0; y < quad.y1; ++y, line += stride) {
        Half* const pixels = static_cast<Half*>(static_cast<void*>(line)) + quad.x0;
        for (int32_t i = 0; i < across; ++i) {
          pixels[i] = bits::little(static_cast<Half>(*inks++));
        }
      }
      return;
    }
    for (int32_t y = quad.y0; y < quad.y1; ++y, line += stride) {
      for (int32_t x = quad.x0; x < quad.x1; ++x) {
        store_ink(line, x, y, frame_.format, static_cast<uint32_t>(*inks++));
      }
    }
  }

  // Turns the answers that are no inks into inks: asks the tree where only it can tell, and takes the background where
  // nothing is hit.
  [[gnu::noinline]] void answer(const Tile& quad, int32_t* inks) {
    for (int32_t y = quad.y0; y < quad.y1; ++y) {
      for (int32_t x = quad.x0; x < quad.x1; ++x, ++inks) {
        if (*inks == kAsk) {  // NOLINT: all of a quad are set
          *inks = ask<OneCourse::kDeep>(frame_, x, y, counts_);
        }
        if (*inks < 0) {
          *inks = static_cast<int32_t>(frame_.background);
          ++misses_;
        }
      }
    }
  }

  // In place where frames are small: a call would take 0.03 per cent more.
  void fill(const Tile& tile) {
    if constexpr (kSlots != 0) {
      fill_rows(tile);
      return;
    }
    const bool whole = is_in_pairs(tile);
    for (int32_t y = tile.y0; y < tile.y1; ++y) {
      uint8_t* line = line_of(y);
      for (int32_t x = tile.x0; x < tile.x1; x += whole ? 2 : 1) {
        if (whole) {
          line[x >> 1] = static_cast<uint8_t>(frame_.background * 17);
        } else {
          store_ink(line, x, y, frame_.format, frame_.background);
        }
      }
    }
    misses_ += static_cast<uint32_t>((tile.y1 - tile.y0) * (tile.x1 - tile.x0));
  }

  [[gnu::noinline]] void fill_rows(const Tile& tile) {
    const uint32_t ink = frame_.background;
    const size_t stride = row_stride();
    uint8_t* line = line_of(tile.y0);
    misses_ += static_cast<uint32_t>((tile.y1 - tile.y0) * (tile.x1 - tile.x0));
    const bool pairs = is_in_pairs(tile);
    for (int32_t y = tile.y0; y < tile.y1; ++y, line += stride) {
      if (pairs) {
        for (int32_t x = tile.x0 >> 1; x < tile.x1 >> 1; ++x) {
          line[x] = static_cast<uint8_t>(ink * 17);
        }
      } else if (frame_.halfwords) {
        Half* const pixels = static_cast<Half*>(static_cast<void*>(line));
        for (int32_t x = tile.x0; x < tile.x1; ++x) {
          pixels[x] = bits::little(static_cast<Half>(ink));
        }
      } else {
        for (int32_t x = tile.x0; x < tile.x1; ++x) {
          store_ink(line, x, y, frame_.format, ink);
        }
      }
    }
  }

  // Whether pixels of half a byte fill whole bytes.
  bool is_in_pairs(const Tile& tile) const {
    return frame_.format == PixelFormat::kGray4 && (tile.x1 - tile.x0) % kQuadAcrossPx == 0;
  }

 public:
  uint32_t misses() const { return misses_ + (sweep_ != nullptr ? sweep_->misses : 0); }

 private:
  const BrickFrame& frame_;
  Sweep* sweep_;  // null where tiles are not swept
  uint8_t* first_line_;
  size_t stride_;
  int32_t first_row_;
  RenderCounts* counts_;
  uint32_t misses_ = 0;
  OneCourse course_;
};

}  // namespace
}  // namespace thimble::bricks

#endif
