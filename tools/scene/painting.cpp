#include "scene/painting.h"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace thimble::tools {

Status paint(BandPainter& painter, std::int32_t width_px, const RowRange& rows, PixelFormat format,
             const Progress& progress, Painting* painting) {
  *painting = {};
  painting->image = {width_px, rows.count,
                     format,   std::vector<std::uint8_t>(band_bytes(format, width_px, rows.count)),
                     {},       rows.first};
  painting->engine = painter.engine();
  painting->threads = painter.threads();
  const std::size_t line = row_bytes(format, width_px);
  const Bytes pixels(painting->image.pixels.data(), painting->image.pixels.size());
  for (std::int32_t y = 0; y < rows.count; y += painter.most_rows()) {
    Band band;
    band.format = format;
    band.first_row = rows.first + y;
    band.rows = std::min(painter.most_rows(), rows.count - y);
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
      progress(static_cast<double>(y) / rows.count);
    }
  }
  return Status::kOk;
}

}  // namespace thimble::tools
