#include "scene/animation.h"

#include <algorithm>

#include "host/packed_picture.h"
#include "host/y4m.h"
#include "output/gif.h"
#include "output/output_file.h"
#include "scene/palette.h"

namespace thimble::tools {

// What a GIF shows of pictures: one palette, and the entry of each pixel. An ordered dither of a bin's width
// hides the steps of a gradient, and stands still from frame to frame.
class GifColors {
 public:
  explicit GifColors(const ColorHistogram& histogram) : map_(histogram) {
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      const Rgb color = map_.palette()[i].color;
      colors_[i] = {color.r, color.g, color.b};
    }
  }
  const GifPalette& palette() const { return colors_; }
  std::vector<std::uint8_t> indices(const Image& image) const {
    std::vector<std::uint8_t> result;
    for_pixels(image, [&](Rgb color) { result.push_back(map_.index(color)); });
    return result;
  }
  static void count(const Image& image, ColorHistogram* histogram) {
    for_pixels(image, [&](Rgb color) { histogram->add(color); });
  }

 private:
  template <class Visit>
  static void for_pixels(const Image& image, const Visit& visit) {
    for (std::int32_t y = 0; y < image.height_px; ++y) {
      for (std::int32_t x = 0; x < image.width_px; ++x) {
        const std::uint8_t* rgb = image.pixels.data() + 3 * (static_cast<std::size_t>(y) *
                                                                 static_cast<std::size_t>(image.width_px) +
                                                             static_cast<std::size_t>(x));
        const int nudge = static_cast<int>(bayer_rank(x, y)) / 8 - 4;
        const auto nudged = [nudge](int value) {
          return static_cast<std::uint8_t>(std::clamp(value + nudge, 0, 255));
        };
        visit(Rgb{nudged(rgb[0]), nudged(rgb[1]), nudged(rgb[2])});
      }
    }
  }

  PaletteMap map_;
  GifPalette colors_{};
};

bool is_film(std::string_view path) {
  return path.ends_with(".gif") || path.ends_with(".y4m");
}

FilmTimes::FilmTimes(PartKind kind, int frames) {
  constexpr int kTurnSeconds = 6;
  constexpr int kPathRate = 25;
  const bool is_path = kind == PartKind::kCameraPath;
  hundredths = is_path ? 100 / kPathRate : std::clamp(100 * kTurnSeconds / frames, 2, 100);
  rate = is_path ? kPathRate : std::clamp(frames / kTurnSeconds, 1, 60);
}

Film::Film(OutputFile* file, std::string_view path, PartKind kind, std::size_t frames, const Frame& frame)
    : file_(file), times_(kind, static_cast<int>(frames)) {
  Image first = frame(0);
  if (!path.ends_with(".gif")) {
    file_->write(host::y4m_header(first.width_px, first.height_px, false, times_.rate));
    return;
  }
  constexpr std::size_t kSamples = 4;
  ColorHistogram histogram;
  GifColors::count(first, &histogram);
  for (std::size_t i = 1; i < kSamples; ++i) {
    GifColors::count(frame(i * frames / kSamples), &histogram);
  }
  colors_ = std::make_unique<GifColors>(histogram);
  file_->write(gif_header(first.width_px, first.height_px, colors_->palette()));
}

Film::~Film() = default;

void Film::add(const Image& image) {
  file_->write(colors_ != nullptr
                   ? gif_frame(image.width_px, image.height_px, colors_->indices(image), times_.hundredths)
                   : host::y4m_color_frame({image.pixels.data(), image.width_px, image.height_px}));
}

void Film::end() {
  if (colors_ != nullptr) {
    file_->write(gif_end());
  }
}

}  // namespace thimble::tools
