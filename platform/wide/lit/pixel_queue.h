/// The pixels that threads draw together: each thread takes the next ones as long as there are any.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <atomic>

#include "thimble/light/host/asked.h"
#include "wide/lit/lit_renderer.h"

namespace thimble::wide {

/// The rows of a band, or places on a camera's picture, for any number of threads.
class PixelQueue {
 public:
  PixelQueue(const lit::Frame& frame, const Band& band, size_t stride)
      : frame_(frame),
        band_(band),
        stride_(stride),
        width_(frame.camera.width_px()),
        columns_(kSquare),
        count_(static_cast<size_t>(band.rows)),
        together_(kSquare) {}
  /// `rgb` gets three bytes for each place.
  PixelQueue(const lit::Frame& frame, Span<const PixelPlace> places, Bytes rgb)
      : frame_(frame),
        places_(places.data),
        width_(1),
        columns_(1),
        count_(places.size),
        together_(kTogether) {
    band_.format = PixelFormat::kRgb888;
    band_.pixels = rgb;
  }

  /// Clears the rows whose pixels share bytes, before any is stored.
  void clear() const {
    for (int32_t row = 0; places_ == nullptr && row < band_.rows; ++row) {
      if (bits_per_pixel(band_.format) % 8 != 0 && begins_bytes(band_.format, row)) {
        lit::clear_row(frame_, band_, line_of(row));
      }
    }
  }

  static constexpr int32_t kSquare =
      32;  ///< a thread takes squares: whole bytes, which lie together both ways

 private:
  friend class PixelReader;
  static constexpr int32_t kTogether = 256;

  uint8_t* line_of(int32_t row) const { return band_.pixels.data + stride_ * row_place(band_.format, row); }

  const lit::Frame& frame_;
  const PixelPlace* places_ = nullptr;
  Band band_;
  size_t stride_ = 3;  // bytes from a row, or a place, to the next one
  int32_t width_;
  int32_t columns_;  // pixels of a row that a thread takes at a time
  size_t count_;     // rows, or places
  size_t together_;  // how many of them it takes
  std::atomic<size_t> next_{0};
};

/// Some columns of a row.
struct PixelColumns {
  int32_t first;
  int32_t end;
};

/// Where a pixel is stored. In place of a row of the band `row` may be the number of a place.
struct PixelSlot {
  int32_t x;
  int32_t row;
};

/// One thread's hold on a queue.
class PixelReader {
 public:
  explicit PixelReader(PixelQueue* queue) : queue_(*queue), rays_(queue->frame_.camera, 0, 0) {}

  /// Whether the row, or place, has no pixel left.
  bool row_is_done() const { return x_ == end_x_; }
  /// Begins the next one; false: there is none left.
  bool begin_row() {
    if (at_ != end_) {
      ++at_;
    }
    if (at_ == end_) {
      const size_t part = queue_.next_.fetch_add(1);
      const auto parts_of_row = static_cast<size_t>((queue_.width_ + queue_.columns_ - 1) / queue_.columns_);
      at_ = part / parts_of_row * queue_.together_;
      if (at_ >= queue_.count_) {
        end_ = at_;
        end_x_ = x_;
        return false;
      }
      end_ = std::min(at_ + queue_.together_, queue_.count_);
      first_x_ = static_cast<int32_t>(part % parts_of_row) * queue_.columns_;
    }
    x_ = first_x_;
    end_x_ = std::min(first_x_ + queue_.columns_, queue_.width_);
    if (is_row()) {
      rays_ = RowRays(queue_.frame_.camera, x_, camera_row());
    }
    return true;
  }
  /// Whether it is a row; which of the band, and of the camera.
  bool is_row() const { return queue_.places_ == nullptr; }
  int32_t row() const { return static_cast<int32_t>(at_); }
  int32_t camera_row() const { return queue_.band_.first_row + row(); }
  /// The columns of a row that are left to be taken.
  PixelColumns columns() const { return {x_, end_x_}; }
  /// Leaves only columns `first` to `end` - 1 of a row that was begun to be taken.
  void narrow(int32_t first, int32_t end) {
    x_ = first;
    end_x_ = end;
    rays_ = RowRays(queue_.frame_.camera, first, camera_row());
  }
  /// Takes the next pixel of a row that is not done.
  void take(Ray* ray, PixelSlot* at) {
    *at = {x_++, static_cast<int32_t>(at_)};
    if (is_row()) {
      *ray = rays_.ray();
      rays_.next();
    } else {
      const PixelPlace& place = queue_.places_[at_];
      *ray = queue_.frame_.camera.ray(place.x, place.y);
    }
  }

  /// Stores a pixel that was taken.
  void store(const PixelSlot& at, const lit::Color& color) const {
    uint8_t* const rgb = rgb_of(at);
    if (rgb != nullptr && std::max({color.c[0], color.c[1], color.c[2]}) <= lit::kWhite) {
      store_rgb(color, rgb);
    } else {
      lit::store(queue_.frame_, queue_.band_, queue_.line_of(at.row), at.x, queue_.band_.first_row + at.row,
                 color);
    }
  }
  /// A pixel's three bytes, where its row's begin; null in other formats. What `store_rgb` puts there is
  /// not above kWhite.
  uint8_t* rgb_of(const PixelSlot& at) const {
    return queue_.band_.format == PixelFormat::kRgb888 ? queue_.line_of(at.row) + 3 * at.x : nullptr;
  }
  static void store_rgb(const lit::Color& color, uint8_t* rgb) {
    const auto byte = [](uint32_t c) { return static_cast<uint8_t>((c + lit::kLevel / 2) / lit::kLevel); };
    rgb[0] = byte(color.c[0]);
    rgb[1] = byte(color.c[1]);
    rgb[2] = byte(color.c[2]);
  }

 private:
  PixelQueue& queue_;
  RowRays rays_;
  size_t at_ = 0;  // the row, or place
  size_t end_ = 0;
  int32_t first_x_ = 0;  // of each row that it takes together
  int32_t x_ = 0;
  int32_t end_x_ = 0;
};

}  // namespace thimble::wide
