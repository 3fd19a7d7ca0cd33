#include "readers/obj_materials.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "output/units.h"
#include "readers/file_bytes.h"
#include "readers/mesh.h"
#include "readers/text.h"
#include "readers/texture.h"

namespace thimble::tools {

struct ObjMaterial {
  bool is_described = false;
  std::optional<Rgb> color;
  std::optional<double> opacity;
  std::array<double, 3> emission{};
  std::string picture, opacity_picture, glow_picture;  ///< names from the file's folder, or empty
  bool clamps = false;
  bool has_transparency = false;  ///< `Tr`, which some programs write as they write `d`
};

namespace {

/// With none. More names than a file's faces can tell apart would take many times its bytes.
constexpr std::uint32_t kMostMaterials = 65536;
constexpr std::size_t kMostLibraries = 64;

/// The picture of a `map_` statement: what is left behind its options is a name, which may hold blanks.
std::string_view picture_name(std::string_view line, bool* clamps) {
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
      *clamps = *clamps || (option == "-clamp" && word == "on");
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
      const std::string_view name = picture_name(line, &material->clamps);
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

// What materials say of what is behind them, of which only "nothing is there" is drawn.
void note_clearness(const std::vector<ObjMaterial>& used, std::vector<std::string>& notes) {
  std::size_t unread = 0;
  std::size_t partly = 0;
  for (const ObjMaterial& material : used) {
    unread += material.has_transparency && !material.opacity ? 1U : 0U;
    partly += material.opacity && *material.opacity > 0 && *material.opacity < 1 ? 1U : 0U;
  }
  if (unread != 0) {
    notes.push_back(counted(unread, "material has", "materials have") +
                    " Tr and no d: Tr is not read, since programs contradict each other in it");
  }
  if (partly != 0) {
    notes.push_back(counted(partly, "material is", "materials are") + " partly clear (d) and drawn solid");
  }
}

}  // namespace

void ObjMaterials::add_library(std::string_view name) {
  const std::string_view found = trimmed(name);
  if (!found.empty() && libraries_.size() < kMostLibraries &&
      std::find(libraries_.begin(), libraries_.end(), found) == libraries_.end()) {
    libraries_.emplace_back(found);
  }
}

void ObjMaterials::use(std::string_view name) {
  const auto number = static_cast<std::uint32_t>(numbers_.size());
  if (number == kMostMaterials) {
    const auto found = numbers_.find(std::string(trimmed(name)));
    in_use_ = found == numbers_.end() ? 0 : found->second;
    has_more_ = has_more_ || found == numbers_.end();
    return;
  }
  in_use_ = numbers_.try_emplace(std::string(trimmed(name)), number).first->second;
}

void ObjMaterials::take_triangles(std::size_t first, std::size_t end) {
  if (numbers_.size() > 1) {
    of_triangle_.resize(first);
    of_triangle_.resize(end, in_use_);
  }
}

struct ObjMaterials::Described {
  std::vector<ObjMaterial> materials;
  bool is_read = false;
};

void ObjMaterials::read_libraries(const std::string& path, const std::string& line, Described& described,
                                  Notes& notes) const {
  const auto read = [&](const std::string& name) {
    std::string slashed = name;
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    FileBytes file;
    const std::string fault =
        load_beside(slashed.starts_with('/') ? slashed : path.substr(0, path.rfind('/') + 1) + slashed,
                    kFileLimitBytes, file);
    if (!fault.empty()) {
      return "the materials of " + tools::quoted(name) + " beside it are not drawn: it " + fault;
    }
    read_library(file.text(), slashed.substr(0, slashed.rfind('/') + 1), numbers_, described.materials);
    described.is_read = true;
    return std::string();
  };
  constexpr std::string_view kBetween = ".mtl ";
  std::string fault = read(line);
  std::string_view rest = line;
  for (std::size_t i = 0;
       !fault.empty() && rest.find(kBetween) != std::string_view::npos && i < kMostLibraries; ++i) {
    const std::size_t end = rest.find(kBetween) + kBetween.size();
    if (std::string missing = read(std::string(trimmed(rest.substr(0, end)))); !missing.empty()) {
      notes.push_back(std::move(missing));
    }
    rest = trimmed(rest.substr(end));
    fault = rest.find(kBetween) == std::string_view::npos ? read(std::string(rest)) : fault;
  }
  if (!fault.empty()) {
    notes.push_back(std::move(fault));
  }
}

void ObjMaterials::color_faces(const std::string& path, TriangleMesh& mesh) const {
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
      surface.emission = {1, 1, 1};  // as of Kd: some programs write no light at all where a picture says it
    }
    has_surface = has_surface || has_picture || surface.emission != std::array<double, 3>{};
    // Some programs write no light at all where a picture says it.
    if (surface.color != nullptr && used[i].color == Rgb{0, 0, 0}) {
      used[i].color = Rgb{};
    }
  }
  textures.add_notes(mesh.notes);
  const bool has_others = !mesh.colors.empty() && !has_picture;  // vertices' colours, which are drawn
  if (missing != 0 && described.is_read && !has_others) {
    mesh.notes.push_back(counted(missing, "material has", "materials have") + " no description and no color");
  } else if (missing != 0 && libraries_.empty() && !has_others) {
    mesh.notes.push_back("its materials are not drawn: no file is named that describes them (mtllib)");
  }
  note_clearness(used, mesh.notes);
  if (has_more_) {
    mesh.notes.push_back("materials behind the first " + std::to_string(kMostMaterials - 1) +
                         " are not drawn");
  }
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
  if (kept < mesh.triangles.size()) {
    mesh.notes.push_back(counted(mesh.triangles.size() - kept, "triangle is", "triangles are") +
                         " wholly clear (d 0) and left out");
    mesh.triangles.resize(kept);
    mesh.texcoord_corners.resize(has_corners ? kept : 0);
  }
}

}  // namespace thimble::tools
