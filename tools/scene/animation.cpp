#include "scene/animation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/y4m.h"
#include "output/output_file.h"
#include "output/units.h"
#include "scene/palette.h"
#include "thimble/picture/pixel.h"

namespace thimble::tools {

namespace {

// Films as GIF89a: one palette for all frames, which repeat without end.
//
// The bytes, after the CompuServe specification of 1990: header and screen (13 bytes), the palette (256 times r, g, b),
// the NETSCAPE2.0 extension that repeats; for each frame its delay (a graphic control extension), an image descriptor
// and its pixels, one byte an index, by LZW in blocks of at most 255 bytes; at the end 0x3B. LZW: codes from 9 to 12
// bits, lowest bit first; 256 clears the table, 257 ends the frame, new words count from 258; a full table is cleared.

// Codes of a changing number of bits, in blocks that begin with their length.
class Codes {
 public:
  explicit Codes(std::string* out) : out_(out) {}
  void write(unsigned code, int bits) {
    waiting_ |= code << count_;
    count_ += bits;
    for (; count_ >= 8; count_ -= 8, waiting_ >>= 8) {
      block_.push_back(static_cast<char>(waiting_ & 0xFFU));
      if (block_.size() == 255) {
        end_block();
      }
    }
  }
  void end() {
    if (count_ > 0) {
      block_.push_back(static_cast<char>(waiting_ & 0xFFU));
    }
    if (!block_.empty()) {
      end_block();
    }
    out_->push_back(0);
  }

 private:
  void end_block() {
    append_little(out_, block_.size(), 1);
    *out_ += block_;
    block_.clear();
  }

  std::string* out_;
  std::string block_;
  unsigned waiting_ = 0;
  int count_ = 0;
};

void compress(const std::vector<std::uint8_t>& indices, std::string* out) {
  constexpr unsigned kClear = 256;
  constexpr unsigned kEnd = 257;
  constexpr unsigned kMostCodes = 4096;
  // By word and next index, the word of both; 0 is none, since words of two begin at 258.
  std::vector<std::uint16_t> next(std::size_t{kMostCodes} * 256);
  unsigned used = kEnd + 1;
  int bits = 9;
  Codes codes(out);
  codes.write(kClear, bits);
  unsigned word = indices.empty() ? kEnd : indices[0];
  for (std::size_t i = 1; i < indices.size(); ++i) {
    std::uint16_t& longer = next[std::size_t{word} * 256 + indices[i]];
    if (longer != 0) {
      word = longer;
      continue;
    }
    codes.write(word, bits);
    if (used == kMostCodes) {
      codes.write(kClear, bits);
      std::fill(next.begin(), next.end(), std::uint16_t{0});
      used = kEnd + 1;
      bits = 9;
    } else {
      // A reader knows each word one code later than its writer.
      bits += used == 1U << bits ? 1 : 0;
      longer = static_cast<std::uint16_t>(used++);
    }
    word = indices[i];
  }
  if (word != kEnd) {
    codes.write(word, bits);
    bits += used == 1U << bits && bits < 12 ? 1 : 0;
  }
  codes.write(kEnd, bits);
  codes.end();
}

void put_size(std::string* out, const Image& image) {
  append_little(out, static_cast<std::uint64_t>(image.width_px), 2);
  append_little(out, static_cast<std::uint64_t>(image.height_px), 2);
}

void put_palette(std::string* out, const Palette& palette) {
  for (const Material& entry : palette) {
    for (const std::uint8_t channel : {entry.color.r, entry.color.g, entry.color.b}) {
      append_little(out, channel, 1);
    }
  }
}

/// What stands in front of the frames. Sides of 1 .. 65,535 pixels.
std::string gif_header(const Image& image, const Palette& palette) {
  std::string out = "GIF89a";
  put_size(&out, image);
  append_little(&out, 0xF7, 3);  // a palette of 2^8 colours, 8 bits a channel; background 0; square pixels
  put_palette(&out, palette);
  out += "\x21\xFF\x0BNETSCAPE2.0\x03\x01";
  append_little(&out, 0, 3);  // for ever
  return out;
}

/// A frame: a palette index for each pixel, row by row from the top; shown for so many hundredths of a second.
/// `own`: its palette, or null for that of all.
std::string gif_frame(const Image& image, const std::vector<std::uint8_t>& indices, int hundredths,
                      const Palette* own) {
  std::string out = "\x21\xF9\x04\x04";                            // what was drawn stays
  append_little(&out, static_cast<std::uint64_t>(hundredths), 4);  // no colour is transparent
  append_little(&out, 0x2C, 5);                                    // at the upper left
  put_size(&out, image);
  append_little(&out, own != nullptr ? 0x87 : 0, 1);  // whose palette; rows in order
  if (own != nullptr) {
    put_palette(&out, *own);
  }
  append_little(&out, 8, 1);  // bits an index
  compress(indices, &out);
  return out;
}

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

// What a GIF shows of pictures: one palette, and the entry of each pixel. An ordered dither of a bin's width
// hides the steps of a gradient, and stands still from frame to frame.
class GifColors {
 public:
  static constexpr int kBits = 5;  // a channel of a bin

  explicit GifColors(const ColorHistogram& histogram) {
    const PaletteMap map(histogram);
    palette_ = map.palette();
    for (std::size_t bin = 0; bin < entries_.size(); ++bin) {
      const auto middle = [&](unsigned shift) {
        return static_cast<std::uint8_t>((bin >> shift & 31) * 8 + 4);
      };
      entries_[bin] = map.index({middle(10), middle(5), middle(0)});
    }
  }
  const Palette& palette() const { return palette_; }
  std::vector<std::uint8_t> indices(const Image& image) const {
    std::vector<std::uint8_t> result;
    for_pixels(image, [&](Rgb color) {
      const auto bin = static_cast<std::size_t>((color.r >> 3) << 10 | (color.g >> 3) << 5 | color.b >> 3);
      result.push_back(entries_[bin]);
    });
    return result;
  }
  /// Root of the mean square by which a channel of the picture differs from what is shown for it.
  double error(const Image& image, const std::vector<std::uint8_t>& indices) const {
    double squares = 0;
    const std::uint8_t* index = indices.data();
    for_pixels(image, [&](Rgb color) {
      const Rgb& entry = palette_[*index++].color;
      for (const int difference : {color.r - entry.r, color.g - entry.g, color.b - entry.b}) {
        squares += difference * difference;
      }
    });
    return std::sqrt(squares / (3.0 * static_cast<double>(indices.size())));
  }
  static void count(const Image& image, ColorHistogram* histogram) {
    for_pixels(image, [&](Rgb color) { histogram->add(color); });
  }

 private:
  template <class Visit>
  static void for_pixels(const Image& image, const Visit& visit) {
    const std::uint8_t* rgb = image.pixels.data();
    for (std::int32_t y = 0; y < image.height_px; ++y) {
      for (std::int32_t x = 0; x < image.width_px; ++x, rgb += 3) {
        const int nudge = static_cast<int>(bayer_rank(x, y)) / 8 - 4;
        const auto nudged = [nudge](int value) {
          return static_cast<std::uint8_t>(std::clamp(value + nudge, 0, 255));
        };
        visit(Rgb{nudged(rgb[0]), nudged(rgb[1]), nudged(rgb[2])});
      }
    }
  }

  Palette palette_{};
  std::array<std::uint8_t, 1 << 3 * kBits> entries_{};  // of every bin
};

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

FilmTimes::FilmTimes(PartKind kind, int count) : frames(kind == PartKind::kCameraPath ? 25 : 10), seconds(1) {
  if (kind == PartKind::kTurntable) {
    seconds = 6;
    frames = std::clamp(count, seconds, 50 * seconds);
  }
}

Film::Film(OutputFile* file, const std::string& path, PartKind kind, std::size_t frames, const Frame& frame)
    : file_(file), path_(path), times_(kind, static_cast<int>(frames)) {
  if (file_ == nullptr) {
    return;
  }
  Image first = frame(0);
  if (!path.ends_with(".gif")) {
    file_->write(host::y4m_header(first.width_px, first.height_px, false, times_.frames, times_.seconds));
    return;
  }
  constexpr std::size_t kSamples = 4;
  ColorHistogram histogram(GifColors::kBits);
  GifColors::count(first, &histogram);
  for (std::size_t i = 1; i < kSamples; ++i) {
    GifColors::count(frame(i * frames / kSamples), &histogram);
  }
  colors_ = std::make_unique<GifColors>(histogram);
  file_->write(gif_header(first, colors_->palette()));
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
  if (colors_ == nullptr) {
    file_->write(host::y4m_color_frame({image.pixels.data(), image.width_px, image.height_px}));
    return;
  }
  const std::vector<std::uint8_t> indices = colors_->indices(image);
  constexpr double kMostError = 8;  // a bin's width
  if (colors_->error(image, indices) <= kMostError) {
    file_->write(gif_frame(image, indices, times_.hundredths(), nullptr));
    return;
  }
  // It has colours that the frames which the palette is of have not.
  ColorHistogram histogram(GifColors::kBits);
  GifColors::count(image, &histogram);
  const GifColors own(histogram);
  file_->write(gif_frame(image, own.indices(image), times_.hundredths(), &own.palette()));
}

void Film::end() {
  if (colors_ != nullptr) {
    file_->write(";");  // a GIF ends with 0x3B
  }
}

}  // namespace thimble::tools
