/// Parts of a picture or of a film, drawn apart and put together by `thimble join`.
///
/// A part is a header of 48 bytes, its rows from the top (or its frames, each row by row), and a CRC-32 of all
/// before it. Numbers are little-endian, of 32 bits but for the bytes 8 .. 11:
///
///    0  "thmPART1"
///    8  kind: 0 rows of a picture, 1 frames of a turntable, 2 frames of a camera's path, 3 of an animation
///    9  pixels: 0 r, g, b; 1 r, g, b and how much is covered; 2 a bit each, the leftmost the highest, 1 white
///   10  1: a .pbm of it would be dithered from finer shades than these
///   11  0
///   12  width and height of the whole picture or film, 1 .. 16,384
///   20  the first row or frame here, counted from 0; how many are here; how many the whole has
///   32  CRC-32 of the scene, of the camera or all cameras, and of the options that change the picture
///   44  CRC-32 of the bytes 0 .. 43
///
/// Rows of a bit a pixel end on whole bytes. A part says nothing of time, machine, threads or engine: the same part
/// has the same bytes wherever it was drawn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "thimble/picture/pixel.h"

namespace thimble::tools {

class OutputFile;

/// Most frames of a film.
inline constexpr std::uint32_t kMostFilmFrames = 100'000;

enum class PartKind : std::uint8_t { kRows, kTurntable, kCameraPath, kAnimation };
enum class PartPixels : std::uint8_t { kRgb, kRgba, kMono };

struct PartHeader {
  PartKind kind = PartKind::kRows;
  PartPixels pixels = PartPixels::kRgb;
  bool has_finer_shades = false;
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  std::uint32_t first = 0;  ///< row or frame
  std::uint32_t count = 0;
  std::uint32_t all = 0;
  std::uint32_t scene_crc32 = 0;
  std::uint32_t camera_crc32 = 0;
  std::uint32_t options_crc32 = 0;

  /// "row" or "frame".
  const char* unit() const { return kind == PartKind::kRows ? "row" : "frame"; }
  /// Bytes of one of them.
  std::size_t unit_bytes() const;
};

/// Writes a part as it is drawn.
class PartWriter {
 public:
  /// Writes the header. The file outlives this. Throws OutputError, as the others do.
  PartWriter(OutputFile* file, const PartHeader& header);
  /// Whole rows or frames, `header.count` of them in all.
  void add(std::span<const std::uint8_t> bytes);
  /// The checksum behind them. Committing is the caller's.
  void end();

 private:
  OutputFile* file_;
  std::uint32_t crc_ = 0;
};

/// A part that was looked at from its first byte to its last. It keeps its header alone, so that many of them take
/// no memory and no open file.
class PartFile {
 public:
  /// Reads all of the file `path` once. Throws InputError "PATH: ..." for what is no part, cut off, longer than it
  /// says or damaged.
  static PartFile open(const std::string& path);

  const std::string& path() const { return path_; }
  const PartHeader& header() const { return header_; }
  /// The bytes of a row or frame that it holds, by its place in the whole. Throws InputError when the file went
  /// away meanwhile.
  std::vector<std::uint8_t> read(std::uint32_t unit) const;

 private:
  std::string path_;
  PartHeader header_;
};

}  // namespace thimble::tools
