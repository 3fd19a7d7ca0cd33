#include "scene/animation.h"

#include <algorithm>
#include <array>
#include <optional>

#include "host/packed_picture.h"
#include "host/y4m.h"
#include "output/gif.h"
#include "output/output_file.h"
#include "output/output_set.h"
#include "scene/palette.h"

namespace thimble::tools {

// What a GIF shows of pictures: one palette, and the entry of each pixel. An ordered dither of a bin's width
// hides the steps of a gradient, and stands still from frame to frame.
class GifColors {
 public:
  static constexpr int kBits = 5;  // a channel of a bin

  explicit GifColors(const ColorHistogram& histogram) {
    const PaletteMap map(histogram);
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      const Rgb color = map.palette()[i].color;
      colors_[i] = {color.r, color.g, color.b};
    }
    for (std::size_t bin = 0; bin < entries_.size(); ++bin) {
      const auto middle = [&](unsigned shift) {
        return static_cast<std::uint8_t>((bin >> shift & 31) * 8 + 4);
      };
      entries_[bin] = map.index({middle(10), middle(5), middle(0)});
    }
  }
  const GifPalette& palette() const { return colors_; }
  std::vector<std::uint8_t> indices(const Image& image) const {
    std::vector<std::uint8_t> result;
    for_pixels(image, [&](Rgb color) {
      const std::size_t bin = (color.r >> 3) << 10 | (color.g >> 3) << 5 | color.b >> 3;
      result.push_back(entries_[bin]);
    });
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

  GifPalette colors_{};
  std::array<std::uint8_t, 1 << 3 * kBits> entries_{};  // of every bin
};

namespace {

// Where the number of a sequence's pictures stands in their names, and its least digits.
struct NumberPlace {
  std::size_t begin;
  std::size_t length;
  std::size_t digits;
};

std::optional<NumberPlace> number_place(std::string_view path) {
  const std::size_t begin = path.find('%');
  std::size_t end = begin + 1;
  std::size_t digits = 0;
  if (begin == std::string_view::npos || path.find('%', end) != std::string_view::npos) {
    return std::nullopt;
  }
  if (end + 1 < path.size() && path[end] == '0' && path[end + 1] >= '1' && path[end + 1] <= '9') {
    digits = static_cast<std::size_t>(path[end + 1] - '0');
    end += 2;
  }
  return end < path.size() && path[end] == 'd' ? std::optional(NumberPlace{begin, end + 1 - begin, digits})
                                               : std::nullopt;
}

std::string numbered(std::string path, std::size_t number) {
  const NumberPlace place = number_place(path).value();
  std::string text = std::to_string(number);
  text.insert(0, place.digits - std::min(place.digits, text.size()), '0');
  return path.replace(place.begin, place.length, text);
}

}  // namespace

bool is_sequence(const std::string& path) {
  return image_kind(path) && number_place(path);
}

std::vector<std::string> sequence_names(const std::string& path, std::size_t frames) {
  std::vector<std::string> names;
  for (std::size_t i = 0; is_sequence(path) && i < frames; ++i) {
    names.push_back(numbered(path, i));
  }
  return names;
}

bool is_film(std::string_view path) {
  return path.ends_with(".gif") || path.ends_with(".y4m");
}

FilmTimes::FilmTimes(PartKind kind, int frames) {
  constexpr int kTurnSeconds = 6;
  rate = kind == PartKind::kCameraPath  ? 25
         : kind == PartKind::kAnimation ? 10
                                        : std::clamp(frames / kTurnSeconds, 1, 60);
  hundredths = kind == PartKind::kTurntable ? std::clamp(100 * kTurnSeconds / frames, 2, 100) : 100 / rate;
}

Film::Film(OutputFile* file, const std::string& path, PartKind kind, std::size_t frames, const Frame& frame)
    : file_(file), path_(path), times_(kind, static_cast<int>(frames)) {
  if (file_ == nullptr) {
    return;
  }
  Image first = frame(0);
  if (!path.ends_with(".gif")) {
    file_->write(host::y4m_header(first.width_px, first.height_px, false, times_.rate));
    return;
  }
  constexpr std::size_t kSamples = 4;
  ColorHistogram histogram(GifColors::kBits);
  GifColors::count(first, &histogram);
  for (std::size_t i = 1; i < kSamples; ++i) {
    GifColors::count(frame(i * frames / kSamples), &histogram);
  }
  colors_ = std::make_unique<GifColors>(histogram);
  file_->write(gif_header(first.width_px, first.height_px, colors_->palette()));
}

Film::~Film() = default;

void Film::add(const Image& image) {
  if (file_ == nullptr) {
    const std::string path = numbered(path_, added_++);
    OutputSet picture({path}, {});
    write_picture(picture[0], path, image);
    picture.commit();
    return;
  }
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
