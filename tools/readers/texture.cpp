#include "readers/texture.h"

#include <webp/decode.h>

#include <algorithm>
#include <limits>

#include "output/units.h"
#include "readers/mesh.h"
#include "readers/picture.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

constexpr std::int64_t kMostAcross = 8;  ///< pixels of the level that a box is averaged on

std::int64_t wrapped(std::int64_t i, std::int64_t count, Wrap wrap) {
  if (wrap == Wrap::kClamp) {
    return std::clamp<std::int64_t>(i, 0, count - 1);
  }
  const std::int64_t period = wrap == Wrap::kMirror ? 2 * count : count;
  const std::int64_t at = (i % period + period) % period;
  return at < count ? at : period - 1 - at;
}

/// The pixels of a row that a range covers, and how much of each.
struct Coverage {
  std::array<std::size_t, kMostAcross + 3> pixel{};
  std::array<double, kMostAcross + 3> part{};
  std::size_t count = 0;

  Coverage(double middle, double half, std::int32_t pixels, Wrap wrap) {
    // Far out, where no number tells one pixel from the next, nor does this.
    middle = std::isfinite(middle) ? middle : 0;
    middle = wrap == Wrap::kClamp ? std::clamp(middle, -1.0, 2.0) : middle - 2 * std::floor(middle / 2);
    const double low = (middle - half) * pixels;
    const double high = (middle + half) * pixels;
    const auto first = static_cast<std::int64_t>(std::floor(low));
    const auto last = std::min(static_cast<std::int64_t>(std::floor(high)), first + kMostAcross + 1);
    // A sliver of a pixel is what corners rounded to 1/256 voxel make of a border.
    constexpr double kSliver = 1.0 / 32;
    for (std::int64_t i = first; i <= last; ++i) {
      const double covered =
          std::min(high, static_cast<double>(i + 1)) - std::max(low, static_cast<double>(i));
      if (first != last && covered <= (high - low) * kSliver) {
        continue;
      }
      pixel[count] = static_cast<std::size_t>(wrapped(i, pixels, wrap));
      part[count++] = first == last ? 1 : covered;
    }
  }
};

/// Makes the grey of a picture its alpha, unless it has one.
void take_opacity(std::span<std::uint8_t> rgba) {
  std::uint8_t least = 255;
  for (std::size_t i = 3; i < rgba.size(); i += 4) {
    least = std::min(least, rgba[i]);
  }
  for (std::size_t i = 0; least == 255 && i < rgba.size(); i += 4) {
    rgba[i + 3] = static_cast<std::uint8_t>((rgba[i] + rgba[i + 1] + rgba[i + 2]) / 3);
  }
}

}  // namespace

double light_of(std::uint8_t byte) {
  static const std::array<double, 256> kLight = [] {
    std::array<double, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double value = static_cast<double>(i) / 255;
      table[i] = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
    }
    return table;
  }();
  return kLight[byte];
}

std::uint8_t screen_byte(double light) {
  if (!(light > 0)) {
    return 0;
  }
  return unit_to_byte(light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}

Texture::Texture(std::shared_ptr<const std::uint8_t> rgba, std::int32_t width_px, std::int32_t height_px) {
  levels_.push_back({std::move(rgba), width_px, height_px});
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& finer = levels_.back();
    Level level{nullptr, (finer.width + 1) / 2, (finer.height + 1) / 2};
    auto pixels = std::make_shared<std::vector<std::uint8_t>>();
    pixels->reserve(4 * static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height));
    const double half_u = 0.5 / level.width;
    const double half_v = 0.5 / level.height;
    for (std::int32_t y = 0; y < level.height; ++y) {
      for (std::int32_t x = 0; x < level.width; ++x) {
        const Box box{(2 * x + 1) * half_u, (2 * y + 1) * half_v, half_u, half_v};
        const Sample sample = average_at(finer, box, Wrap::kClamp, Wrap::kClamp);
        for (const double light : sample.light) {
          pixels->push_back(screen_byte(light));
        }
        pixels->push_back(unit_to_byte(sample.alpha));
      }
    }
    level.rgba = {pixels, pixels->data()};
    levels_.push_back(std::move(level));
  }
}

Texture::Sample Texture::average(const Box& box, Wrap wrap_u, Wrap wrap_v) const {
  const auto half = [](double value) { return value > 0 ? std::min(value, 0.5) : 0; };  // NaN is none
  const Box bounded{box.u, box.v, half(box.half_u), half(box.half_v)};
  std::size_t at = 0;
  while (at + 1 < levels_.size() && std::max(2 * bounded.half_u * levels_[at].width,
                                             2 * bounded.half_v * levels_[at].height) > kMostAcross) {
    ++at;
  }
  return average_at(levels_[at], bounded, wrap_u, wrap_v);
}

Texture::Sample Texture::average_at(const Level& level, const Box& box, Wrap wrap_u, Wrap wrap_v) {
  const Coverage columns(box.u, box.half_u, level.width, wrap_u);
  const Coverage rows(box.v, box.half_v, level.height, wrap_v);
  std::array<double, 3> light{};
  double weights = 0;
  double alpha = 0;
  double parts = 0;
  for (std::size_t row = 0; row < rows.count; ++row) {
    const std::uint8_t* const line =
        level.rgba.get() + 4 * rows.pixel[row] * static_cast<std::size_t>(level.width);
    for (std::size_t column = 0; column < columns.count; ++column) {
      const std::uint8_t* const pixel = line + 4 * columns.pixel[column];
      const double part = rows.part[row] * columns.part[column];
      // What is clear has a colour too, which counts where there is no other.
      const double weight = part * (pixel[3] + 1);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        light[channel] += weight * light_of(pixel[channel]);
      }
      weights += weight;
      alpha += part * pixel[3];
      parts += part;
    }
  }
  return {{light[0] / weights, light[1] / weights, light[2] / weights}, alpha / (255 * parts)};
}

std::shared_ptr<const Texture> Textures::inside(const std::string& key, std::span<const std::uint8_t> encoded,
                                                bool is_opacity) {
  const auto known = known_.find({key, is_opacity});
  if (known != known_.end()) {
    return known->second;
  }
  std::shared_ptr<const Texture>& texture = known_[{key, is_opacity}];
  std::array<int, 2> sides{};
  const bool is_webp = WebPGetInfo(encoded.data(), encoded.size(), &sides[0], &sides[1]) != 0;
  if (!is_webp) {
    sides = picture_size(encoded);
  }
  const auto [width, height] = sides;
  if (width < 1 || height < 1) {
    const std::string_view begins(reinterpret_cast<const char*>(encoded.data()), encoded.size());
    miss(key, begins.starts_with("\xABKTX") ? "is KTX, which is not read"
                                            : "is no PNG, JPEG or WebP that this program reads");
    return texture;
  }
  encoded_bytes_ += encoded.size();
  const std::uint64_t bytes =
      std::uint64_t{4} * static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (pixel_bytes_ + bytes > 64 * encoded_bytes_ + (std::uint64_t{64} << 20)) {
    miss(key,
         concat("has ", width, " x ", height, " pixels, too many for a file of ", encoded.size(), " bytes"));
    return texture;
  }
  std::shared_ptr<std::uint8_t> rgba;
  try {
    if (is_webp) {
      rgba.reset(WebPDecodeRGBA(encoded.data(), encoded.size(), &sides[0], &sides[1]), WebPFree);
    } else {
      rgba = decode_picture(encoded, 4);
    }
  } catch (const InputError& error) {
    miss(key, error.what());
    return texture;
  }
  if (rgba == nullptr) {
    miss(key, "is damaged");
    return texture;
  }
  if (is_opacity) {
    take_opacity({rgba.get(), static_cast<std::size_t>(bytes)});
  }
  pixel_bytes_ += bytes;
  texture = std::make_shared<const Texture>(std::move(rgba), width, height);
  return texture;
}

std::shared_ptr<const Texture> Textures::beside(const std::string& name, bool is_opacity) {
  const auto known = known_.find({name, is_opacity});
  if (known != known_.end()) {
    return known->second;
  }
  if (path_.empty()) {
    miss(name, "is beside a file that has no place");
    return nullptr;
  }
  constexpr std::uint64_t kMostFileBytes = std::uint64_t{256} << 20;
  std::string found = name;
  SharedBytes file;
  const std::string fault = load_named(path_, found, kMostFileBytes, file);
  if (fault.empty()) {
    return inside(name, file.bytes, is_opacity);
  }
  known_[{name, is_opacity}] = nullptr;
  miss(name, fault);
  return nullptr;
}

void Textures::miss(const std::string& name, const std::string& reason) {
  fault("the picture " + tools::quoted(name) + " is not drawn: it " + reason);
}

void Textures::add_notes(Notes& notes) const {
  constexpr std::size_t kMostSentences = 3;
  for (std::size_t i = 0; i < std::min(faults_.size(), kMostSentences); ++i) {
    notes.push_back(faults_[i]);
  }
  note_if(faults_.size() > kMostSentences, notes,
          counted(faults_.size() - kMostSentences, "more picture is", "more pictures are"), " not drawn");
}

}  // namespace thimble::tools
