/// Which bands of the picture must be drawn again, so that an unchanged one costs nothing.
///
/// A pixel is a function of the scene and the camera alone, so a band is as it was unless something that one
/// of its rays can meet has changed. The display holds what it was sent; a band that is as it was is neither
/// drawn nor sent (`skip` tells the port). An application says what has changed:
///
///     camera moved           mark_all(): every band; what each of them sees is found out while it is drawn
///     something that moves   mark_seeing(): the bands whose rays met its bounds when they were last drawn
///                            after a mark_all() (`note_sees`), whatever way they took there
///     a ball in the air      mark_passing(ball): the bands of which some ray, however it went, can meet the ball on
///                            its fall (`note_passes`), when they were last drawn; a new ball: mark_all()
///     nothing                no band is drawn
///
/// One byte a band, the application's.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "port.h"
#include "thimble/base/memory.h"
#include "thimble/picture/pixel.h"

namespace thimble::apps {

class DirtyBands {
 public:
  static constexpr int32_t kBalls = 6;
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
  /// Which balls some ray of a band can meet: a bit each, for the first kBalls.
  void note_passes(int32_t band, uint32_t balls) {
    uint8_t& flags = flags_.data[band];
    flags = static_cast<uint8_t>((flags & ((1U << kFirstBall) - 1)) | balls << kFirstBall);
  }
  void mark_passing(int32_t ball) {
    const auto bit = static_cast<uint8_t>(1U << (kFirstBall + ball));
    mark_if(bit, bit);
  }
  bool passes_any(int32_t band) const { return flags_.data[band] >> kFirstBall != 0; }
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
  static constexpr int kFirstBall = 2;

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

}  // namespace thimble::apps
