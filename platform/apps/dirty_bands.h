/// @file dirty_bands.h
/// Which bands of the picture must be drawn again, so that an unchanged one costs nothing.
///
/// A pixel is a function of the scene and the camera alone, so a band is as it was unless something that one
/// of its rays can meet has changed. The display holds what it was sent; a band that is as it was is neither
/// drawn nor sent (`skip` tells the port). An application says what has changed:
///
///     camera moved           mark_all(): every band; what each of them sees is found out while it is drawn
///     something that moves   mark_seeing(): the bands whose rays met its bounds when they were last drawn
///                            after a mark_all() (`note_sees`), whatever way they took there
///     a body in the air      mark(band): the bands that its box can be seen in (`band_may_see`)
///     nothing                no band is drawn
///
/// One byte a band, the application's.
#ifndef THIMBLE_PLATFORM_APPS_DIRTY_BANDS_H
#define THIMBLE_PLATFORM_APPS_DIRTY_BANDS_H

#include <stddef.h>
#include <stdint.h>

#include "port.h"
#include "thimble/base/memory.h"
#include "thimble/picture/camera.h"

namespace thimble::apps {

class DirtyBands {
 public:
  /// For a picture of that height in bands of `band_rows`; `bytes` has at least `bytes_for` of them. All
  /// bands are marked.
  void begin(Bytes bytes, int32_t height_px, int32_t band_rows) {
    flags_ = bytes;
    height_px_ = height_px;
    band_rows_ = band_rows;
    mark_all();
  }
  static constexpr size_t bytes_for(int32_t height_px, int32_t band_rows) {
    return static_cast<size_t>((height_px + band_rows - 1) / band_rows);
  }

  int32_t count() const { return static_cast<int32_t>(bytes_for(height_px_, band_rows_)); }
  int32_t first_row(int32_t band) const { return band * band_rows_; }
  int32_t rows(int32_t band) const {
    const int32_t left = height_px_ - first_row(band);
    return left < band_rows_ ? left : band_rows_;
  }

  void mark(int32_t band) { flags_.data[band] |= kDirty; }
  void mark_all() { mark_if(0, 0); }
  void mark_seeing() { mark_if(kSees, kSees); }
  /// Whether the rays of a band can meet what moves: said when it is drawn with the bounds of all that may
  /// ever move.
  void note_sees(int32_t band, bool sees) {
    uint8_t& flags = flags_.data[band];
    flags = static_cast<uint8_t>((flags & ~kSees) | (sees ? kSees : 0));
  }
  bool is_dirty(int32_t band) const { return (flags_.data[band] & kDirty) != 0; }

  /// The band was drawn and sent.
  void drawn(int32_t band) {
    flags_.data[band] &= static_cast<uint8_t>(~kDirty);
    ++drawn_;
  }
  /// The band is as it was: says so to the port.
  void skip(int32_t band, PixelFormat format) {
    port::flush({{}, format, 0, first_row(band), rows(band)});
    ++skipped_;
  }
  /// Since the start.
  uint64_t bands_drawn() const { return drawn_; }
  uint64_t bands_skipped() const { return skipped_; }

 private:
  static constexpr uint8_t kDirty = 1;
  static constexpr uint8_t kSees = 2;

  void mark_if(uint8_t mask, uint8_t value) {
    for (int32_t band = 0; band < count(); ++band) {
      if ((flags_.data[band] & mask) == value) {
        mark(band);
      }
    }
  }

  Bytes flags_;
  int32_t height_px_ = 0;
  int32_t band_rows_ = 1;
  uint64_t drawn_ = 0;
  uint64_t skipped_ = 0;
};

/// A box in the air, in 1/256 voxel.
struct BoxQ8 {
  Vec3i low;
  Vec3i high;
};

namespace bands {

inline Vec3i varying(const Camera& camera, int32_t px, int32_t py) {
  const Camera::Affine& affine = camera.affine();
  const auto part = [&](int axis) {
    return Camera::rounded(affine.base[axis] + px * affine.step_x[axis] + py * affine.step_y[axis]);
  };
  return {part(0), part(1), part(2)};
}

constexpr Vec3i from(const Vec3i& one, const Vec3i& other) {
  return {other.x - one.x, other.y - one.y, other.z - one.z};
}

/// Whether the whole box lies on the far side of the plane of a row's rays, seen from the row `inner`.
inline bool is_beyond(const Camera& camera, int32_t row, int32_t inner, const BoxQ8& box) {
  const Vec3i left = varying(camera, 0, row);
  const Vec3i right = varying(camera, camera.width_px(), row);
  const Vec3i inside = varying(camera, 0, inner);
  const bool is_perspective = camera.is_perspective();
  const Vec3i along = is_perspective ? left : camera.direction();
  const Vec3i across = is_perspective ? right : from(left, right);
  // Components are below 2^21, so the normal's are below 2^43: it is brought to 2^30. Distances are below
  // 2^23.
  int64_t normal[3] = {int64_t{along.y} * across.z - int64_t{along.z} * across.y,
                       int64_t{along.z} * across.x - int64_t{along.x} * across.z,
                       int64_t{along.x} * across.y - int64_t{along.y} * across.x};
  const auto is_large = [](int64_t value) {
    return value >= (int64_t{1} << 30) || value <= -(int64_t{1} << 30);
  };
  while (is_large(normal[0]) || is_large(normal[1]) || is_large(normal[2])) {
    for (int64_t& component : normal) {
      component >>= 1;
    }
  }
  const auto side = [&normal](int32_t x, int32_t y, int32_t z) {
    return normal[0] * x + normal[1] * y + normal[2] * z;
  };
  const Vec3i step = is_perspective ? inside : from(left, inside);
  const int64_t inner_side = side(step.x, step.y, step.z);
  const Vec3i start = is_perspective ? Vec3i{} : left;
  const Vec3i origin{camera.eye().x.raw + start.x, camera.eye().y.raw + start.y,
                     camera.eye().z.raw + start.z};
  for (int corner = 0; corner < 8; ++corner) {
    const int64_t at = side(((corner & 1) != 0 ? box.high.x : box.low.x) - origin.x,
                            ((corner & 2) != 0 ? box.high.y : box.low.y) - origin.y,
                            ((corner & 4) != 0 ? box.high.z : box.low.z) - origin.z);
    if (at == 0 || inner_side == 0 || (at > 0) == (inner_side > 0)) {
      return false;
    }
  }
  return true;
}

}  // namespace bands

/// Whether a ray of the rows from `first` to `end` - 1 may meet the box: false only where none does. It lies
/// between the planes of the rows around, since it would have a corner on the near side of each; a row on
/// either side is for rounding, of the rays (1/8 pixel) and of the planes.
[[gnu::noinline]] inline bool band_may_see(const Camera& camera, int32_t first, int32_t end,
                                           const BoxQ8& box) {
  // The row that tells the sides apart is some rows away, where directions have few bits.
  constexpr int32_t kApart = 16;
  return !bands::is_beyond(camera, first - 2, first - 2 + kApart, box) &&
         !bands::is_beyond(camera, end + 1, end + 1 - kApart, box);
}

}  // namespace thimble::apps

#endif
