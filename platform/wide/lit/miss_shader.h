/// What rays show that leave the world: the sky, found in lanes, or the background.
#pragma once

#include <stdint.h>

#include "thimble/light/host/asked.h"
#include "wide/lit/array_arena.h"
#include "wide/lit/beam.h"
#include "wide/lit/kernels.h"
#include "wide/lit/pixel_queue.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {

/// Components of rays' directions, then shares of the sky; with room for kMostLightLanes more.
struct SkyColumns {
  void lay_out(uint32_t count, ArrayArena* arena);
  void put(uint32_t number, const Vec3i& direction) const {
    for (int axis = 0; axis < 3; ++axis) {
      of[axis][number] = direction[axis];
    }
  }

  int32_t* of[4];
};

class MissShader {
 public:
  /// `columns` are for `most` rays.
  MissShader(const lit::Frame& frame, const RayMap& map, const SkyColumns& columns, uint32_t most);

  /// Begins a row, of which only what can show something solid is left to be taken: what is beside that is stored. False:
  /// there is no row left.
  bool begin_row(PixelReader* pixels, LitCounts* counts);
  /// Where the ray of a pixel of the row can first meet something: anywhere, where no row of a picture was begun here.
  const FirstPlane& first_plane(const PixelSlot& at) const {
    return rows_ < 0 ? of_square_ : planes_[(at.x - left_) / kBeam];
  }
  /// Calls give(i, color) for the first `count` directions of the columns: lit::sky_color, or the background.
  template <class Give>
  void each_color(uint32_t count, const Give& give) const;

 private:
  static constexpr int32_t kBeam = 8;  // a side of the pixels that are looked at together

  void look(const PixelReader& pixels, const PixelColumns& whole);
  void show_row(const PixelReader& pixels, int32_t first, int32_t end) const;

  const lit::Frame& frame_;
  Beams beams_;
  int32_t left_ = 0;  // the planes are for the columns from here on, and some rows
  int32_t rows_ = -1;
  FirstPlane of_square_;
  FirstPlane planes_[PixelQueue::kSquare / kBeam];
  SkyColumns columns_;
  uint32_t most_;
  lit::Color background_;
  lit::Color horizon_;
  uint32_t change_[2][3];  // from the horizon to the zenith and the ground, modulo 2^32
};

template <class Give>
void MissShader::each_color(uint32_t count, const Give& give) const {
  if ((frame_.effects & Effect::kSky) == 0) {
    for (uint32_t i = 0; i < count; ++i) {
      give(i, background_);
    }
    return;
  }
  // Lanes behind the last ray get some direction, which must not be zero.
  for (size_t i = count; i < count + kMostLightLanes; ++i) {
    columns_.of[0][i] = 1;
  }
  int32_t* const shares = columns_.of[3];
  find_sky_shares(columns_.of[0], columns_.of[1], columns_.of[2], count, shares);
  for (uint32_t i = 0; i < count; ++i) {
    const auto share = static_cast<uint32_t>(shares[i]);
    const uint32_t* const to = change_[columns_.of[2][i] < 0 ? 1 : 0];
    const auto mix = [&](int c) { return (horizon_.c[c] * 4096 + to[c] * share) >> 12; };
    give(i, lit::Color{{mix(0), mix(1), mix(2)}});
  }
}

}  // namespace thimble::wide
