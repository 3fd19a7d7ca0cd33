// glTF 2.0 scenes: `.gltf` (JSON) and `.glb`.
//
// What is read: the nodes of the default scene (of a file without one, all) with their transforms and instances
// (EXT_mesh_gpu_instancing), the triangles, strips and fans of their meshes, packed by Draco, too, or where there are
// none the points, and colours: the material's base colour (or the diffuse one of
// KHR_materials_pbrSpecularGlossiness), its picture by its coordinates, transform and wrap modes, and COLOR_0,
// multiplied. With alphaMode MASK what is less opaque than the cutoff is nothing, with BLEND what is less than a tenth;
// vertices' alpha decides for a whole triangle. Light that a material gives off (emissive factor, strength and picture)
// is drawn where its picture lies as the colour's; where all materials are unlit, colours are drawn without light.
// Buffers are in the file, in `data:` links or in files beside it; a link that leaves the file's folder is refused. y
// is up.
//
// Not read: what a file requires and is not known here (meshopt), which is refused by name, while of lights, materials
// and pictures it is noted; skins, morphs and animations, so that things stand as they are at rest; lights and cameras.
// A picture that is not read is noted.
//
// JSON is parsed by nlohmann's library, which takes some hundred bytes a value: a file is refused that has
// more than `kGltfValueLimit` of them, or nests them deeper than `kGltfDepthLimit`.
//
// Source of the format: Khronos Group, "glTF 2.0 Specification".
#include "readers/formats.h"

#include <limits>

#include "output/units.h"
#include "readers/gltf_file.h"
#include "readers/mesh.h"
#include "readers/texture.h"

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

/// A placing as it is written apart.
struct Standing {
  std::array<double, 3> move{};
  std::array<double, 3> scale{1, 1, 1};
  std::array<double, 4> turn{0, 0, 0, 1};

  Placing placing() const {
    const auto [x, y, z, w] = turn;
    const std::array<std::array<double, 3>, 3> rotation{
        {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
         {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
         {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
    Placing result{};
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        result[row][column] = rotation[row][column] * scale[column];
      }
      result[row][3] = move[row];
    }
    return result;
  }
};

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
  Standing standing;
  gltf_reals(node, "translation", standing.move, place);
  gltf_reals(node, "scale", standing.scale, place);
  gltf_reals(node, "rotation", standing.turn, place);
  return standing.placing();
}

enum : std::uint64_t { kPoints = 0, kTriangles = 4, kStrip = 5, kFan = 6 };

/// What a material says of the colour of its triangles.
struct Look {
  std::array<double, 4> factor{1, 1, 1, 1};
  double cutoff = 0;          ///< of alpha, or 0
  std::uint32_t surface = 0;  ///< of the mesh; 0: it has neither pictures nor light of its own
  std::string texcoord;       ///< the attribute's name
  /// From coordinates as they are written to those on the picture: rows of a matrix.
  std::array<std::array<double, 3>, 2> moved{{{1, 0, 0}, {0, 1, 0}}};
  std::array<Wrap, 2> wraps{Wrap::kRepeat, Wrap::kRepeat};

  bool lies_as(const Look& other) const {
    return texcoord == other.texcoord && moved == other.moved && wraps == other.wraps;
  }
};

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
      : file_(file, path), progress_(progress), textures_(path) {}

  Source read() {
    check_extensions();
    find_parts();
    const bool has_faces =
        std::any_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.mode != kPoints; });
    if (has_faces) {
      undrawn_["the points beside triangles"] +=
          std::erase_if(parts_, [](const Part& part) { return part.mode == kPoints; });
    }
    reserve(has_faces);
    std::size_t done = 0;
    for (const Part& part : parts_) {
      add(part);
      tell(progress_, static_cast<double>(++done) / static_cast<double>(parts_.size()));
    }
    if (!is_colored_) {
      mesh_.colors = {};
    }
    fail_if(has_faces && mesh_.triangles.empty(),
            is_clear_ ? "all triangles of the scene are clear" : "the scene holds no triangles");
    if (mesh_.surface_of.empty()) {
      mesh_.surfaces = {};
    } else {
      mesh_.texcoords.resize(mesh_.texcoords.empty() ? 0 : mesh_.positions.size(), kNowhere);
      mesh_.surface_of.resize(mesh_.triangles.size());
    }
    add_notes();
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
    const auto enter = [&](const json::array_t& list, const Placing& parent, const std::string& place) {
      for (const json& index : list) {
        const std::uint64_t node = index.is_number_unsigned() ? index.get<std::uint64_t>() : UINT64_MAX;
        fail_if(node >= seen.size() || seen[static_cast<std::size_t>(node)], place,
                ": it names a node that is not there, or one that has a parent already");
        seen[static_cast<std::size_t>(node)] = true;
        waiting.push_back({node, parent});
      }
    };
    if (file_.count("scenes") != 0) {
      const std::uint64_t scene = gltf_number(file_.root(), "scene", "the file").value_or(0);
      enter(gltf_list(file_.entry("scenes", scene), "nodes"), kAsItIs, "scene " + std::to_string(scene));
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
        add_instances(node, *mesh, placing, place);
      }
      enter(gltf_list(node, "children"), placing, place);
    }
  }

  /// Refuses a file that says it means nothing without what is not known here. Looks that are known and not drawn, and
  /// what it says it may be shown without, are a note.
  void check_extensions() {
    static constexpr std::array<std::string_view, 8> kRead{
        "EXT_mesh_gpu_instancing",         "EXT_texture_webp",
        "KHR_draco_mesh_compression",      "KHR_mesh_quantization",
        "KHR_texture_transform",           "KHR_materials_unlit",
        "KHR_materials_emissive_strength", "KHR_materials_pbrSpecularGlossiness"};
    static constexpr std::array<std::string_view, 16> kLooks{
        "EXT_lights_ies",           "EXT_lights_image_based",   "EXT_texture_avif",
        "KHR_lights_punctual",      "KHR_materials_anisotropy", "KHR_materials_clearcoat",
        "KHR_materials_dispersion", "KHR_materials_ior",        "KHR_materials_iridescence",
        "KHR_materials_sheen",      "KHR_materials_specular",   "KHR_materials_transmission",
        "KHR_materials_variants",   "KHR_materials_volume",     "KHR_texture_basisu",
        "MSFT_texture_dds"};
    const auto is_in = [](const auto& list, const std::string& name) {
      return std::find(list.begin(), list.end(), name) != list.end();
    };
    std::set<std::string> unread;
    for (const char* const list : {"extensionsRequired", "extensionsUsed"}) {
      for (const json& entry : gltf_list(file_.root(), list)) {
        const std::string name = entry.is_string() ? entry.get<std::string>() : "";
        if (is_in(kRead, name)) {
          continue;
        }
        fail_if(list == std::string_view("extensionsRequired") && !is_in(kLooks, name),
                "the file requires the extension ", tools::quoted(name), ", which is not read");
        unread.insert(name);
      }
    }
    if (!unread.empty()) {
      mesh_.notes.push_back("what it says by the extension " + tools::quoted(*unread.begin()) +
                            (unread.size() == 1 ? "" : concat(" and ", unread.size() - 1, " more")) +
                            " is not drawn");
    }
  }

  /// A mesh as often as its node says (EXT_mesh_gpu_instancing), which mostly is once.
  void add_instances(const json& node, std::uint64_t mesh, const Placing& placing, const std::string& place) {
    const json* instances = gltf_extension(node, "EXT_mesh_gpu_instancing");
    const json* attributes = instances == nullptr ? nullptr : gltf_member(*instances, "attributes");
    if (attributes == nullptr) {
      add_mesh(mesh, placing);
      return;
    }
    const auto values = [&](const char* name, std::uint32_t components) {
      const GltfAccessor accessor = file_.accessor(*attributes, name, place);
      fail_if(accessor.components != 0 && accessor.components != components, place, ": ", name,
              " of its instances has ", accessor.components, " components, not ", components);
      return accessor;
    };
    const GltfAccessor moves = values("TRANSLATION", 3);
    const GltfAccessor scales = values("SCALE", 3);
    const GltfAccessor turns = values("ROTATION", 4);
    const std::uint64_t count = std::max({moves.count, scales.count, turns.count});
    for (const GltfAccessor& accessor : {moves, scales, turns}) {
      fail_if(accessor.components != 0 && accessor.count != count, place, ": its instances have ", count,
              " and ", accessor.count, " values");
    }
    const auto take = [](const GltfAccessor& accessor, std::uint64_t i, std::span<double> to) {
      for (std::uint32_t component = 0; component < accessor.components; ++component) {
        to[component] = accessor.real(i, component);
      }
    };
    for (std::uint64_t i = 0; i < count; ++i) {
      Standing standing;
      take(moves, i, standing.move);
      take(scales, i, standing.scale);
      take(turns, i, standing.turn);
      add_mesh(mesh, after(placing, standing.placing()));
    }
  }

  /// Without a scene: all nodes that are nobody's children.
  void enter_roots(std::vector<Visit>& waiting, std::vector<bool>& seen) const {
    std::vector<bool> is_child(seen.size());
    for (std::uint64_t i = 0; i < seen.size(); ++i) {
      for (const json& child : gltf_list(file_.entry("nodes", i), "children")) {
        if (child.is_number_unsigned() && child.get<std::uint64_t>() < seen.size()) {
          is_child[child.get<std::size_t>()] = true;
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
    const json::array_t& primitives = gltf_list(file_.entry("meshes", mesh), "primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      Part part{&primitives[i], placing, concat("primitive ", i, " of mesh ", mesh)};
      part.mode = gltf_number(*part.primitive, "mode", part.place).value_or(kTriangles);
      const json* attributes = gltf_member(*part.primitive, "attributes");
      const bool is_drawn = part.mode == kPoints || (part.mode >= kTriangles && part.mode <= kFan);
      undrawn_["the lines"] += is_drawn ? 0U : 1U;
      undrawn_["the morph targets"] += gltf_list(*part.primitive, "targets").empty() ? 0U : 1U;
      if (!is_drawn || attributes == nullptr || gltf_member(*attributes, "POSITION") == nullptr) {
        continue;
      }
      const std::uint64_t place = *gltf_number(*attributes, "POSITION", part.place);
      const json* packed = gltf_extension(*part.primitive, "KHR_draco_mesh_compression");
      // A file that does not require it has the values as they are, too.
      if (packed != nullptr && gltf_member(file_.entry("accessors", place), "bufferView") == nullptr) {
        unpack_draco(file_, *part.primitive, *packed, part.place);
        part.mode = kTriangles;
      }
      const GltfAccessor positions = file_.accessor(place);
      fail_if(positions.components != 3, part.place, ": its positions have ", positions.components,
              " components, not 3");
      part.vertices = positions.count;
      const auto indices = gltf_number(*part.primitive, "indices", part.place);
      part.corners = part.mode == kPoints ? 0 : (indices ? file_.accessor(*indices).count : part.vertices);
      bytes_ += kPartBytes + part.vertices * kVertexBytes + triangles_of(part) * kTriangleBytes;
      fail_if(bytes_ + file_.bytes_made() > file_.most_bytes(),
              "the scene places meshes that take more than the limit of ", file_.most_bytes(),
              " bytes, three times what the file holds and 64 MB");
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
    fail_if(vertices == 0 || vertices > kMeshVertexLimit,
            vertices == 0
                ? "the scene holds neither triangles nor points"
                : "the scene has more vertices than the limit of " + std::to_string(kMeshVertexLimit));
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
        fail_if(!std::isfinite(world[row]), part.place, ": the position of vertex ", i, " is not finite");
      }
      mesh_.positions.push_back(world);
    }
    const Look look = look_of(part);
    const std::vector<float> alphas = add_colors(part, attributes, look);
    add_texcoords(part, attributes, look);
    if (part.mode == kPoints) {
      return;
    }
    const std::size_t first_triangle = mesh_.triangles.size();
    add_corners(part, first);
    if (look.cutoff > 0) {
      leave_out_clear(look, alphas, first, first_triangle);
    }
    if (look.surface != 0) {
      mesh_.surface_of.resize(first_triangle);
      mesh_.surface_of.resize(mesh_.triangles.size(), look.surface);
    }
  }

  /// Triangles that are clear whatever their picture says.
  void leave_out_clear(const Look& look, const std::vector<float>& alphas, std::uint32_t first,
                       std::size_t first_triangle) {
    const auto is_clear = [&](const std::array<std::uint32_t, 3>& triangle) {
      double alpha = alphas.empty() ? 3 : 0;
      for (std::size_t i = 0; !alphas.empty() && i < 3; ++i) {
        alpha += static_cast<double>(alphas[triangle[i] - first]);
      }
      return look.factor[3] * alpha / 3 < look.cutoff;
    };
    const auto begin = mesh_.triangles.begin() + static_cast<std::ptrdiff_t>(first_triangle);
    const auto end = std::remove_if(begin, mesh_.triangles.end(), is_clear);
    is_clear_ = is_clear_ || end != mesh_.triangles.end();
    mesh_.triangles.erase(end, mesh_.triangles.end());
  }

  void add_corners(const Part& part, std::uint32_t first) {
    const GltfAccessor indices = file_.accessor(*part.primitive, "indices", part.place);
    const bool has_indices = indices.components != 0;
    fail_if(has_indices && indices.components != 1, part.place, ": its indices are vectors");
    undrawn_["the last corners, too few for a triangle,"] +=
        part.corners < 3 || (part.mode == kTriangles && part.corners % 3 != 0) ? 1U : 0U;
    Polygons fan(mesh_);
    TriangleStrip strip(mesh_);
    std::array<std::uint32_t, 3> corners{};
    for (std::uint64_t i = 0; i < part.corners; ++i) {
      const std::uint64_t index = has_indices ? indices.index(i) : i;
      fail_if(index >= part.vertices, part.place, ": its corner ", i, " has the index ", index,
              ", which is not one of its ", part.vertices, " vertices");
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

  /// @return the alpha of each vertex where that counts and vertices have one, else nothing
  std::vector<float> add_colors(const Part& part, const json& attributes, const Look& look) {
    const GltfAccessor colors = file_.accessor(attributes, "COLOR_0", part.place);
    const bool has_colors = colors.components >= 3 && colors.count >= part.vertices;
    undrawn_["the colors, which not all vertices have,"] += colors.components != 0 && !has_colors ? 1U : 0U;
    std::vector<float> alphas;
    is_colored_ =
        is_colored_ || has_colors || look.factor[0] != 1 || look.factor[1] != 1 || look.factor[2] != 1;
    for (std::uint64_t i = 0; i < part.vertices; ++i) {
      std::array<double, 3> light{look.factor[0], look.factor[1], look.factor[2]};
      for (std::uint32_t channel = 0; has_colors && channel < 3; ++channel) {
        light[channel] *= colors.real(i, channel);
      }
      mesh_.colors.push_back({screen_byte(light[0]), screen_byte(light[1]), screen_byte(light[2])});
      if (has_colors && look.cutoff > 0 && colors.components == 4) {
        alphas.push_back(static_cast<float>(colors.real(i, 3)));
      }
    }
    return alphas;
  }

  /// Vertices of a part that says none are on no picture.
  void add_texcoords(const Part& part, const json& attributes, const Look& look) {
    const GltfAccessor corners = look.texcoord.empty()
                                     ? GltfAccessor{}
                                     : file_.accessor(attributes, look.texcoord.c_str(), part.place);
    if (corners.components != 2 || corners.count < part.vertices) {
      undrawn_["the pictures, on which not all vertices have a place,"] += look.texcoord.empty() ? 0U : 1U;
      return;
    }
    mesh_.texcoords.reserve(mesh_.positions.capacity());
    mesh_.texcoords.resize(mesh_.positions.size() - static_cast<std::size_t>(part.vertices), kNowhere);
    for (std::uint64_t i = 0; i < part.vertices; ++i) {
      const double u = corners.real(i, 0);
      const double v = corners.real(i, 1);
      const auto moved = [&](const std::array<double, 3>& row) {
        return static_cast<float>(row[0] * u + row[1] * v + row[2]);
      };
      mesh_.texcoords.push_back({moved(look.moved[0]), moved(look.moved[1])});
    }
  }

  /// The look of a part's material; that of the last one is kept.
  const Look& look_of(const Part& part) {
    const auto material = gltf_number(*part.primitive, "material", part.place);
    if (!material) {
      static const Look kPlain;
      has_lit_ = true;
      return kPlain;
    }
    const auto known = looks_.find(*material);
    if (known != looks_.end()) {
      return known->second;
    }
    Look& look = looks_[*material];
    const std::string place = "material " + std::to_string(*material);
    const json& entry = file_.entry("materials", *material);
    const bool is_unlit = gltf_extension(entry, "KHR_materials_unlit") != nullptr;
    unlit_ += is_unlit ? 1U : 0U;
    has_lit_ = has_lit_ || !is_unlit;
    const json* glossy = gltf_extension(entry, "KHR_materials_pbrSpecularGlossiness");
    const json* surface = glossy != nullptr ? glossy : gltf_member(entry, "pbrMetallicRoughness");
    const json* texture = nullptr;
    if (surface != nullptr) {
      gltf_reals(*surface, glossy != nullptr ? "diffuseFactor" : "baseColorFactor", look.factor, place);
      texture = gltf_member(*surface, glossy != nullptr ? "diffuseTexture" : "baseColorTexture");
    }
    const json* mode = gltf_member(entry, "alphaMode");
    if (mode != nullptr && *mode == "MASK") {
      look.cutoff = 0.5;
      gltf_real(entry, "alphaCutoff", look.cutoff, place);
    } else if (mode != nullptr && *mode == "BLEND") {
      look.cutoff = kNearlyClear;
      ++blended_;
    }
    MeshSurface made;
    made.color = texture_of(texture, look, place);
    made.alpha = look.factor[3];
    made.cutoff = look.cutoff;
    if (!is_unlit) {
      add_glow(entry, look, made, place);
    }
    made.wrap_u = look.wraps[0];
    made.wrap_v = look.wraps[1];
    if (made.color != nullptr || made.emission != std::array<double, 3>{}) {
      mesh_.surfaces.resize(
          std::max<std::size_t>(mesh_.surfaces.size(), 1));  // the first has its colour alone
      look.surface = static_cast<std::uint32_t>(mesh_.surfaces.size());
      mesh_.surfaces.push_back(std::move(made));
    }
    return look;
  }

  /// The light that a material gives off, and the picture of it where that lies as the colour's does.
  void add_glow(const json& entry, Look& look, MeshSurface& made, const std::string& place) {
    std::array<double, 3> factor{};
    gltf_reals(entry, "emissiveFactor", factor, place);
    double strength = 1;
    if (const json* extension = gltf_extension(entry, "KHR_materials_emissive_strength")) {
      gltf_real(*extension, "emissiveStrength", strength, place);
    }
    for (double& light : factor) {
      light = std::fmax(0, light * strength);
    }
    Look seen;
    const json* texture = gltf_member(entry, "emissiveTexture");
    made.glow = factor == std::array<double, 3>{} ? nullptr : texture_of(texture, seen, place);
    if (made.glow != nullptr && made.color != nullptr && !seen.lies_as(look)) {
      textures_.fault("the light of " + place +
                      " is not drawn: its picture lies elsewhere than that of its color");
      made.glow = nullptr;
    } else if (made.glow != nullptr || texture == nullptr) {
      made.emission = factor;
    }
    if (made.glow != nullptr && made.color == nullptr) {
      look.texcoord = seen.texcoord;
      look.moved = seen.moved;
      look.wraps = seen.wraps;
    }
  }

  /// The picture that `info`, which may be null, names, and in `look` where it lies.
  std::shared_ptr<const Texture> texture_of(const json* found, Look& look, const std::string& place) {
    if (found == nullptr || gltf_member(*found, "index") == nullptr) {
      return nullptr;
    }
    const json& info = *found;
    std::uint64_t texcoord = gltf_number(info, "texCoord", place).value_or(0);
    if (const json* transform = gltf_extension(info, "KHR_texture_transform")) {
      std::array<double, 2> offset{};
      std::array<double, 2> scale{1, 1};
      double turn = 0;
      gltf_reals(*transform, "offset", offset, place);
      gltf_reals(*transform, "scale", scale, place);
      gltf_real(*transform, "rotation", turn, place);
      texcoord = gltf_number(*transform, "texCoord", place).value_or(texcoord);
      const double c = std::cos(turn);
      const double s = std::sin(turn);
      look.moved = {{{c * scale[0], s * scale[1], offset[0]}, {-s * scale[0], c * scale[1], offset[1]}}};
    }
    look.texcoord = "TEXCOORD_" + std::to_string(texcoord);
    const json& texture = file_.entry("textures", *gltf_number(info, "index", place));
    if (const auto sampler = gltf_number(texture, "sampler", place)) {
      const auto wrap = [&](const char* name) {
        const std::uint64_t mode =
            gltf_number(file_.entry("samplers", *sampler), name, place).value_or(kRepeat);
        return mode == kMirror ? Wrap::kMirror : (mode == kClamp ? Wrap::kClamp : Wrap::kRepeat);
      };
      look.wraps = {wrap("wrapS"), wrap("wrapT")};
    }
    return picture_of(texture, place);
  }

  std::shared_ptr<const Texture> picture_of(const json& texture, const std::string& place) {
    auto image = gltf_number(texture, "source", place);
    const json* webp = gltf_extension(texture, "EXT_texture_webp");
    if (webp != nullptr && !image) {
      image = gltf_number(*webp, "source", place);
    }
    if (!image) {
      const bool is_avif = gltf_extension(texture, "EXT_texture_avif") != nullptr;
      textures_.miss("of " + place,
                     std::string("is of a kind that is not read (") + (is_avif ? "AVIF)" : "KTX2)"));
      return nullptr;
    }
    const std::string key = "image " + std::to_string(*image);
    const json& entry = file_.entry("images", *image);
    if (const auto view = gltf_number(entry, "bufferView", key)) {
      return textures_.inside("in buffer view " + std::to_string(*view), file_.buffer_view(*view));
    }
    const json* uri = gltf_member(entry, "uri");
    if (uri == nullptr || !uri->is_string()) {
      textures_.miss(key, "has neither a link nor a buffer view");
      return nullptr;
    }
    const auto& link = uri->get_ref<const std::string&>();
    SharedBytes bytes;
    if (std::string fault = file_.link(link, key, bytes); !fault.empty()) {
      textures_.fault(std::move(fault));  // shapes without their pictures are worth having
      return nullptr;
    }
    return textures_.inside(link.starts_with("data:") ? key : link, bytes.bytes);
  }

  void add_notes() {
    Notes& notes = mesh_.notes;
    textures_.add_notes(notes);
    for (const auto& [what, primitives] : undrawn_) {
      note_if(primitives != 0, notes, what, " of ", counted(primitives, "primitive"), " are not drawn");
    }
    note_if(file_.count("scenes") > 1, notes, "of its ", file_.count("scenes"),
            " scenes the default one is drawn");
    mesh_.is_unlit = unlit_ != 0 && !has_lit_;
    note_if(unlit_ != 0 && has_lit_, notes, counted(unlit_, "material is", "materials are"),
            " unlit in the file and drawn in the scene's light like the others");
    note_if(blended_ != 0, notes, "of ", counted(blended_, "blended material"),
            " (BLEND) what is at least a tenth opaque is drawn solid");
    note_if(file_.count("animations") != 0 || file_.count("skins") != 0, notes,
            "its animations and skins are not drawn: all stands as it does at rest");
  }

  enum : std::uint64_t { kRepeat = 10497, kClamp = 33071, kMirror = 33648 };
  static constexpr std::array<float, 2> kNowhere{std::numeric_limits<float>::quiet_NaN(), 0};
  static constexpr double kNearlyClear = 0.1;
  static constexpr std::uint64_t kPartBytes = 256;
  static constexpr std::uint64_t kVertexBytes = 35;
  static constexpr std::uint64_t kTriangleBytes = 16;

  GltfFile file_;
  const Progress& progress_;
  std::vector<Part> parts_;
  std::uint64_t bytes_ = 0;
  TriangleMesh mesh_;
  bool is_colored_ = false;
  std::map<std::string, std::uint64_t> undrawn_;  ///< of how many primitives
  std::size_t unlit_ = 0;                         ///< materials
  bool has_lit_ = false;                          ///< materials that are not
  std::size_t blended_ = 0;                       ///< materials
  bool is_clear_ = false;                         ///< some triangles are
  Textures textures_;
  std::map<std::uint64_t, Look> looks_;  ///< by material
};

}  // namespace

bool looks_like_gltf(std::string_view text) {
  if (text.starts_with("glTF")) {
    return true;
  }
  std::string_view rest = text.substr(mark_bytes(text));
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
  return rest.starts_with('{');
}

/// Memory: 24 bytes a vertex (27 with colour, 35 with a picture), 12 a
/// triangle (16 with a picture). A mesh may be placed many times: what all places take is limited to three times the
/// bytes read, and 64 MB; pictures have a limit of their own (texture.h).
/// @throws InputError  broken JSON, or anything in it that is missing, of another type or out of range; a
///   node that is its own descendant; an accessor that leaves its buffer; a position that is not finite
Source read_gltf(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  return Scene(file, options.path, progress).read();
}

}  // namespace thimble::tools
