// `.obj` meshes (Wavefront).
//
// What is read: vertices `v x y z`, with colours `v x y z r g b` (color_scale.h) when every vertex has one, and
// faces `f` of any number of corners, whose indices count from 1 or, negative, back from the last vertex.
// Where vertices have none, faces have the colour `Kd` of their material in the `.mtl` files beside this one,
// and where a material has a picture and faces have texture coordinates, the picture's: of `.mtl` files `Kd`,
// `d`, `Ke` and their pictures are read. A line may continue after a backslash; a # that begins a word begins
// a comment. Lines, points and curves are noted, all other statements ignored, as normals and groups. Faces
// of fewer than three corners make no triangle. A file without faces becomes a point cloud.
#include <unordered_map>

#include "output/units.h"
#include "readers/color_scale.h"
#include "readers/texture.h"

namespace thimble::tools {

namespace {

/// What a `.mtl` says of a material.
struct ObjMaterial {
  bool is_described = false;
  std::optional<Rgb> color;
  std::optional<double> opacity;
  std::array<double, 3> emission{};
  std::string picture, opacity_picture, glow_picture;  ///< names from the file's folder, or empty
  bool clamps = false;
  bool moves = false;             ///< a picture has -o, -s or -t
  bool has_transparency = false;  ///< `Tr`, which some programs write as they write `d`
};

/// With none. More names than a file's faces can tell apart would take many times its bytes.
constexpr std::uint32_t kMostMaterials = 65536;
constexpr std::size_t kMostLibraries = 64;

/// The picture of a `map_` statement: what is left behind its options is a name, which may hold blanks.
std::string_view picture_name(std::string_view line, ObjMaterial* material) {
  for (;;) {
    std::string_view rest = line;
    const std::string_view option = take_word(rest);
    if (!option.starts_with('-') || option.size() < 2) {
      return trimmed(line);
    }
    const bool has_numbers = option == "-o" || option == "-s" || option == "-t";
    for (int words = has_numbers ? 3 : (option == "-mm" ? 2 : 1); words > 0; --words) {
      std::string_view behind = rest;
      const std::string_view word = take_word(behind);
      double number = 0;
      if (has_numbers && parse_number(word, number) != NumberKind::kFinite) {
        break;
      }
      material->moves = material->moves || (has_numbers && number != (option == "-s" ? 1 : 0));
      material->clamps = material->clamps || (option == "-clamp" && word == "on");
      rest = behind;
    }
    line = rest;
  }
}

/// Reads what `text`, a library in `folder`, says of the materials that have a number.
void read_library(std::string_view text, const std::string& folder,
                  const std::unordered_map<std::string, std::uint32_t>& numbers,
                  std::vector<ObjMaterial>& materials) {
  LineReader lines(text);
  ObjMaterial unused;  // what stands before the first material, or is of one that no face has
  ObjMaterial* material = &unused;
  for (std::string_view line; lines.next(line);) {
    const std::string_view word = take_word(line);
    double value = 0;
    if (word == "newmtl") {
      const auto found = numbers.find(std::string(trimmed(line)));
      material = found == numbers.end() || found->second == 0 ? &unused : &materials[found->second];
      material->is_described = true;
    } else if (word == "map_Kd" || word == "map_d" || word == "map_Ke") {
      const std::string_view name = picture_name(line, material);
      const bool is_whole = name.empty() || name.starts_with('/') || name.starts_with('\\');
      (word == "map_d"    ? material->opacity_picture
       : word == "map_Ke" ? material->glow_picture
                          : material->picture) = (is_whole ? "" : folder) + std::string(name);
    } else if (word == "Kd" || word == "Ke") {
      std::array<double, 3> color{};
      std::size_t count = 0;
      while (count < color.size() && parse_number(take_word(line), color[count]) == NumberKind::kFinite) {
        ++count;
      }
      if (count == 1 && trimmed(line).empty()) {  // one number is all three
        color[1] = color[2] = color[0];
        count = color.size();
      }
      const bool is_color = count == color.size();
      if (is_color && word == "Ke") {
        for (std::size_t i = 0; i < color.size(); ++i) {
          material->emission[i] = std::clamp(color[i], 0.0, 256.0);
        }
      } else if (is_color) {
        material->color = {unit_to_byte(color[0]), unit_to_byte(color[1]), unit_to_byte(color[2])};
      }
    } else if (word == "d" && parse_number(take_word(line), value) == NumberKind::kFinite) {
      material->opacity = value;
    } else if (word == "Tr" && parse_number(take_word(line), value) == NumberKind::kFinite) {
      material->has_transparency = value != 0;
    }
  }
}

// What materials say and is not drawn: of what is behind them only "nothing is there" is.
void note_undrawn(const std::vector<ObjMaterial>& used, std::vector<std::string>& notes) {
  std::size_t unread = 0;
  std::size_t partly = 0;
  std::size_t moved = 0;
  for (const ObjMaterial& material : used) {
    unread += material.has_transparency && !material.opacity ? 1U : 0U;
    partly += material.opacity && *material.opacity > 0 && *material.opacity < 1 ? 1U : 0U;
    moved += material.moves ? 1U : 0U;
  }
  note_if(unread != 0, notes, counted(unread, "material has", "materials have"),
          " Tr and no d: Tr is not read, since programs contradict each other in it");
  note_if(partly != 0, notes, counted(partly, "material is", "materials are"),
          " partly clear (d) and drawn solid");
  note_if(moved != 0, notes, counted(moved, "material has", "materials have"),
          " a picture that is moved or scaled (-o, -s, -t), which is not drawn: it is where vt says");
}

/// Which face has which material, by the names that an `.obj` uses, and what files beside it say of these.
class ObjMaterials {
 public:
  /// The rest of a line `mtllib` or `usemtl`: names may hold blanks.
  void add_library(std::string_view name) {
    const std::string_view found = trimmed(name);
    if (!found.empty() && libraries_.size() < kMostLibraries &&
        std::find(libraries_.begin(), libraries_.end(), found) == libraries_.end()) {
      libraries_.emplace_back(found);
    }
  }
  void use(std::string_view name) {
    const auto number = static_cast<std::uint32_t>(numbers_.size());
    if (number == kMostMaterials) {
      const auto found = numbers_.find(std::string(trimmed(name)));
      in_use_ = found == numbers_.end() ? 0 : found->second;
      has_more_ = has_more_ || found == numbers_.end();
      return;
    }
    in_use_ = numbers_.try_emplace(std::string(trimmed(name)), number).first->second;
  }

  /// Triangles `first` to `end` - 1 have the material in use.
  void take_triangles(std::size_t first, std::size_t end) {
    if (numbers_.size() > 1) {
      of_triangle_.resize(first);
      of_triangle_.resize(end, in_use_);
    }
  }

  /// Opens the libraries beside `path` and colours the faces of `mesh`, which gets surfaces with pictures;
  /// faces that are clear are left out. Nothing where no material has a colour. Where vertices have colours,
  /// these stay unless there is a picture. Adds the notes of what is missing and what is not drawn.
  /// @throws ShortageError  no descriptors or memory left to open a library
  void color_faces(const std::string& path, TriangleMesh& mesh) const {
    if (of_triangle_.empty()) {
      return;
    }
    Described described;
    std::vector<ObjMaterial>& used = described.materials;
    used.resize(numbers_.size());
    for (const std::string& name : path.empty() ? std::vector<std::string>() : libraries_) {
      read_libraries(path, name, described, mesh.notes);
    }
    Textures textures(path);
    mesh.surfaces.resize(used.size());
    std::size_t missing = 0;
    bool has_picture = false;
    bool has_surface = false;
    bool has_color = false;
    for (std::size_t i = 1; i < used.size(); ++i) {
      missing += used[i].is_described ? 0U : 1U;
      has_color = has_color || used[i].color;
      MeshSurface& surface = mesh.surfaces[i];
      surface.wrap_u = surface.wrap_v = used[i].clamps ? Wrap::kClamp : Wrap::kRepeat;
      const auto picture = [&](const std::string& named, bool is_opacity) -> std::shared_ptr<const Texture> {
        if (!named.empty() && mesh.texcoords.empty()) {
          textures.miss(named, "has no place, for no face has texture coordinates");
        }
        return named.empty() || mesh.texcoords.empty() ? nullptr : textures.beside(named, is_opacity);
      };
      surface.color = picture(used[i].picture, false);
      surface.opacity = picture(used[i].opacity_picture, true);
      surface.cutoff = surface.opacity != nullptr ? 0.5 : 0;
      has_picture = has_picture || surface.color != nullptr || surface.opacity != nullptr;
      surface.glow = picture(used[i].glow_picture, false);
      surface.emission = used[i].emission;
      if (surface.glow != nullptr && surface.emission == std::array<double, 3>{}) {
        surface.emission = {1, 1, 1};
      }
      has_surface = has_surface || has_picture || surface.emission != std::array<double, 3>{};
      // As with Ke above: some programs write no light at all where a picture says it.
      if (surface.color != nullptr && used[i].color == Rgb{0, 0, 0}) {
        used[i].color = Rgb{};
      }
    }
    textures.add_notes(mesh.notes);
    const bool has_others = !mesh.colors.empty() && !has_picture;  // vertices' colours, which are drawn
    note_if(missing != 0 && described.is_read && !has_others, mesh.notes,
            counted(missing, "material has", "materials have"), " no description and no color");
    note_if(missing != 0 && libraries_.empty() && !has_others, mesh.notes,
            "its materials are not drawn: no file is named that describes them (mtllib)");
    note_undrawn(used, mesh.notes);
    note_if(has_more_, mesh.notes, "materials behind the first ", kMostMaterials - 1, " are not drawn");
    if (has_picture) {
      mesh.colors = {};
    }
    const bool colors_faces = has_picture || (has_color && mesh.colors.empty());
    const bool has_corners = !mesh.texcoord_corners.empty();
    if (has_corners) {
      mesh.texcoord_corners.resize(mesh.triangles.size(), {kNoTexcoord, kNoTexcoord, kNoTexcoord});
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const std::uint32_t number = i < of_triangle_.size() ? of_triangle_[i] : 0;
      if (used[number].opacity.value_or(1) <= 0) {
        continue;
      }
      mesh.triangles[kept] = mesh.triangles[i];
      if (has_corners) {
        mesh.texcoord_corners[kept] = mesh.texcoord_corners[i];
      }
      if (colors_faces) {
        mesh.face_colors.push_back(used[number].color.value_or(Rgb{}));
      }
      if (has_surface) {
        mesh.surface_of.push_back(number);
      }
      ++kept;
    }
    fail_if(kept == 0, "all of its triangles are wholly clear (d 0)");
    if (kept < mesh.triangles.size()) {
      mesh.notes.push_back(counted(mesh.triangles.size() - kept, "triangle is", "triangles are") +
                           " wholly clear (d 0) and left out");
      mesh.triangles.resize(kept);
      mesh.texcoord_corners.resize(has_corners ? kept : 0);
    }
  }

 private:
  struct Described {
    std::vector<ObjMaterial> materials;
    bool is_read = false;
  };

  /// Reads the library that `line` names, or, where there is none, the several.
  void read_libraries(const std::string& path, const std::string& line, Described& described,
                      Notes& notes) const {
    const auto read = [&](const std::string& name) {
      std::string found = name;
      SharedBytes file;
      if (const std::string fault = load_named(path, found, kFileLimitBytes, file); !fault.empty()) {
        return "the materials of " + tools::quoted(name) + " beside it are not drawn: it " + fault;
      }
      read_library(file.text(), found.substr(0, found.rfind('/') + 1), numbers_, described.materials);
      described.is_read = true;
      return std::string();
    };
    constexpr std::string_view kBetween = ".mtl ";
    std::string fault = read(line);
    std::string_view rest = line;
    for (std::size_t i = 0;
         !fault.empty() && rest.find(kBetween) != std::string_view::npos && i < kMostLibraries; ++i) {
      const std::size_t end = rest.find(kBetween) + kBetween.size();
      const std::string missing = read(std::string(trimmed(rest.substr(0, end))));
      note_if(!missing.empty(), notes, missing);
      rest = trimmed(rest.substr(end));
      fault = rest.find(kBetween) == std::string_view::npos ? read(std::string(rest)) : fault;
    }
    note_if(!fault.empty(), notes, fault);
  }

  std::vector<std::string> libraries_;
  std::unordered_map<std::string, std::uint32_t> numbers_{{"", 0}};  ///< of the materials used; 0 is none
  bool has_more_ = false;
  std::uint32_t in_use_ = 0;
  std::vector<std::uint32_t> of_triangle_;  ///< empty as long as no material is used
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
    if (all_colored_) {  // what full is shows at the end
      scale_.add_note(mesh_.notes);
      mesh_.colors = scale_.colors(std::exchange(colors_, {}));
    }
    undrawn_ -= face_count_ == 0 ? points_ : 0;  // then all vertices are drawn
    note_if(undrawn_ != 0, mesh_.notes, "lines, points, curves and surfaces (l, p, curv, surf; ", undrawn_,
            " in all) are not drawn");
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
      points_ += keyword == "p" ? 1U : 0U;
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
    fail_at_line_if(mesh_.positions.size() >= kMeshVertexLimit, line_, "the mesh has more than ",
                    kMeshVertexLimit, " vertices");
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
      colors_.push_back(scale_.keep(color));
    }
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
        fail_at_line(line_, "the corner ", quoted(corner), " of a face is not an index");
      }
      fields[field] = value;
      rest.remove_prefix(slash == std::string_view::npos ? rest.size() : slash + 1);
    }
    return {fields[0], fields[1]};
  }

  [[noreturn]] void fail_index(std::uint64_t line, std::int64_t index) const {
    fail_at_line(
        line, "the face has the index ", index, ", but there ",
        mesh_.positions.size() == 1 ? "is 1 vertex" : concat("are ", mesh_.positions.size(), " vertices"),
        index <= 0 ? " before it, counted from 1" : " in the file, counted from 1");
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
  std::size_t points_ = 0;   ///< those of points
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
