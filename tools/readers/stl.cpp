// `.stl` meshes, as text and as binary.
//
// A file is binary when it does not begin with the word `solid`, or holds a zero byte in its first
// `kFirstLookBytes`: exporters have written binary files that begin so. Of a text all `vertex` lines count, three a
// facet, of any number of solids; of a binary file bytes behind the last triangle are noted, and so are attributes: as colours
// programs write them in ways that contradict each other. Normals are not used. Corners are not joined: each triangle has three positions of its own.
//
// z is up, as the programs have it that make such files.
//
// Source of the format: 3D Systems, "StereoLithography Interface Specification", 1989.
#include "readers/formats.h"

#include "output/units.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kStlHeaderBytes = 80;
constexpr std::size_t kTriangleBytes = 50;

bool begins_with_solid(std::string_view text) {
  std::string_view line = text.substr(mark_bytes(text), 64);
  return equals_ignoring_case(take_word(line), "solid");
}

/// Adds a triangle of three new positions.
void add(TriangleMesh& mesh, const std::array<std::array<double, 3>, 3>& corners) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
}

void reserve(TriangleMesh& mesh, std::uint64_t triangles) {
  constexpr std::uint64_t kMost = UINT32_MAX / 3;
  fail_if(triangles > kMost, "the file holds ", triangles, " triangles, the limit is ", kMost);
  mesh.positions.reserve(static_cast<std::size_t>(3 * triangles));
  mesh.triangles.reserve(static_cast<std::size_t>(triangles));
}

TriangleMesh read_binary(const SharedBytes& file, ProgressMeter& meter) {
  ByteReader reader(file.bytes);
  reader.skip(kStlHeaderBytes);
  const std::uint32_t count = reader.u32();
  fail_if(reader.remaining() / kTriangleBytes < count, "the header counts ", count,
          " triangles, but the file has room for ", reader.remaining() / kTriangleBytes);
  TriangleMesh mesh;
  reserve(mesh, count);
  std::uint32_t attributed = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    reader.skip(3 * sizeof(float));  // the normal
    std::array<std::array<double, 3>, 3> corners{};
    for (auto& corner : corners) {
      for (double& coordinate : corner) {
        coordinate = static_cast<double>(reader.f32());
        reader.fail_if(!std::isfinite(coordinate), "a coordinate of triangle ", i,
                       " is not finite, before byte offset ", reader.offset());
      }
    }
    attributed += reader.u16() != 0 ? 1U : 0U;
    add(mesh, corners);
    meter.at(reader.offset());
  }
  fail_if(count == 0 && reader.remaining() != 0, "the header counts no triangles, but ", reader.remaining(),
          " bytes follow it");
  note_if(attributed != 0, mesh.notes, counted(attributed, "triangle has", "triangles have"),
          " attributes, which may be colors; they are not read");
  note_if(reader.remaining() != 0, mesh.notes, reader.remaining(), " bytes behind the last of the ", count,
          " triangles that the header counts are not read");
  return mesh;
}

std::uint64_t count_facets(std::string_view text) {
  std::uint64_t facets = 0;
  for (std::size_t at = text.find("endfacet"); at != std::string_view::npos;
       at = text.find("endfacet", at + 8)) {
    ++facets;
  }
  return facets;
}

TriangleMesh read_text(std::string_view text, ProgressMeter& meter) {
  static constexpr std::array<const char*, 3> kNames{"x", "y", "z"};
  TriangleMesh mesh;
  reserve(mesh, count_facets(text));
  LineReader lines(text);
  std::string_view line;
  std::array<std::array<double, 3>, 3> corners{};
  std::size_t count = 0;
  bool in_facet = false;
  while (lines.next(line)) {
    meter.at(lines.offset());
    const std::string_view word = take_word(line);
    if (equals_ignoring_case(word, "vertex")) {
      fail_at_line_if(
          !in_facet || count == 3, lines.line_number(),
          in_facet ? "the facet has more than three corners" : "a corner stands outside of any facet");
      for (std::size_t axis = 0; axis < 3; ++axis) {
        corners[count][axis] = finite_number(take_word(line), lines.line_number(), kNames[axis]);
      }
      ++count;
    } else if (equals_ignoring_case(word, "facet")) {
      fail_at_line_if(in_facet, lines.line_number(), "a facet begins within another one");
      in_facet = true;
      count = 0;
    } else if (equals_ignoring_case(word, "endfacet")) {
      fail_at_line_if(!in_facet || count != 3, lines.line_number(), "the facet has ", count,
                      " corners, not three");
      in_facet = false;
      add(mesh, corners);
    }
  }
  fail_at_line_if(in_facet, lines.line_number(), "the file ends within a facet");
  return mesh;
}

}  // namespace

/// Recognises the text form; a binary file does not say what it is.
bool looks_like_stl(std::string_view text) {
  return begins_with_solid(text) && text.substr(0, kFirstLookBytes).find("facet") != std::string_view::npos &&
         text.substr(0, kFirstLookBytes).find('\0') == std::string_view::npos;
}

/// Memory: 84 bytes a triangle, which takes at least 50 in the file.
/// @throws InputError  a count that the bytes cannot hold, a facet that has not three corners, a coordinate
///   that is no finite number, no triangle
Source read_stl(const SharedBytes& file, const ReadOptions&, const Progress& progress) {
  ProgressMeter meter(progress, file.bytes.size());
  // Many binary files begin with "solid", too; no text holds a zero byte.
  const std::string_view first = file.text().substr(0, kFirstLookBytes);
  const bool is_binary = !begins_with_solid(first) || first.find('\0') != std::string_view::npos;
  TriangleMesh mesh = is_binary ? read_binary(file, meter) : read_text(file.text(), meter);
  fail_if(mesh.triangles.empty(), "the file holds no triangles");
  mesh.is_z_up = true;
  return mesh;
}

}  // namespace thimble::tools
