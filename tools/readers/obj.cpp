// `.obj` meshes (Wavefront), parsed by tinyobjloader.
//
// What is read: vertices `v x y z`, with colours `v x y z r g b` (0 to 1) when every vertex has one, and
// faces `f` of any number of corners, whose indices count from 1 or, negative, back from the last vertex.
// Where vertices have none, faces have the colour `Kd` of their material in the `.mtl` files beside this one, and
// where a material has a picture and faces have texture coordinates, the picture's (obj_materials.h). A line may
// continue after a backslash; a # that begins a word begins a comment. All other statements are ignored: normals,
// groups, lines and curves play no part. Faces of fewer than three corners make no triangle. A file without faces
// becomes a point cloud.
//
// tinyobjloader reads what is no number as 0, so each line is checked here before it gets there; and the
// parser is used through its callbacks, which hold one statement at a time, and given only `v` and `f`
// statements, because some of the others allocate whatever a number in them says.
#include "readers/formats.h"

#include <tiny_obj_loader.h>

#include <array>
#include <charconv>
#include <cstddef>
#include <istream>
#include <streambuf>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include "readers/mesh.h"
#include "readers/obj_materials.h"
#include "readers/text.h"

namespace thimble::tools {

namespace {

// The library comes in both precisions; map coordinates need the double one.
static_assert(std::is_same_v<tinyobj::real_t, double>, "link tinyobjloader::tinyobjloader_double");

/// Hands the `v` and `f` statements of a file to a stream, one a time, as "v words\n". So whoever is called
/// back from the parser can ask which statement it is about.
class StatementBuffer final : public std::streambuf {
 public:
  /// @param texcoords  is given what `vt` statements say
  StatementBuffer(std::string_view text, const Progress& progress, ObjMaterials& materials,
                  std::vector<std::array<float, 2>>& texcoords)
      : lines_(text), meter_(progress, text.size()), materials_(materials), texcoords_(texcoords) {}

  /// The current statement's words after `v` or `f`.
  std::string_view arguments() const { return std::string_view(statement_).substr(1, statement_.size() - 2); }
  /// The line on which the current statement begins.
  std::uint64_t line() const { return first_line_; }
  /// For the callbacks: what throws in `underflow` would be swallowed by the stream.
  void report_progress() { meter_.at(lines_.offset()); }

 protected:
  int_type underflow() override {
    std::string_view line;
    while (lines_.next(line)) {
      first_line_ = lines_.line_number();
      std::string_view rest = line;
      const std::string_view keyword = take_word(rest);
      const bool is_wanted = keyword == "v" || keyword == "f";
      const bool is_comment = keyword.starts_with('#');
      if (keyword == "usemtl") {
        materials_.use(rest);
      } else if (keyword == "mtllib") {
        materials_.add_library(rest);
      } else if (keyword == "vt") {
        std::array<double, 2> place{};
        for (double& coordinate : place) {
          parse_number(take_word(rest), coordinate);  // stays 0 where it is none
        }
        texcoords_.push_back({static_cast<float>(place[0]), static_cast<float>(1 - place[1])});
      }
      if (is_wanted) {
        statement_.assign(keyword);
        statement_ += ' ';
      }
      append(rest, is_wanted);
      while (!is_comment && !line.empty() && line.back() == '\\' && lines_.next(line)) {
        append(line, is_wanted);
      }
      if (is_wanted) {
        statement_ += '\n';
        setg(statement_.data(), statement_.data(), statement_.data() + statement_.size());
        return traits_type::to_int_type(statement_.front());
      }
    }
    return traits_type::eof();
  }

 private:
  void append(std::string_view words, bool is_wanted) {
    if (!is_wanted) {
      return;
    }
    words = without_comment(words);
    if (words.ends_with('\\')) {
      words.remove_suffix(1);
    }
    // The parser knows blanks and tabs only, and ends at a zero byte: a '?' makes it the error that it is.
    for (const char c : words) {
      statement_ += is_space(c) ? ' ' : (c == 0 ? '?' : c);
    }
    statement_ += ' ';
  }

  LineReader lines_;
  ProgressMeter meter_;
  ObjMaterials& materials_;
  std::vector<std::array<float, 2>>& texcoords_;
  std::string statement_;
  std::uint64_t first_line_ = 0;
};

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
  ObjParser(std::string_view text, const std::string& path, const Progress& progress)
      : path_(path), buffer_(text, progress, materials_, mesh_.texcoords) {
    const auto [vertices, faces] = count_statements(text);
    mesh_.positions.reserve(vertices);
    mesh_.triangles.reserve(faces);
  }

  Source parse() {
    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = [](void* self, double, double, double, double) {
      static_cast<ObjParser*>(self)->vertex();
    };
    callbacks.index_cb = [](void* self, tinyobj::index_t* indices, int count) {
      static_cast<ObjParser*>(self)->face(indices, static_cast<std::size_t>(count));
    };
    std::istream stream(&buffer_);
    std::string warning;
    std::string error;
    const bool done = tinyobj::LoadObjWithCallback(stream, callbacks, this, nullptr, &warning, &error);
    if (!done || stream.bad() || !error.empty()) {
      throw InputError("tinyobjloader: " + one_line(error + warning));
    }
    if (highest_index_ >= mesh_.positions.size() && face_count_ != 0) {
      fail_index(highest_line_, static_cast<std::int64_t>(highest_index_) + 1);
    }
    if (!all_colored_) {
      mesh_.colors = {};
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
  static std::string one_line(std::string text) {
    for (char& c : text) {
      c = (c >= ' ' && c <= '~') ? c : ' ';
    }
    while (!text.empty() && (text.back() == ' ' || text.back() == '.')) {
      text.pop_back();
    }
    return text.empty() ? "the file cannot be read" : text;
  }

  /// One vertex. The numbers are read from the statement again: exactly rounded, and without mistaking what
  /// is no number for 0.
  void vertex() {
    static constexpr std::array<const char*, 3> kNames{"x", "y", "z"};
    buffer_.report_progress();
    if (mesh_.positions.size() >= kMeshVertexLimit) {
      fail_at_line(buffer_.line(),
                   "the mesh has more than " + std::to_string(kMeshVertexLimit) + " vertices");
    }
    std::string_view words = buffer_.arguments();
    std::array<double, 3> position{};
    for (std::size_t i = 0; i < 3; ++i) {
      position[i] = finite_number(take_word(words), buffer_.line(), kNames[i]);
    }
    std::array<double, 3> color{};
    bool colored = true;
    for (double& component : color) {
      colored = colored && parse_number(take_word(words), component) == NumberKind::kFinite;
    }
    mesh_.positions.push_back(position);
    all_colored_ = all_colored_ && colored;
    if (all_colored_) {
      if (mesh_.colors.empty()) {
        mesh_.colors.reserve(mesh_.positions.capacity());
      }
      mesh_.colors.push_back({unit_to_byte(color[0]), unit_to_byte(color[1]), unit_to_byte(color[2])});
    }
  }

  void face(const tinyobj::index_t* indices, std::size_t corners) {
    buffer_.report_progress();
    check_corners();
    ++face_count_;
    const std::size_t first_triangle = mesh_.triangles.size();
    polygons_.begin();
    const std::size_t vertex_count = mesh_.positions.size();
    for (std::size_t i = 0; i < corners; ++i) {
      const std::int64_t written = indices[i].vertex_index;
      const std::int64_t index =
          written > 0 ? written - 1 : static_cast<std::int64_t>(vertex_count) + written;
      if (written == 0 || index < 0) {
        fail_index(buffer_.line(), written);
      }
      // A vertex may come after the faces that use it, so whether the index is too high shows at the end.
      if (static_cast<std::uint64_t>(index) > highest_index_ || highest_line_ == 0) {
        highest_index_ = static_cast<std::uint64_t>(index);
        highest_line_ = buffer_.line();
      }
      polygons_.add(static_cast<std::uint32_t>(index), texcoord_of(indices[i].texcoord_index));
    }
    materials_.take_triangles(first_triangle, mesh_.triangles.size());
  }

  /// The number of a texture coordinate that is written as `written`; there may be more of them behind the face.
  std::uint32_t texcoord_of(std::int64_t written) const {
    const auto count = static_cast<std::int64_t>(mesh_.texcoords.size());
    const std::int64_t number = written > 0 ? written - 1 : count + written;
    return written == 0 || number < 0 ? kNoTexcoord : static_cast<std::uint32_t>(number);
  }

  /// The parser takes "x" for 0 and 4294967297 for 1; holds the fields of all corners to be integers.
  void check_corners() const {
    std::string_view words = buffer_.arguments();
    for (std::string_view corner = take_word(words); !corner.empty(); corner = take_word(words)) {
      std::string_view rest = corner;
      for (int field = 0; !rest.empty() || field == 0; ++field) {
        const std::size_t slash = rest.find('/');
        const std::string_view number = rest.substr(0, slash);
        std::int64_t value = 0;
        const bool may_be_empty = field > 0;
        if (field > 2 || !((may_be_empty && number.empty()) || parse_integer(number, value)) ||
            value > INT32_MAX || value < -INT32_MAX) {
          fail_at_line(buffer_.line(), "the corner " + quoted(corner) + " of a face is not an index");
        }
        rest.remove_prefix(slash == std::string_view::npos ? rest.size() : slash + 1);
      }
    }
  }

  [[noreturn]] void fail_index(std::uint64_t line, std::int64_t index) const {
    fail_at_line(line, "the face has the index " + std::to_string(index) + ", but there " +
                           (mesh_.positions.size() == 1
                                ? "is 1 vertex"
                                : "are " + std::to_string(mesh_.positions.size()) + " vertices") +
                           (index <= 0 ? " before it, counted from 1" : " in the file, counted from 1"));
  }

  const std::string& path_;
  ObjMaterials materials_;
  TriangleMesh mesh_;
  StatementBuffer buffer_;
  Polygons polygons_{mesh_};
  bool all_colored_ = true;
  std::uint64_t face_count_ = 0;
  std::uint64_t highest_index_ = 0;
  std::uint64_t highest_line_ = 0;
};

}  // namespace

/// Memory: 24 bytes a vertex (27 with colour), 8 a texture coordinate, 12 a triangle (19 with materials, 35 with
/// pictures), at most three times the triangles' while they grow, which only polygons make them, and the longest line
/// twice.
/// @throws InputError  naming the line: a coordinate that is missing or no finite number, an index that is
///   zero, no integer or no vertex of the file
Source read_obj(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  return ObjParser(file.text(), options.path, progress).parse();
}

}  // namespace thimble::tools
