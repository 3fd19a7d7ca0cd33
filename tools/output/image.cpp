#include "output/image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>
#include <span>

#include "output/output_file.h"
#include "output/png.h"
#include "thimble/picture/render.h"

namespace thimble::tools {
namespace {

std::string ending_of(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  const std::size_t slash = path.rfind('/');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) {
    return {};
  }
  std::string ending = path.substr(dot);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

std::optional<ImageKind> image_kind(const std::string& path) {
  // In the order of `ImageKind`.
  constexpr std::array<std::string_view, 5> kEndings{".ppm", ".pgm", ".pbm", ".png", ".jpg"};
  const std::string ending = path == "-" ? ".ppm" : ending_of(path);
  const auto* const found = std::find(kEndings.begin(), kEndings.end(), ending == ".jpeg" ? ".jpg" : ending);
  return found == kEndings.end() ? std::nullopt
                                 : std::optional(static_cast<ImageKind>(found - kEndings.begin()));
}

PixelFormat pixel_format(ImageKind kind) {
  return kind == ImageKind::kPbm   ? PixelFormat::kMono1
         : kind == ImageKind::kPgm ? PixelFormat::kGray8
                                   : PixelFormat::kRgb888;
}

Image converted(const Image& image, PixelFormat format) {
  if (image.format == format) {
    return image;
  }
  Image result{image.width_px,
               image.height_px,
               format,
               std::vector<std::uint8_t>(band_bytes(format, image.width_px, image.height_px)),
               {},
               image.first_row};
  for (std::int32_t y = 0; y < image.height_px; ++y) {
    const std::uint8_t* from =
        image.pixels.data() + row_place(image.format, y) * row_bytes(image.format, image.width_px);
    std::uint8_t* to = result.pixels.data() + row_place(format, y) * row_bytes(format, image.width_px);
    for (std::int32_t x = 0; x < image.width_px; ++x) {
      const std::int32_t row = image.first_row + y;
      store_pixel(to, x, row, format, load_pixel(from, x, row, image.format));
    }
  }
  return result;
}

std::vector<std::uint8_t> file_pixels(const Image& image, ImageKind kind) {
  std::vector<std::uint8_t> pixels = image.pixels;
  if (kind == ImageKind::kPng && !image.alpha.empty()) {
    pixels.clear();
    for (std::size_t i = 0; i < image.alpha.size(); ++i) {
      pixels.insert(pixels.end(),
                    {image.pixels[3 * i], image.pixels[3 * i + 1], image.pixels[3 * i + 2], image.alpha[i]});
    }
  }
  if (kind == ImageKind::kPbm) {
    // 1 is black in a PBM; the padding at a row's end stays 0.
    const std::size_t row = row_bytes(PixelFormat::kMono1, image.width_px);
    const unsigned spare = static_cast<unsigned>(8 * row - static_cast<std::size_t>(image.width_px));
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const unsigned keep = (i + 1) % row == 0 ? 0xFFU << spare : 0xFFU;
      pixels[i] = static_cast<std::uint8_t>(~pixels[i] & keep);
    }
  }
  return pixels;
}

void write_image(OutputFile* file, ImageKind kind, const Image& image) {
  const std::vector<std::uint8_t> pixels = file_pixels(image, kind);
  const std::string size = std::to_string(image.width_px) + " " + std::to_string(image.height_px) + "\n";
  switch (kind) {
    case ImageKind::kPpm:
      file->write("P6\n" + size + "255\n");
      break;
    case ImageKind::kPgm:
      file->write("P5\n" + size + "255\n");
      break;
    case ImageKind::kPbm:
      file->write("P4\n" + size);
      break;
    case ImageKind::kPng:
      file->write(std::span<const unsigned char>(
          png_file(image.width_px, image.height_px, image.alpha.empty() ? 3 : 4, pixels)));
      return;
    case ImageKind::kJpeg:
      file->write(std::span<const unsigned char>(jpeg_file(image.width_px, image.height_px, pixels)));
      return;
  }
  file->write(std::span<const unsigned char>(pixels));
}

void write_picture(OutputFile* file, const std::string& path, const Image& image) {
  const ImageKind kind = image_kind(path).value();
  write_image(file, kind, converted(image, pixel_format(kind)));
}

void write_pfm(OutputFile* file, std::int32_t width_px, std::int32_t height_px,
               const std::vector<float>& values) {
  static_assert(std::endian::native == std::endian::little, "the scale -1 says little-endian");
  file->write("Pf\n" + std::to_string(width_px) + " " + std::to_string(height_px) + "\n-1.0\n");
  const std::size_t width = static_cast<std::size_t>(width_px);
  for (std::size_t row = static_cast<std::size_t>(height_px); row-- > 0;) {
    std::vector<unsigned char> bytes(4 * width);
    std::memcpy(bytes.data(), values.data() + row * width, bytes.size());
    file->write(std::span<const unsigned char>(bytes));
  }
}

}  // namespace thimble::tools
