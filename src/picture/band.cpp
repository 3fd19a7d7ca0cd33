#include "band.h"

namespace thimble {

Status check_band(const Camera& camera, int level, const Band& band, size_t* stride) {
  return camera.level() != level ? Status::kBadArgument
                                 : check_rows(camera.width_px(), camera.height_px(), band, stride);
}

Status check_rows(int32_t width, int32_t height, const Band& band, size_t* stride) {
  if (width == 0 || band.first_row < 0 || band.rows < 0 || band.rows > height - band.first_row) {
    return Status::kBadArgument;
  }
  // Only the picture's end may cut off what the format keeps together.
  const int32_t multiple = band_row_multiple(band.format);
  const bool ends = band.first_row + band.rows == height;
  if (band.first_row % multiple != 0 || (!ends && band.rows % multiple != 0)) {
    return Status::kBadArgument;
  }
  const size_t line_bytes = row_bytes(band.format, width);
  *stride = band.stride_bytes == 0 ? line_bytes : band.stride_bytes;
  if (*stride < line_bytes) {
    return Status::kBadArgument;
  }
  if (band.rows == 0) {
    return Status::kOk;
  }
  const size_t rows_above = row_place(band.format, whole_rows(band.format, band.rows)) - 1;
  if (line_bytes > band.pixels.size || rows_above > (band.pixels.size - line_bytes) / *stride) {
    return Status::kOutOfMemory;
  }
  if (rows_above == 0) {
    *stride = line_bytes;  // a row's own end, too, must be an address
  }
  return Status::kOk;
}

Status check_width(const Camera& camera, int level, Width width) {
  for (unsigned corner = 0; width == Width::k32 && corner < 4; ++corner) {
    if (!accepts_32(corner_ray(camera, corner), level)) {
      return Status::kBadArgument;
    }
  }
  return Status::kOk;
}

}  // namespace thimble
