#include "readers/read_any.h"

#include <algorithm>
#include <array>
#include <utility>

#include "readers/gadget.h"
#include "readers/obj.h"
#include "readers/oct.h"
#include "readers/off.h"
#include "readers/ply.h"
#include "readers/text.h"
#include "readers/vox.h"
#include "readers/xyz.h"

namespace thimble::tools {

namespace {

Source read_vox_source(const SharedBytes& file, const Progress& progress) {
  return read_vox(file, progress);
}

bool looks_like_vox(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kMagic = "VOX ";
  return bytes.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin());
}

// The one place that knows all formats.
constexpr std::array<ReaderRow, 7> kRows{{
    {".vox", "MagicaVoxel model", read_vox_source, looks_like_vox},
    {".ply", "PLY mesh or points", read_ply, looks_like_ply},
    {".obj", "Wavefront mesh", read_obj, nullptr},
    {".off", "OFF mesh", read_off, looks_like_off},
    {".xyz .csv", "points, one a line", read_xyz, nullptr},
    {".dat", "Gadget-1 snapshot", read_gadget, looks_like_gadget},
    {".oct", "baked scene", read_oct, looks_like_oct},
}};

bool has_ending(std::string_view path, std::string_view ending) {
  return path.size() > ending.size() &&
         equals_ignoring_case(path.substr(path.size() - ending.size()), ending);
}

}  // namespace

std::span<const ReaderRow> reader_rows() {
  return kRows;
}

const ReaderRow* find_reader(std::string_view path, std::span<const std::uint8_t> bytes) {
  if (has_ending(path, ".gz")) {
    path.remove_suffix(3);
  }
  for (const ReaderRow& row : kRows) {
    std::string_view endings = row.endings;
    for (std::string_view ending = take_word(endings); !ending.empty(); ending = take_word(endings)) {
      if (has_ending(path, ending)) {
        return &row;
      }
    }
  }
  for (const ReaderRow& row : kRows) {
    if (row.looks_like != nullptr && row.looks_like(bytes)) {
      return &row;
    }
  }
  return nullptr;
}

std::string reader_endings() {
  std::string out;
  for (const ReaderRow& row : kRows) {
    std::string_view endings = row.endings;
    for (std::string_view ending = take_word(endings); !ending.empty(); ending = take_word(endings)) {
      out += (out.empty() ? "" : ", ") + std::string(ending);
    }
  }
  return out;
}

Source read_any(std::string_view path, const SharedBytes& file, const Progress& progress) {
  const ReaderRow* row = find_reader(path, file.bytes);
  if (row == nullptr) {
    throw InputError("neither the name nor the contents tell what this file is; known endings are " +
                     reader_endings());
  }
  return row->read(file, progress);
}

}  // namespace thimble::tools
