/// The header of a `.ply` file: which elements it holds, and what their properties are to us. Internal to its reader.
#pragma once

#include <array>
#include <vector>

#include "readers/file_bytes.h"

namespace thimble::tools {

enum class PlyEncoding : std::uint8_t { kAscii, kLittleEndian, kBigEndian };

/// What a property is to us. The first nine are positions in an array of a vertex's values.
enum class PlyRole : std::uint8_t {
  kX,
  kY,
  kZ,
  kRed,
  kGreen,
  kBlue,
  kOpacity,
  kU,
  kV,
  kIndices,
  kTexcoords,  ///< u and v of each corner of a face
  kPicture,    ///< the number of a face's picture
  kUnused
};
constexpr std::size_t kPlyVertexValues = 9;

/// As many as a file's lines may name.
constexpr std::size_t kMostPlyPictures = 256;

enum class PlyElementKind : std::uint8_t { kVertex, kFace, kStrips, kOther };

struct PlyProperty {
  NumberType type;
  NumberType count_type;  ///< of a list
  bool is_list = false;
  PlyRole role = PlyRole::kUnused;
  bool is_harmonic = false;  ///< a Gaussian splat's mean colour, as the first of its spherical harmonics
};

struct PlyElement {
  std::string name;
  PlyElementKind kind = PlyElementKind::kOther;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::size_t body_offset = 0;
  std::uint64_t body_line = 0;        ///< line number of the body's first byte
  std::vector<std::string> pictures;  ///< that comments name, in their order
};

bool has_role(const PlyElement& element, PlyRole role);

/// The header at the front of `text`, the whole file.
/// @throws InputError  it is broken
PlyHeader read_ply_header(std::string_view text);

}  // namespace thimble::tools
