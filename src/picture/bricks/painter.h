// Paints a band: finds the ink of each ray and stores it. Internal to src/.
#pragma once

#include "brick_ray.h"
#include "far_ray.h"
#include "tile_painter.h"

namespace thimble::bricks {
namespace {

static_assert(kTileDownPx == kBrickTilePx);

template <class OneCourse>
int32_t trace_along(const OneCourse& course, const Vec3<uint32_t>& d) {
  return course.c == 0   ? trace_by_signs<0>(course, d.y, d.z, d.x)
         : course.c == 1 ? trace_by_signs<1>(course, d.x, d.z, d.y)
                         : trace_by_signs<2>(course, d.x, d.y, d.z);
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
[[gnu::noinline, THIMBLE_HOT]] int32_t trace_any_quad(Course& course, int32_t slab,
                                                      const Camera::Vec3Q32& from, int32_t across,
                                                      int32_t down, int32_t* inks) {
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

template <class OneCourse>
class BrickPainter : public TilePainter<OneCourse, BrickPainter<OneCourse>> {
  using Tiles = TilePainter<OneCourse, BrickPainter>;
  friend Tiles;

 public:
  BrickPainter(const BrickFrame& frame, Inks& inks, Sweep* sweep, uint8_t* first_line, size_t stride,
               int32_t first_row, RenderCounts* counts)
      : Tiles(frame, sweep),
        first_line_(first_line),
        stride_(stride),
        first_row_(first_row),
        counts_(counts) {
    course_.inks = &inks;
    course_.exact_ties = !frame.tree.merged();
  }

  uint32_t misses() const { return misses_ + (sweep_ != nullptr ? sweep_->misses : 0); }

 private:
  using Tiles::course_;
  using Tiles::frame_;
  using Tiles::sweep_;

  using Paint = InkPaint<OneCourse>;
  TilePlace place_of(const Tile& tile) const {
    return {line_of(tile.y0), row_stride(), tile.x0, tile.y0, tile.x1 - tile.x0, tile.y1 - tile.y0};
  }
  Paint paint(const FirstDirection& first, const TilePlace& place) {
    return {*sweep_, course_, first, place};
  }
  void miss(const TilePlace& place, const Pixels& pixels) {
    for (const uint32_t word : pixels.word) {
      misses_ += bits::popcount32(word);
    }
    store_pixels(place, pixels, frame_, frame_.background);
  }

  void trace_quad(const Tile& quad, const Camera::Vec3Q32& value, const Fan& fan, int32_t slab) {
    int32_t inks[kQuadPixels];
    if (!fan.usable() || fan.mixed != 0) {
      trace_mixed(quad, value, fan, slab, inks);
      answer(quad, inks);
    } else {
      Camera::Vec3Q32 from;
      for (int axis = 0; axis < 3; ++axis) {
        from[axis] = ((fan.mirrored >> axis & 1U) != 0 ? -value[axis] : value[axis]) + (int64_t{1} << 31);
      }
      const int32_t all = trace_quad_along(course_, slab, from, quad.x1 - quad.x0, quad.y1 - quad.y0, inks);
      if (all < 0) {
        answer(quad, inks);
      }
    }
    store(quad, inks);
  }

  // Traces a quad whose rays have different signs; those without a fastest axis are left to `answer`.
  [[gnu::noinline, THIMBLE_HOT]] void trace_mixed(const Tile& quad, const Camera::Vec3Q32& value,
                                                  const Fan& fan, int32_t slab, int32_t* inks) {
    if (fan.usable()) {
      this->trace_each(quad, value, fan.c, slab,
                       [&](int32_t, int32_t, const Vec3<uint32_t>& d) { *inks++ = trace_along(course_, d); });
      return;
    }
    for (int32_t i = 0; i < kQuadPixels; ++i) {
      inks[i] = kAsk;
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

  [[gnu::noinline]] void miss(const Tile& tile) {
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

  uint8_t* first_line_;
  size_t stride_;
  int32_t first_row_;
  RenderCounts* counts_;
  uint32_t misses_ = 0;
};

}  // namespace
}  // namespace thimble::bricks
