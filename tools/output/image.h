/// Pictures as files: PPM (P6), PGM (P5), PBM (P4), PNG, JPEG, and PFM for distances.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thimble/picture/pixel.h"

namespace thimble::tools {

class OutputFile;

enum class ImageKind : std::uint8_t { kPpm, kPgm, kPbm, kPng, kJpeg };

/// Their endings, for errors and help.
inline constexpr const char* kImageEndings = ".png, .jpg, .ppm, .pgm or .pbm";

/// By the ending of `path`; `-` (standard output) is a PPM. Nothing for an ending that is not known.
std::optional<ImageKind> image_kind(const std::string& path);

/// The core's pixel format that a picture of that kind is drawn in.
PixelFormat pixel_format(ImageKind kind);

/// A picture in the core's layout: rows from the top, without gaps.
struct Image {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  PixelFormat format = PixelFormat::kRgb888;
  std::vector<std::uint8_t> pixels;
  /// How much of each pixel is covered, 0 .. 255, for pictures without a background: PNG, Rgb888. Empty: all.
  std::vector<std::uint8_t> alpha{};  // so that most need not name it
  std::int32_t first_row{0};          ///< of the whole picture, where these are some rows of it
};

/// Rows of a picture, or frames of a film.
struct RowRange {
  std::int32_t first = 0;
  std::int32_t count = 0;
};

/// The same picture in another format, pixel by pixel as a display shows it: 16 greys are 17 apart, channels
/// of 5 and 6 bits reach from 0 to 255, and a lit pixel is white. Into a format that holds less, as the core
/// stores that colour.
Image converted(const Image& image, PixelFormat format);

/// The pixel bytes as the file holds them (a PNG's and a JPEG's before compression): the core's, except that a PBM has 1
/// for black.
std::vector<std::uint8_t> file_pixels(const Image& image, ImageKind kind);

/// Writes the picture, header and all; committing is the caller's. Throws OutputError.
void write_image(OutputFile* file, ImageKind kind, const Image& image);

/// Writes the picture as a file of that name, which `image_kind` knows. Throws OutputError.
void write_picture(OutputFile* file, const std::string& path, const Image& image);

/// Writes float32 values, row by row from the top, as a little-endian PFM (whose rows go from the bottom).
void write_pfm(OutputFile* file, std::int32_t width_px, std::int32_t height_px,
               const std::vector<float>& values);

/// A whole PNG (ISO/IEC 15948), 8 bits a channel. `pixels`: rows from the top without gaps, `channels` bytes a pixel: 3 (r, g, b) or 4 (and
/// alpha). Sides are 1 or more. Throws std::bad_alloc.
std::vector<unsigned char> png_file(std::int32_t width_px, std::int32_t height_px, int channels,
                                    std::span<const std::uint8_t> pixels);

/// The same for a baseline JPEG (ISO/IEC 10918-1) of 3 channels with a quality of 1 to 100; up to 90 colours have half the resolution.
std::vector<unsigned char> jpeg_file(std::int32_t width_px, std::int32_t height_px,
                                     std::span<const std::uint8_t> pixels, int quality = 90);

}  // namespace thimble::tools
