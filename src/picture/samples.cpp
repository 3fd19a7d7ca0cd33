#include "thimble/picture/render.h"

namespace thimble {

Status average_samples(ConstBytes fine_rows, int across, int32_t width_px, int32_t y, PixelFormat format,
                       Bytes row) {
  if (across < 1 || across > kMaxSamplesAcross || width_px < 0 || width_px > kMaxPicturePx / across) {
    return Status::kOutOfRange;
  }
  const size_t line_bytes = row_bytes(format, width_px);
  if (fine_rows.size < samples_bytes(width_px, across) || row.size < line_bytes) {
    return Status::kOutOfMemory;
  }
  for (size_t i = 0; i < line_bytes && begins_bytes(format, y); ++i) {
    row[i] = 0;
  }
  const size_t fine_line = row_bytes(PixelFormat::kRgb888, width_px * across);
  const uint32_t count = static_cast<uint32_t>(across * across);
  for (int32_t x = 0; x < width_px; ++x) {
    uint32_t sum[3] = {};
    for (int line = 0; line < across; ++line) {
      const uint8_t* sample = fine_rows.data + fine_line * static_cast<size_t>(line) +
                              3 * static_cast<size_t>(across) * static_cast<size_t>(x);
      for (int column = 0; column < across; ++column, sample += 3) {
        sum[0] += sample[0];
        sum[1] += sample[1];
        sum[2] += sample[2];
      }
    }
    const auto mean = [count](uint32_t total) {
      return static_cast<uint8_t>((2 * total + count) / (2 * count));
    };
    store_pixel(row.data, x, y, format, {mean(sum[0]), mean(sum[1]), mean(sum[2])});
  }
  return Status::kOk;
}

}  // namespace thimble
