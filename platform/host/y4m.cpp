#include "host/y4m.h"

#include <cstddef>

namespace thimble::host {
namespace {

constexpr const char* kFrame = "FRAME\n";

// Rec. 601 in 1/256: 0..255 becomes 16..235 for Y' and 16..240 for Cb and Cr.
char luma(int r, int g, int b) {
  return static_cast<char>(((66 * r + 129 * g + 25 * b + 128) >> 8) + 16);
}
char blueness(int r, int g, int b) {
  return static_cast<char>(((-38 * r - 74 * g + 112 * b + 128) >> 8) + 128);
}
char redness(int r, int g, int b) {
  return static_cast<char>(((112 * r - 94 * g - 18 * b + 128) >> 8) + 128);
}

}  // namespace

std::string y4m_header(std::int32_t width_px, std::int32_t height_px, bool gray, int frames, int seconds) {
  return "YUV4MPEG2 W" + std::to_string(width_px) + " H" + std::to_string(height_px) + " F" +
         std::to_string(frames) + ":" + std::to_string(seconds) + " Ip A1:1 " + (gray ? "Cmono" : "C444") +
         "\n";
}

std::string y4m_gray_frame(const std::vector<std::uint8_t>& levels) {
  return kFrame + std::string(levels.begin(), levels.end());
}

std::string y4m_color_frame(const Picture& picture) {
  std::string frame = kFrame;
  const std::size_t pixels =
      static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px);
  frame.reserve(frame.size() + 3 * pixels);
  for (const auto plane : {luma, blueness, redness}) {
    for (std::size_t i = 0; i < pixels; ++i) {
      const std::uint8_t* rgb = picture.rgb + 3 * i;
      frame += plane(rgb[0], rgb[1], rgb[2]);
    }
  }
  return frame;
}

}  // namespace thimble::host
