// `.off` meshes (Geomview's Object File Format, the text form).
//
// What is read: the keyword `OFF` with any of the prefixes `ST`, `C` and `N` in that order (texture
// coordinates, colours, normals); the counts of vertices, faces and edges after it or on a later line;
// comments from # to the end of the line. A vertex is three coordinates, then a normal, a colour and texture
// coordinates as the keyword says; only the colour is used. A face is a count of corners and as many
// indices, then an optional colour, which is ignored; faces of fewer than three corners make no triangle.
// A file without faces becomes a point cloud.
//
// Where there are as many lines as vertices and faces, what else stands on the last line of one is passed
// over. In a file of fewer lines (several on one, all on one) the words alone count: a vertex is as many
// numbers as the keyword says, with C three of a colour, and a face has no colour.
//
// Colours (keyword with C): three or four numbers, the fourth ignored. In a file where all of them are
// whole numbers and one is above 1, they go from 0 to 255; otherwise from 0 to 1. What lies outside is
// clamped.
//
// Not read: `OFF BINARY` and the forms of other dimensions (`4OFF`, `nOFF`); both are refused by name.
//
// Source of the format: Geomview manual, chapter "OFF Files".
#include "readers/color_scale.h"

namespace thimble::tools {

namespace {

struct Keyword {
  bool known = false;
  std::string_view count;  ///< of vertices, where it stands right behind, as in "OFF8 6 12"
  bool has_normals = false;
  bool has_colors = false;
};

Keyword parse_keyword(std::string_view word) {
  Keyword keyword;
  if (word.starts_with("ST")) {
    word.remove_prefix(2);
  }
  if (word.starts_with('C')) {
    keyword.has_colors = true;
    word.remove_prefix(1);
  }
  if (word.starts_with('N')) {
    keyword.has_normals = true;
    word.remove_prefix(1);
  }
  keyword.known = word.starts_with("OFF");
  if (keyword.known) {
    keyword.count = word.substr(3);
    std::int64_t count = 0;
    keyword.known = keyword.count.empty() || parse_integer(keyword.count, count);
  }
  return keyword;
}

class OffParser {
 public:
  OffParser(std::string_view text, const ReadOptions& options, const Progress& progress)
      : words_(text, '#'), meter_(progress, text.size()), scale_(options), face_scale_(options) {}

  Source parse() {
    header();
    vertices();
    faces();
    const std::string_view word = words_.next();
    note_if(!word.empty(), mesh_.notes, "line ", words_.line(), ": ", quoted(word),
            " and what follows comes after the last face and is not read");
    (face_colors_.empty() ? scale_ : face_scale_).add_note(mesh_.notes);
    return mesh_or_points(std::move(mesh_), face_count_);
  }

 private:
  template <class... Pieces>
  void fail_if(bool is_wrong, const Pieces&... pieces) const {
    fail_at_line_if(is_wrong, words_.line(), pieces...);
  }

  void header() {
    const std::string_view word = words_.next();
    keyword_ = parse_keyword(word);
    tools::fail_if(word.empty(), "the file is empty or holds only comments");
    fail_if(!keyword_.known, "the file begins with ", quoted(word),
            ", not with OFF, COFF, NOFF, CNOFF or ST before these");
    vertex_count_ = keyword_.count.empty() ? count("vertices") : count("vertices", keyword_.count);
    face_count_ = count("faces");
    count("edges");
    fail_if(vertex_count_ > kMeshVertexLimit, "the mesh has ", vertex_count_, " vertices, the limit is ",
            kMeshVertexLimit);
    // The shortest vertex is "0 0 0" with what separates it from the next, the shortest face "0".
    check_room(vertex_count_, 6, "vertices");
    check_room(face_count_, 2, "faces");
    is_by_line_ = words_.has_lines(vertex_count_ + face_count_);
    end_item();
  }

  /// A vertex or a face is over: what else stands on its line is of no use, unless it is the next one.
  void end_item() {
    if (is_by_line_) {
      words_.skip_line();
    }
  }

  std::uint64_t count(const char* what) { return count(what, words_.next()); }
  std::uint64_t count(const char* what, std::string_view word) const {
    std::int64_t value = 0;
    fail_if(word == "BINARY", "binary OFF is not supported");
    fail_if(!parse_integer(word, value) || value < 0, "the number of ", what, " is ", quoted(word));
    return static_cast<std::uint64_t>(value);
  }

  void check_room(std::uint64_t declared, std::uint64_t least_bytes, const char* what) const {
    const std::uint64_t room = (std::uint64_t{words_.remaining()} + 1) / least_bytes;
    tools::fail_if(declared > room, "the header declares ", declared, " ", what,
                   ", but the file has room for ", room, " at most");
  }

  double number(const char* what, std::uint64_t vertex) {
    const std::string_view word = words_.next();
    fail_if(word.empty(), "the file ends in vertex ", vertex, " of ", vertex_count_);
    double value = 0;
    if (parse_number(word, value) != NumberKind::kFinite) {
      // The sentence is made only when it is needed: this runs for every coordinate.
      finite_number(word, words_.line(), concat(what, " of vertex ", vertex));
    }
    return value;
  }

  void vertices() {
    mesh_.positions.reserve(static_cast<std::size_t>(vertex_count_));
    std::vector<std::array<float, 3>> colors;
    if (keyword_.has_colors) {
      colors.reserve(static_cast<std::size_t>(vertex_count_));
    }
    for (std::uint64_t vertex = 0; vertex < vertex_count_; ++vertex) {
      std::array<double, 3> position{};
      for (double& coordinate : position) {
        coordinate = number("a coordinate", vertex);
      }
      mesh_.positions.push_back(position);
      for (int i = 0; keyword_.has_normals && (keyword_.has_colors || !is_by_line_) && i < 3; ++i) {
        number("the normal", vertex);
      }
      if (keyword_.has_colors) {
        std::array<double, 3> color{};
        for (double& component : color) {
          component = number("the color", vertex);
        }
        colors.push_back(scale_.keep(color));
      }
      end_item();
      meter_.at(words_.offset());
    }
    mesh_.colors = scale_.colors(colors);
  }

  std::int64_t integer(std::uint64_t face) {
    const std::string_view word = words_.next();
    std::int64_t value = 0;
    fail_if(word.empty(), "the file ends in face ", face, " of ", face_count_);
    if (!parse_integer(word, value)) {
      fail_at_line(words_.line(), quoted(word), " in face ", face, " is not a whole number");
    }
    return value;
  }

  void faces() {
    mesh_.triangles.reserve(static_cast<std::size_t>(face_count_));
    for (std::uint64_t face = 0; face < face_count_; ++face) {
      const std::int64_t corners = integer(face);
      fail_if(corners < 0, "face ", face, " has ", corners, " corners");
      const std::size_t before = mesh_.triangles.size();
      polygons_.begin();
      for (std::int64_t i = 0; i < corners; ++i) {
        const std::int64_t index = integer(face);
        fail_if(index < 0 || static_cast<std::uint64_t>(index) >= vertex_count_, "face ", face,
                " has the index ", index, ", which is not one of the ", vertex_count_, " vertices");
        polygons_.add(static_cast<std::uint32_t>(index));
      }
      const std::array<float, 3> color = is_by_line_ ? face_color() : kNoColor;
      if (!face_colors_.empty() || color != kNoColor) {
        face_colors_.resize(before, kNoColor);
        face_colors_.resize(mesh_.triangles.size(), color);
      }
      end_item();
      meter_.at(words_.offset());
    }
    if (has_listed_colors_) {
      mesh_.notes.push_back(
          "colors of faces are places in a list that no file brings along: they are not drawn");
    }
    polygons_.cut_ears();
    mesh_.face_colors = face_scale_.colors(face_colors_);
  }

  /// Three or four numbers behind the corners are the face's colour. Negative: there is none.
  std::array<float, 3> face_color() {
    std::array<double, 4> values{};
    std::size_t count = 0;
    for (std::string_view word = words_.next_on_line(); !word.empty(); word = words_.next_on_line()) {
      if (count == values.size() || parse_number(word, values[count]) != NumberKind::kFinite) {
        return kNoColor;
      }
      ++count;
    }
    has_listed_colors_ = has_listed_colors_ || count == 1;
    return count < 3 ? kNoColor : face_scale_.keep(values);
  }

  static constexpr std::array<float, 3> kNoColor{-1, -1, -1};
  WordReader words_;
  ProgressMeter meter_;
  Keyword keyword_;
  std::uint64_t vertex_count_ = 0;
  std::uint64_t face_count_ = 0;
  bool is_by_line_ = true;
  bool has_listed_colors_ = false;
  TriangleMesh mesh_;
  Polygons polygons_{mesh_};
  std::vector<std::array<float, 3>> face_colors_;
  ColorScale scale_, face_scale_;  ///< of vertices, of faces
};

}  // namespace

/// True when the first word is a keyword that `read_off` accepts.
bool looks_like_off(std::string_view text) {
  return parse_keyword(WordReader(text, '#').next()).known;
}

/// Memory: 24 bytes a vertex, 15 more with colour (12 of them only while reading), 12 a triangle. The counts
/// are held against the bytes that follow before anything is allocated.
/// @throws InputError  naming the line: no keyword, a count that the bytes cannot hold, a file that ends
///   early, a word that is no finite number, an index that is no vertex
Source read_off(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  return OffParser(file.text(), options, progress).parse();
}

}  // namespace thimble::tools
