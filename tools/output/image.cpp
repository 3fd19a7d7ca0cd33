#include "output/image.h"

#include <bit>

#include "output/output_file.h"
#include "output/units.h"
#include "thimble/picture/render.h"

namespace thimble::tools {

std::optional<ImageKind> image_kind(const std::string& path) {
  // A name may be nothing but an ending. In the order of `ImageKind`.
  return path == "-" ? ImageKind::kPpm
         : ends_in("/" + path, ".jpeg")
             ? ImageKind::kJpeg
             : kind_by_ending<ImageKind>("/" + path, {".ppm", ".pgm", ".pbm", ".png", ".jpg"});
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
  if (kind == ImageKind::kPng) {
    file->write(png_file(image.width_px, image.height_px, image.alpha.empty() ? 3 : 4, pixels));
  } else if (kind == ImageKind::kJpeg) {
    file->write(jpeg_file(image.width_px, image.height_px, pixels));
  } else {
    const char* const magic = kind == ImageKind::kPpm ? "P6" : kind == ImageKind::kPgm ? "P5" : "P4";
    file->write(concat(magic, "\n", image.width_px, " ", image.height_px, "\n",
                       kind == ImageKind::kPbm ? "" : "255\n"));
    file->write(pixels);
  }
}

void write_picture(OutputFile* file, const std::string& path, const Image& image) {
  const ImageKind kind = image_kind(path).value();
  write_image(file, kind, converted(image, pixel_format(kind)));
}

void write_pfm(OutputFile* file, std::int32_t width_px, std::int32_t height_px,
               const std::vector<float>& values) {
  static_assert(std::endian::native == std::endian::little, "the scale -1 says little-endian");
  file->write(concat("Pf\n", width_px, " ", height_px, "\n-1.0\n"));
  const std::size_t width = static_cast<std::size_t>(width_px);
  for (std::size_t row = static_cast<std::size_t>(height_px); row-- > 0;) {
    file->write({reinterpret_cast<const unsigned char*>(values.data() + row * width), 4 * width});
  }
}

}  // namespace thimble::tools
