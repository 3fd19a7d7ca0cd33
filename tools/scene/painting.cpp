#include "scene/painting.h"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace thimble::tools {

Status paint(BandPainter& painter, std::int32_t width_px, std::int32_t height_px, PixelFormat format,
             const Progress& progress, Painting* painting) {
  *painting = {};
  painting->image = {width_px, height_px, format,
                     std::vector<std::uint8_t>(band_bytes(format, width_px, height_px))};
  painting->engine = painter.engine();
  painting->threads = painter.threads();
  const std::size_t line = row_bytes(format, width_px);
  const Bytes pixels(painting->image.pixels.data(), painting->image.pixels.size());
  for (std::int32_t y = 0; y < height_px; y += painter.most_rows()) {
    Band band;
    band.format = format;
    band.first_row = y;
    band.rows = std::min(painter.most_rows(), height_px - y);
    const Bytes target =
        pixels.subspan(line * static_cast<std::size_t>(y), line * static_cast<std::size_t>(band.rows));
    const Bytes work = painter.work();
    band.pixels = work.empty() ? target : work;
    const auto start = std::chrono::steady_clock::now();
    const Status status = painter.draw(band, &painting->counts);
    painting->seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (status != Status::kOk) {
      return status;
    }
    if (!work.empty()) {
      std::memcpy(target.data, work.data, target.size);
    }
    if (progress) {
      progress(static_cast<double>(y) / height_px);
    }
  }
  return Status::kOk;
}

}  // namespace thimble::tools
