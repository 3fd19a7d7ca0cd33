#include "readers/obj_materials.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "readers/file_bytes.h"
#include "readers/mesh.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

/// With none. More names than a file's faces can tell apart would take many times its bytes.
constexpr std::uint32_t kMostMaterials = 65536;

struct ObjMaterial {
  bool is_described = false;
  std::optional<Rgb> color;
  double opacity = 1;
  bool has_picture = false;
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && is_space(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

/// Reads what `text` says of the materials that have a number.
void read_library(std::string_view text, const std::unordered_map<std::string, std::uint32_t>& numbers,
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
    } else if (word == "map_Kd") {
      material->has_picture = true;
    } else if (word == "Kd") {
      std::array<double, 3> color{};
      bool is_color = true;
      for (double& component : color) {
        is_color = is_color && parse_number(take_word(line), component) == NumberKind::kFinite;
      }
      if (is_color) {
        material->color = {unit_to_byte(color[0]), unit_to_byte(color[1]), unit_to_byte(color[2])};
      }
    } else if (word == "d" && parse_number(take_word(line), value) == NumberKind::kFinite) {
      material->opacity = value;  // not Tr: of what is opaque some programs say 0 there, some 1
    }
  }
}

}  // namespace

void ObjMaterials::add_library(std::string_view name) {
  constexpr std::size_t kMostLibraries = 64;
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

void ObjMaterials::color_faces(const std::string& path, TriangleMesh& mesh) const {
  if (of_triangle_.empty()) {
    return;
  }
  std::vector<ObjMaterial> used(numbers_.size());
  bool is_read = false;
  for (const std::string& name : path.empty() ? std::vector<std::string>() : libraries_) {
    std::string slashed = name;
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    try {
      const FileBytes file =
          load_file(slashed.starts_with('/') ? slashed : path.substr(0, path.rfind('/') + 1) + slashed);
      read_library(file.text(), numbers_, used);
      is_read = true;
    } catch (const ShortageError&) {
      throw;
    } catch (const InputError& error) {
      mesh.notes.push_back("the materials of " + quoted(name) + " beside it are not drawn: it " +
                           error.what());
    }
  }
  std::size_t missing = 0;
  std::size_t pictures = 0;
  bool has_color = false;
  for (std::size_t i = 1; i < used.size(); ++i) {
    missing += used[i].is_described ? 0U : 1U;
    pictures += used[i].has_picture ? 1U : 0U;
    has_color = has_color || used[i].color;
  }
  const auto count = [](std::size_t number, const char* one, const char* more) {
    return std::to_string(number) + (number == 1 ? one : more);
  };
  if (missing != 0 && is_read) {
    mesh.notes.push_back(count(missing, " material has", " materials have") + " no description and no color");
  } else if (missing != 0 && libraries_.empty()) {
    mesh.notes.push_back("its materials are not drawn: no file is named that describes them (mtllib)");
  }
  if (has_more_) {
    mesh.notes.push_back("materials behind the first " + std::to_string(kMostMaterials - 1) +
                         " are not drawn");
  }
  if (pictures != 0) {
    mesh.notes.push_back(
        count(pictures, " material's picture (map_Kd) is", " materials' pictures (map_Kd) are") +
        " not drawn");
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const ObjMaterial& material = used[i < of_triangle_.size() ? of_triangle_[i] : 0];
    if (material.opacity <= 0) {
      continue;
    }
    triangles.push_back(mesh.triangles[i]);
    if (has_color) {
      mesh.face_colors.push_back(material.color.value_or(Rgb{}));
    }
  }
  if (triangles.size() < mesh.triangles.size()) {
    mesh.notes.push_back(count(mesh.triangles.size() - triangles.size(), " triangle is", " triangles are") +
                         " wholly clear (d 0) and left out");
    mesh.triangles = std::move(triangles);
  }
}

}  // namespace thimble::tools
