#include "readers/gltf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "readers/gltf_file.h"
#include "readers/gltf_picture.h"
#include "readers/mesh.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

using nlohmann::json;

/// A point's place: rows of a matrix whose last row is 0 0 0 1.
using Placing = std::array<std::array<double, 4>, 3>;

constexpr Placing kAsItIs{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Placing after(const Placing& parent, const Placing& child) {
  Placing both{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      both[row][column] = parent[row][0] * child[0][column] + parent[row][1] * child[1][column] +
                          parent[row][2] * child[2][column] + (column == 3 ? parent[row][3] : 0);
    }
  }
  return both;
}

Placing placing_of(const json& node, const std::string& place) {
  Placing result = kAsItIs;
  if (gltf_member(node, "matrix") != nullptr) {
    std::array<double, 16> columns{};
    gltf_reals(node, "matrix", columns, place);
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 4; ++column) {
        result[row][column] = columns[4 * column + row];
      }
    }
    return result;
  }
  std::array<double, 3> move{};
  std::array<double, 3> scale{1, 1, 1};
  std::array<double, 4> turn{0, 0, 0, 1};
  gltf_reals(node, "translation", move, place);
  gltf_reals(node, "scale", scale, place);
  gltf_reals(node, "rotation", turn, place);
  const auto [x, y, z, w] = turn;
  const std::array<std::array<double, 3>, 3> rotation{
      {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
       {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
       {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      result[row][column] = rotation[row][column] * scale[column];
    }
    result[row][3] = move[row];
  }
  return result;
}

/// Colours are light in the file and bytes as screens take them here.
std::uint8_t screen_byte(double light) {
  if (!(light > 0)) {
    return 0;
  }
  return unit_to_byte(light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055);
}
double light_of(std::uint8_t byte) {
  const double value = byte / 255.0;
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

enum : std::uint64_t { kPoints = 0, kTriangles = 4, kStrip = 5, kFan = 6 };

/// A primitive at a node.
struct Part {
  const json* primitive;
  Placing placing;
  std::string place;
  std::uint64_t mode = kTriangles;
  std::uint64_t vertices = 0;
  std::uint64_t corners = 0;
};

class Scene {
 public:
  Scene(const SharedBytes& file, const std::string& path, const Progress& progress)
      : file_(file, path), progress_(progress) {}

  Source read() {
    find_parts();
    const bool has_faces =
        std::any_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.mode != kPoints; });
    std::erase_if(parts_, [&](const Part& part) { return has_faces && part.mode == kPoints; });
    reserve(has_faces);
    std::size_t done = 0;
    for (const Part& part : parts_) {
      add(part);
      if (progress_) {
        progress_(static_cast<double>(++done) / static_cast<double>(parts_.size()));
      }
    }
    if (!is_colored_) {
      mesh_.colors = {};
    }
    if (has_faces && mesh_.triangles.empty()) {
      throw InputError("the scene holds no triangles");
    }
    return mesh_or_points(std::move(mesh_), has_faces ? 1 : 0);
  }

 private:
  struct Visit {
    std::uint64_t node;
    Placing placing;
  };

  /// Walks the nodes; the specification has it that each has one parent.
  void find_parts() {
    std::vector<Visit> waiting;
    std::vector<bool> seen(static_cast<std::size_t>(file_.count("nodes")));
    const auto enter = [&](const json* list, const Placing& parent, const std::string& place) {
      for (std::size_t i = 0; list != nullptr && list->is_array() && i < list->size(); ++i) {
        const json& index = (*list)[i];
        const std::uint64_t node = index.is_number_unsigned() ? index.get<std::uint64_t>() : UINT64_MAX;
        if (node >= seen.size() || seen[static_cast<std::size_t>(node)]) {
          throw InputError(place + ": it names a node that is not there, or one that has a parent already");
        }
        seen[static_cast<std::size_t>(node)] = true;
        waiting.push_back({node, parent});
      }
    };
    if (file_.count("scenes") != 0) {
      const std::uint64_t scene = gltf_number(file_.root(), "scene", "the file").value_or(0);
      enter(gltf_member(file_.entry("scenes", scene), "nodes"), kAsItIs, "scene " + std::to_string(scene));
    } else {
      enter_roots(waiting, seen);
    }
    while (!waiting.empty()) {
      const Visit visit = waiting.back();
      waiting.pop_back();
      const std::string place = "node " + std::to_string(visit.node);
      const json& node = file_.entry("nodes", visit.node);
      const Placing placing = after(visit.placing, placing_of(node, place));
      if (const auto mesh = gltf_number(node, "mesh", place)) {
        add_mesh(*mesh, placing);
      }
      enter(gltf_member(node, "children"), placing, place);
    }
  }

  /// Without a scene: all nodes that are nobody's children.
  void enter_roots(std::vector<Visit>& waiting, std::vector<bool>& seen) const {
    std::vector<bool> is_child(seen.size());
    for (std::uint64_t i = 0; i < seen.size(); ++i) {
      const json* children = gltf_member(file_.entry("nodes", i), "children");
      for (std::size_t k = 0; children != nullptr && children->is_array() && k < children->size(); ++k) {
        if ((*children)[k].is_number_unsigned() && (*children)[k].get<std::uint64_t>() < seen.size()) {
          is_child[(*children)[k].get<std::size_t>()] = true;
        }
      }
    }
    for (std::uint64_t i = 0; i < seen.size(); ++i) {
      if (!is_child[static_cast<std::size_t>(i)]) {
        seen[static_cast<std::size_t>(i)] = true;
        waiting.push_back({i, kAsItIs});
      }
    }
  }

  void add_mesh(std::uint64_t mesh, const Placing& placing) {
    const json* primitives = gltf_member(file_.entry("meshes", mesh), "primitives");
    for (std::size_t i = 0; primitives != nullptr && primitives->is_array() && i < primitives->size(); ++i) {
      Part part{&(*primitives)[i], placing,
                "primitive " + std::to_string(i) + " of mesh " + std::to_string(mesh)};
      const json* extensions = gltf_member(*part.primitive, "extensions");
      if (extensions != nullptr && gltf_member(*extensions, "KHR_draco_mesh_compression") != nullptr) {
        throw InputError(part.place + ": it is compressed (KHR_draco_mesh_compression), which is not read");
      }
      part.mode = gltf_number(*part.primitive, "mode", part.place).value_or(kTriangles);
      const json* attributes = gltf_member(*part.primitive, "attributes");
      const bool is_drawn = part.mode == kPoints || (part.mode >= kTriangles && part.mode <= kFan);
      if (!is_drawn || attributes == nullptr || gltf_member(*attributes, "POSITION") == nullptr) {
        continue;  // lines, or nothing
      }
      const GltfAccessor positions = file_.accessor(*gltf_number(*attributes, "POSITION", part.place));
      if (positions.components != 3) {
        throw InputError(part.place + ": its positions have " + std::to_string(positions.components) +
                         " components, not 3");
      }
      part.vertices = positions.count;
      const auto indices = gltf_number(*part.primitive, "indices", part.place);
      part.corners = part.mode == kPoints ? 0 : (indices ? file_.accessor(*indices).count : part.vertices);
      bytes_ += kPartBytes + part.vertices * kVertexBytes + triangles_of(part) * kTriangleBytes;
      const std::uint64_t most = 3 * file_.bytes_read() + (std::uint64_t{64} << 20);
      if (bytes_ > most) {
        throw InputError("the scene places meshes that take more than the limit of " + std::to_string(most) +
                         " bytes, three times what the file holds and 64 MB");
      }
      parts_.push_back(std::move(part));
    }
  }

  static std::uint64_t triangles_of(const Part& part) {
    if (part.mode == kTriangles) {
      return part.corners / 3;
    }
    return part.corners < 3 ? 0 : part.corners - 2;
  }

  void reserve(bool has_faces) {
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
    for (const Part& part : parts_) {
      vertices += part.vertices;
      triangles += triangles_of(part);
    }
    if (vertices == 0 || vertices > kMeshVertexLimit) {
      throw InputError(vertices == 0 ? "the scene holds neither triangles nor points"
                                     : "the scene has more vertices than the limit of " +
                                           std::to_string(kMeshVertexLimit));
    }
    mesh_.positions.reserve(static_cast<std::size_t>(vertices));
    mesh_.colors.reserve(static_cast<std::size_t>(vertices));
    mesh_.triangles.reserve(has_faces ? static_cast<std::size_t>(triangles) : 0);
  }

  void add(const Part& part) {
    const json& attributes = *gltf_member(*part.primitive, "attributes");
    const GltfAccessor positions = file_.accessor(*gltf_number(attributes, "POSITION", part.place));
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (std::uint64_t i = 0; i < part.vertices; ++i) {
      const std::array<double, 3> local{positions.real(i, 0), positions.real(i, 1), positions.real(i, 2)};
      std::array<double, 3> world{};
      for (std::size_t row = 0; row < 3; ++row) {
        const auto& m = part.placing[row];
        world[row] = m[0] * local[0] + m[1] * local[1] + m[2] * local[2] + m[3];
        if (!std::isfinite(world[row])) {
          throw InputError(part.place + ": the position of vertex " + std::to_string(i) + " is not finite");
        }
      }
      mesh_.positions.push_back(world);
    }
    add_colors(part, attributes);
    if (part.mode != kPoints) {
      add_corners(part, first);
    }
  }

  void add_corners(const Part& part, std::uint32_t first) {
    const auto number = gltf_number(*part.primitive, "indices", part.place);
    const GltfAccessor indices = number ? file_.accessor(*number) : GltfAccessor{};
    if (number && indices.components != 1) {
      throw InputError(part.place + ": its indices are vectors");
    }
    Polygons fan(mesh_);
    TriangleStrip strip(mesh_);
    std::array<std::uint32_t, 3> corners{};
    for (std::uint64_t i = 0; i < part.corners; ++i) {
      const std::uint64_t index = number ? indices.index(i) : i;
      if (index >= part.vertices) {
        throw InputError(part.place + ": its corner " + std::to_string(i) + " has the index " +
                         std::to_string(index) + ", which is not one of its " +
                         std::to_string(part.vertices) + " vertices");
      }
      const auto corner = static_cast<std::uint32_t>(first + index);
      if (part.mode == kFan) {
        fan.add(corner);
      } else if (part.mode == kStrip) {
        strip.add(corner);
      } else {
        corners[i % 3] = corner;
        if (i % 3 == 2) {
          mesh_.triangles.push_back(corners);
        }
      }
    }
  }

  void add_colors(const Part& part, const json& attributes) {
    std::array<double, 4> factor{1, 1, 1, 1};
    find_material(part, factor);
    const auto texture = gltf_number(attributes, uv_name_.c_str(), part.place);
    const auto color = gltf_number(attributes, "COLOR_0", part.place);
    GltfAccessor corners;
    GltfAccessor colors;
    if (!picture_.is_empty() && texture) {
      corners = file_.accessor(*texture);
    }
    if (color) {
      colors = file_.accessor(*color);
    }
    const bool has_picture = corners.components == 2 && corners.count >= part.vertices;
    const bool has_colors = colors.components >= 3 && colors.count >= part.vertices;
    is_colored_ =
        is_colored_ || has_picture || has_colors || factor[0] != 1 || factor[1] != 1 || factor[2] != 1;
    for (std::uint64_t i = 0; i < part.vertices; ++i) {
      std::array<double, 3> light{factor[0], factor[1], factor[2]};
      if (has_picture) {
        const Rgb pixel = picture_.at(corners.real(i, 0), corners.real(i, 1));
        light = {light[0] * light_of(pixel.r), light[1] * light_of(pixel.g), light[2] * light_of(pixel.b)};
      }
      for (std::uint32_t channel = 0; has_colors && channel < 3; ++channel) {
        light[channel] *= colors.real(i, channel);
      }
      mesh_.colors.push_back({screen_byte(light[0]), screen_byte(light[1]), screen_byte(light[2])});
    }
  }

  /// The base colour of a part, and its picture where there is one; the last picture is kept, since parts of
  /// one material mostly follow each other.
  void find_material(const Part& part, std::array<double, 4>& factor) {
    const auto material = gltf_number(*part.primitive, "material", part.place);
    const json* surface =
        material ? gltf_member(file_.entry("materials", *material), "pbrMetallicRoughness") : nullptr;
    std::optional<std::uint64_t> image;
    if (surface != nullptr) {
      const std::string place = "material " + std::to_string(*material);
      gltf_reals(*surface, "baseColorFactor", factor, place);
      const json* texture = gltf_member(*surface, "baseColorTexture");
      if (texture != nullptr && gltf_member(*texture, "index") != nullptr) {
        uv_name_ = "TEXCOORD_" + std::to_string(gltf_number(*texture, "texCoord", place).value_or(0));
        image = gltf_number(file_.entry("textures", *gltf_number(*texture, "index", place)), "source", place);
      }
    }
    if (image != image_) {
      image_ = image;
      picture_ = image ? read_picture(*image) : GltfPicture();
    }
  }

  GltfPicture read_picture(std::uint64_t image) {
    const std::string place = "image " + std::to_string(image);
    // So many that decoding takes long are left out with the large ones.
    constexpr int kMostPictures = 256;
    const std::uint64_t limit = 2 * file_.bytes_read() + (std::uint64_t{48} << 20);
    if (++pictures_ > kMostPictures) {
      return {};
    }
    const json& entry = file_.entry("images", image);
    if (const auto view = gltf_number(entry, "bufferView", place)) {
      return GltfPicture(file_.buffer_view(*view), limit);
    }
    const json* uri = gltf_member(entry, "uri");
    if (uri == nullptr || !uri->is_string()) {
      return {};
    }
    try {
      return GltfPicture(file_.link(uri->get_ref<const std::string&>(), place).bytes, limit);
    } catch (const ShortageError&) {
      throw;
    } catch (const InputError&) {
      return {};  // shapes without their pictures are worth having
    }
  }

  static constexpr std::uint64_t kPartBytes = 256;
  static constexpr std::uint64_t kVertexBytes = 27;
  static constexpr std::uint64_t kTriangleBytes = 12;

  GltfFile file_;
  const Progress& progress_;
  std::vector<Part> parts_;
  std::uint64_t bytes_ = 0;
  TriangleMesh mesh_;
  bool is_colored_ = false;
  std::optional<std::uint64_t> image_;
  GltfPicture picture_;
  std::string uv_name_ = "TEXCOORD_0";
  int pictures_ = 0;
};

}  // namespace

bool has_gltf_reader() {
  return true;
}
bool looks_like_gltf(std::span<const std::uint8_t> bytes) {
  const std::string_view text = SharedBytes{bytes, nullptr}.text();
  if (text.starts_with("glTF")) {
    return true;
  }
  std::string_view rest = text.substr(text.starts_with("\xEF\xBB\xBF") ? 3 : 0);
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
  return rest.starts_with('{');
}

Source read_gltf(const SharedBytes& file, const std::string& path, const Progress& progress) {
  return Scene(file, path, progress).read();
}

}  // namespace thimble::tools
