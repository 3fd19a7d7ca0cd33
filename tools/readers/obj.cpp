// `.obj` meshes (Wavefront).
//
// What is read: vertices `v x y z`, with colours `v x y z r g b` (color_scale.h) when every vertex has one, and
// faces `f` of any number of corners, whose indices count from 1 or, negative, back from the last vertex.
// Where vertices have none, faces have the colour `Kd` of their material in the `.mtl` files beside this one, and
// where a material has a picture and faces have texture coordinates, the picture's (obj_materials.h). A line may
// continue after a backslash; a # that begins a word begins a comment. Lines, points and curves are noted, all other
// statements ignored, as normals and groups. Faces of fewer than three corners make no triangle. A file without faces
// becomes a point cloud.
#include "readers/formats.h"

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "readers/color_scale.h"
#include "readers/mesh.h"
#include "readers/obj_materials.h"
#include "readers/text.h"

namespace thimble::tools {

namespace {

/// How many lines begin with `v` and how many with `f`: as much as is worth making room for at once.
std::array<std::size_t, 2> count_statements(std::string_view text) {
  std::array<std::size_t, 2> counts{};
  char before = '\n';
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    const bool begins = (before == '\n' || before == '\r') && (text[i + 1] == ' ' || text[i + 1] == '\t');
    counts[0] += begins && text[i] == 'v' ? 1U : 0U;
    counts[1] += begins && text[i] == 'f' ? 1U : 0U;
    before = text[i];
  }
  return counts;
}

class ObjParser {
 public:
  ObjParser(std::string_view text, const ReadOptions& options, const Progress& progress)
      : path_(options.path), scale_(options), lines_(text), meter_(progress, text.size()) {
    const auto [vertices, faces] = count_statements(text);
    mesh_.positions.reserve(vertices);
    mesh_.triangles.reserve(faces);
  }

  Source parse() {
    for (std::string_view line; lines_.next(line);) {
      line_ = lines_.line_number();
      meter_.at(lines_.offset());
      statement(line);
    }
    if (highest_index_ >= mesh_.positions.size() && face_count_ != 0) {
      fail_index(highest_line_, static_cast<std::int64_t>(highest_index_) + 1);
    }
    color_vertices();
    if (undrawn_ != 0) {
      mesh_.notes.push_back("lines, points, curves and surfaces (l, p, curv, surf; " +
                            std::to_string(undrawn_) + " in all) are not drawn");
    }
    polygons_.cut_ears();
    if (mesh_.texcoord_corners.empty()) {
      mesh_.texcoords = {};  // no face has any
    }
    materials_.color_faces(path_, mesh_);
    check_texcoords(mesh_);
    return mesh_or_points(std::move(mesh_), face_count_);
  }

 private:
  /// One statement, of which `line` is the first.
  void statement(std::string_view line) {
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (keyword == "usemtl") {
      materials_.use(rest);
    } else if (keyword == "mtllib") {
      materials_.add_library(rest);
    } else if (keyword == "vt") {
      std::array<double, 2> place{};
      for (double& coordinate : place) {
        parse_number(take_word(rest), coordinate);  // stays 0 where it is none
      }
      mesh_.texcoords.push_back({static_cast<float>(place[0]), static_cast<float>(1 - place[1])});
    } else if (keyword == "l" || keyword == "p" || keyword == "curv" || keyword == "surf") {
      ++undrawn_;
    }
    const bool is_vertex = keyword == "v";
    const bool is_face = keyword == "f";
    if (line.ends_with('\\') && !keyword.starts_with('#')) {
      words_.clear();
      append(rest, is_vertex || is_face);
      while (line.ends_with('\\') && lines_.next(line)) {
        append(line, is_vertex || is_face);
      }
      rest = words_;
    }
    if (is_vertex) {
      vertex(without_comment(rest));
    } else if (is_face) {
      face(without_comment(rest));
    }
  }

  /// Adds a line of a statement of several.
  void append(std::string_view words, bool is_wanted) {
    if (is_wanted) {
      words = without_comment(words);
      words_.append(words.substr(0, words.size() - (words.ends_with('\\') ? 1 : 0))) += ' ';
    }
  }

  void vertex(std::string_view words) {
    static constexpr std::array<const char*, 3> kNames{"x", "y", "z"};
    if (mesh_.positions.size() >= kMeshVertexLimit) {
      fail_at_line(line_, "the mesh has more than " + std::to_string(kMeshVertexLimit) + " vertices");
    }
    std::array<double, 3> position{};
    for (std::size_t i = 0; i < 3; ++i) {
      position[i] = finite_number(take_word(words), line_, kNames[i]);
    }
    std::array<double, 3> color{};
    bool colored = true;
    for (double& component : color) {
      colored = colored && parse_number(take_word(words), component) == NumberKind::kFinite;
    }
    mesh_.positions.push_back(position);
    all_colored_ = all_colored_ && colored;
    if (all_colored_) {
      colors_.reserve(mesh_.positions.capacity());
      auto& kept = colors_.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        kept[i] = scale_.clamped(color[i]);
        scale_.see(static_cast<double>(kept[i]));
      }
    }
  }

  /// What full is shows at the end.
  void color_vertices() {
    if (!all_colored_) {
      return;
    }
    scale_.add_note(mesh_.notes);
    mesh_.colors.reserve(colors_.size());
    for (const auto& [red, green, blue] : colors_) {
      mesh_.colors.push_back(
          scale_.color(static_cast<double>(red), static_cast<double>(green), static_cast<double>(blue)));
    }
    colors_ = {};
  }

  void face(std::string_view words) {
    ++face_count_;
    const std::size_t first_triangle = mesh_.triangles.size();
    polygons_.begin();
    const std::size_t vertex_count = mesh_.positions.size();
    for (std::string_view corner = take_word(words); !corner.empty(); corner = take_word(words)) {
      const auto [written, texcoord] = indices_of(corner);
      const std::int64_t index =
          written > 0 ? written - 1 : static_cast<std::int64_t>(vertex_count) + written;
      if (written == 0 || index < 0) {
        fail_index(line_, written);
      }
      // A vertex may come after the faces that use it, so whether the index is too high shows at the end.
      if (static_cast<std::uint64_t>(index) > highest_index_ || highest_line_ == 0) {
        highest_index_ = static_cast<std::uint64_t>(index);
        highest_line_ = line_;
      }
      polygons_.add(static_cast<std::uint32_t>(index), texcoord_of(texcoord));
    }
    materials_.take_triangles(first_triangle, mesh_.triangles.size());
  }

  /// The number of a texture coordinate that is written as `written`; there may be more of them behind the face.
  std::uint32_t texcoord_of(std::int64_t written) const {
    const auto count = static_cast<std::int64_t>(mesh_.texcoords.size());
    const std::int64_t number = written > 0 ? written - 1 : count + written;
    return written == 0 || number < 0 ? kNoTexcoord : static_cast<std::uint32_t>(number);
  }

  /// The vertex and the texture coordinate of a corner as they are written, 0 where there is none.
  std::array<std::int64_t, 2> indices_of(std::string_view corner) const {
    std::array<std::int64_t, 3> fields{};
    std::string_view rest = corner;
    for (std::size_t field = 0; !rest.empty() || field == 0; ++field) {
      const std::size_t slash = rest.find('/');
      const std::string_view number = rest.substr(0, slash);
      std::int64_t value = 0;
      const bool may_be_empty = field > 0;
      if (field > 2 || !((may_be_empty && number.empty()) || parse_integer(number, value)) ||
          value > INT32_MAX || value < -INT32_MAX) {
        fail_at_line(line_, "the corner " + quoted(corner) + " of a face is not an index");
      }
      fields[field] = value;
      rest.remove_prefix(slash == std::string_view::npos ? rest.size() : slash + 1);
    }
    return {fields[0], fields[1]};
  }

  [[noreturn]] void fail_index(std::uint64_t line, std::int64_t index) const {
    fail_at_line(line, "the face has the index " + std::to_string(index) + ", but there " +
                           (mesh_.positions.size() == 1
                                ? "is 1 vertex"
                                : "are " + std::to_string(mesh_.positions.size()) + " vertices") +
                           (index <= 0 ? " before it, counted from 1" : " in the file, counted from 1"));
  }

  const std::string& path_;
  ColorScale scale_;
  std::vector<std::array<float, 3>> colors_;  ///< of vertices, as written
  ObjMaterials materials_;
  TriangleMesh mesh_;
  LineReader lines_;
  ProgressMeter meter_;
  std::uint64_t line_ = 0;  ///< on which the statement begins
  std::string words_;       ///< of a statement of several lines
  Polygons polygons_{mesh_};
  bool all_colored_ = true;
  std::size_t undrawn_ = 0;  ///< statements of lines, points and curves
  std::uint64_t face_count_ = 0;
  std::uint64_t highest_index_ = 0;
  std::uint64_t highest_line_ = 0;
};

}  // namespace

/// Memory: 24 bytes a vertex (39 with colour), 8 a texture coordinate, 12 a triangle (19 with materials, 35 with
/// pictures), at most three times the triangles' while they grow, which only polygons make them, and the longest line
/// twice.
/// @throws InputError  naming the line: a coordinate that is missing or no finite number, an index that is
///   zero, no integer or no vertex of the file
Source read_obj(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  return ObjParser(file.text(), options, progress).parse();
}

}  // namespace thimble::tools
