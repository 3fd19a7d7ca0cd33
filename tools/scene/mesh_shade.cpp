#include "scene/voxelise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "readers/real3.h"
#include "readers/texture.h"
#include "scene/world_fit.h"

namespace thimble::tools {
namespace {

Real3 in_voxels(const UnitPoint& point) {
  return scaled<double>(
      {static_cast<double>(point[0]), static_cast<double>(point[1]), static_cast<double>(point[2])},
      1.0 / kUnitsPerVoxel);
}

/// A range cut to another.
void cut(double low, double high, double& middle, double& half) {
  const double first = std::clamp(middle - half, low, high);
  const double last = std::clamp(middle + half, low, high);
  middle = (first + last) / 2;
  half = (last - first) / 2;
}

/// What is clear does not end the search for what a voxel is of, as all else does.
constexpr std::uint64_t kMostClearVoxels = std::uint64_t{1} << 28;

struct Shade {
  Rgb color;
  std::uint32_t power_q8 = 0;  ///< ColorHistogram
};

double mixed(double p, double q, double r, const std::array<double, 2>& place) {
  return p + (q - p) * place[0] + (r - p) * place[1];
}

// Colours as light, and back.
Real3 as_light(const Rgb& color) {
  return {light_of(color.r), light_of(color.g), light_of(color.b)};
}
Rgb as_color(const Real3& light) {
  return {screen_byte(light[0]), screen_byte(light[1]), screen_byte(light[2])};
}
Real3 product(const Real3& a, const Real3& b) {
  return {a[0] * b[0], a[1] * b[1], a[2] * b[2]};
}

bool is_inside(const std::array<double, 2>& place) {
  return place[0] >= 0 && place[1] >= 0 && place[0] + place[1] <= 1;
}

/// One triangle of a mesh, seen from voxels.
class MeshShade {
 public:
  /// @param colors  of the mesh's vertices, or empty
  MeshShade(const TriangleMesh& mesh, std::span<const Rgb> colors, std::size_t triangle,
            const UnitTriangle& corners)
      : mesh_(mesh), colors_(colors), triangle_(triangle), corners_(corners), corner_(in_voxels(corners[0])) {
    edge_b_ = minus(in_voxels(corners[1]), corner_);
    edge_c_ = minus(in_voxels(corners[2]), corner_);
    bb_ = dot(edge_b_, edge_b_);
    bc_ = dot(edge_b_, edge_c_);
    cc_ = dot(edge_c_, edge_c_);
    area_ = bb_ * cc_ - bc_ * bc_;
    const auto& numbers =
        mesh.texcoord_corners.empty() ? mesh.triangles[triangle] : mesh.texcoord_corners[triangle];
    static const MeshSurface kPlain;
    surface_ = mesh.surfaces.empty() ? &kPlain : &mesh.surfaces[mesh.surface_of[triangle]];
    for (std::size_t i = 0; i < 3; ++i) {
      if (numbers[i] >= mesh.texcoords.size() || std::isnan(mesh.texcoords[numbers[i]][0])) {
        has_place_ = false;
        return;
      }
      const auto [u, v] = mesh.texcoords[numbers[i]];
      texcoord_[i] = {static_cast<double>(u), static_cast<double>(v)};
    }
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto [low, high] = std::minmax({texcoord_[0][axis], texcoord_[1][axis], texcoord_[2][axis]});
      constexpr double kRounding = 1.0 / 65536;
      const double copy = std::floor(low + kRounding);
      const bool is_within = high <= copy + 1 + kRounding;
      low_[axis] = is_within ? copy : -std::numeric_limits<double>::infinity();
      high_[axis] = is_within ? copy + 1 : std::numeric_limits<double>::infinity();
    }
    if (area_ <= 0) {
      return;
    }
    const Real3 slope_b = scaled(minus(scaled(edge_b_, cc_), scaled(edge_c_, bc_)), 1 / area_);
    const Real3 slope_c = scaled(minus(scaled(edge_c_, bb_), scaled(edge_b_, bc_)), 1 / area_);
    const auto half = [&](std::size_t axis) {
      const Real3 slope = plus(scaled(slope_b, texcoord_[1][axis] - texcoord_[0][axis]),
                               scaled(slope_c, texcoord_[2][axis] - texcoord_[0][axis]));
      return std::sqrt(dot(slope, slope)) / 2;
    };
    half_u_ = half(0);
    half_v_ = half(1);
  }

  /// Nothing where the triangle is clear; nor, where `only_over`, where the voxel's middle is not over the triangle.
  /// @param edges  those of all triangles, sorted
  std::optional<Shade> at(const UnitPoint& voxel, bool only_over,
                          std::span<const std::uint64_t> edges) const {
    const Real3 out = minus(Real3{voxel[0] + 0.5, voxel[1] + 0.5, voxel[2] + 0.5}, corner_);
    const Place below = place_of(out);
    const bool is_over = is_inside(below);
    if (only_over && !is_over) {
      return std::nullopt;
    }
    const bool has_picture = has_place_ && (surface_->color != nullptr || surface_->opacity != nullptr);
    const bool may_glow =
        surface_->emission != std::array<double, 3>{} && (surface_->glow == nullptr || has_place_);
    const Place place = is_over ? below : edge_place_of(out);
    if (has_picture && surface_->cutoff > 0 &&
        (is_clear(place) || (!is_over && goes_on(below, edges) && is_clear(below)))) {
      return std::nullopt;
    }
    const Real3 reflected = product(tint_at(place), sample_at(place, 1).light);
    const std::optional<Shade> glow = may_glow ? glow_at(place, reflected) : std::nullopt;
    return glow ? glow : Shade{as_color(reflected)};
  }

  /// Adds the edges of a triangle that may be clear.
  void add_edges(std::vector<std::uint64_t>& edges) const {
    for (std::size_t corner = 0; surface_->cutoff > 0 && corner < 3; ++corner) {
      edges.push_back(edge_key(corner, false));
    }
  }

 private:
  /// A point of the triangle's plane, by the weights of the second and third corner.
  using Place = std::array<double, 2>;

  /// The place next to the voxel's middle.
  Place place_of(const Real3& out) const {
    const double ob = dot(out, edge_b_);
    const double oc = dot(out, edge_c_);
    return area_ > 0 ? Place{(ob * cc_ - oc * bc_) / area_, (oc * bb_ - ob * bc_) / area_} : Place{-1, -1};
  }

  /// The place on the triangle next to one beyond it, which is that of the middle.
  Place edge_place_of(const Real3& out) const {
    const Real3 side = minus(edge_c_, edge_b_);
    const auto part = [](double along, double whole) {
      return whole > 0 ? std::clamp(along / whole, 0.0, 1.0) : 0;
    };
    const double on_side = part(dot(minus(out, edge_b_), side), dot(side, side));
    // The nearest point of each edge: from A to B, from A to C, from B to C.
    const std::array<Place, 3> places{
        {{part(dot(out, edge_b_), bb_), 0}, {0, part(dot(out, edge_c_), cc_)}, {1 - on_side, on_side}}};
    const auto distance = [&](const Place& place) {
      const Real3 apart = minus(out, plus(scaled(edge_b_, place[0]), scaled(edge_c_, place[1])));
      return dot(apart, apart);
    };
    return *std::min_element(places.begin(), places.end(),
                             [&](const Place& p, const Place& q) { return distance(p) < distance(q); });
  }

  /// Whether the picture continues over all edges that separate the place from the triangle.
  bool goes_on(const Place& place, std::span<const std::uint64_t> edges) const {
    const std::array<double, 3> weights{1 - place[0] - place[1], place[0], place[1]};
    bool is_on = area_ > 0;
    for (std::size_t corner = 0; is_on && corner < 3; ++corner) {
      is_on = weights[corner] >= 0 || std::binary_search(edges.begin(), edges.end(), edge_key(corner, true));
    }
    return is_on;
  }

  /// Stands for the edge opposite to a corner: its ends, on the mesh and on the picture, and on which side of it the
  /// triangle lies there; or a neighbour, on the other side.
  std::uint64_t edge_key(std::size_t corner, bool is_neighbour) const {
    std::array<std::size_t, 2> ends{(corner + 1) % 3, (corner + 2) % 3};
    if (std::pair(corners_[ends[1]], texcoord_[ends[1]]) < std::pair(corners_[ends[0]], texcoord_[ends[0]])) {
      std::swap(ends[0], ends[1]);
    }
    const auto& [u, v] = texcoord_[ends[0]];
    const auto& [to_u, to_v] = texcoord_[ends[1]];
    const auto& [own_u, own_v] = texcoord_[corner];
    const bool is_left = (to_u - u) * (own_v - v) > (to_v - v) * (own_u - u);
    std::uint64_t key = is_left != is_neighbour ? 1 : 0;
    const auto add = [&](std::uint64_t value) {
      key = (key ^ value) * 0x9E3779B97F4A7C15U;
      key ^= key >> 29U;
    };
    add(mesh_.surface_of[triangle_]);
    for (const std::size_t end : ends) {
      for (const std::int32_t coordinate : corners_[end]) {
        add(static_cast<std::uint32_t>(coordinate));
      }
      for (const double coordinate : texcoord_[end]) {
        add(std::bit_cast<std::uint64_t>(coordinate));
      }
    }
    return key;
  }

  /// @param size  of the piece of the picture that is averaged; 1: what a voxel covers
  Texture::Box box_at(const Place& place, double size) const {
    Texture::Box box{mixed(texcoord_[0][0], texcoord_[1][0], texcoord_[2][0], place),
                     mixed(texcoord_[0][1], texcoord_[1][1], texcoord_[2][1], place), half_u_ * size,
                     half_v_ * size};
    cut(low_[0], high_[0], box.u, box.half_u);
    cut(low_[1], high_[1], box.v, box.half_v);
    return box;
  }

  Texture::Sample sample_at(const Place& place, double size) const {
    const Texture::Box box = box_at(place, size);
    const auto sample_of = [&](const std::shared_ptr<const Texture>& texture) {
      return texture == nullptr || !has_place_ ? Texture::Sample{}
                                               : texture->average(box, surface_->wrap_u, surface_->wrap_v);
    };
    Texture::Sample sample = sample_of(surface_->color);
    if (surface_->opacity != nullptr) {
      sample.alpha = sample_of(surface_->opacity).alpha;
    }
    return sample;
  }

  /// What the surface gives off, or none.
  std::optional<Shade> glow_at(const Place& place, const Real3& reflected) const {
    constexpr double kLeast = 0.1;
    constexpr double kMost = 256;
    Real3 light = surface_->emission;
    if (surface_->glow != nullptr) {
      light =
          product(light, surface_->glow->average(box_at(place, 1), surface_->wrap_u, surface_->wrap_v).light);
    }
    const double most = std::max({light[0], light[1], light[2]});
    if (most < std::max({kLeast, reflected[0], reflected[1], reflected[2]})) {
      return std::nullopt;
    }
    const double power = std::fmax(most, 1);  // a colour holds no more than 1
    return Shade{as_color({light[0] / power, light[1] / power, light[2] / power}),
                 static_cast<std::uint32_t>(std::fmin(power, kMost) * 256)};
  }

  /// Clear on the average and at the place itself: a voxel may cover much that is beside the mesh's part of a picture.
  bool is_clear(const Place& place) const {
    constexpr double kInwards = 1.0 / 1024;  // of an edge, at which the next pixel may begin
    const auto inwards = [](double weight) { return weight + (1.0 / 3 - weight) * kInwards; };
    const auto is_below = [&](const Texture::Sample& sample) {
      return sample.alpha * surface_->alpha < surface_->cutoff;
    };
    return is_below(sample_at(place, 1)) && is_below(sample_at({inwards(place[0]), inwards(place[1])}, 0));
  }

  /// The triangle's own colour, as light.
  Real3 tint_at(const Place& place) const {
    if (!mesh_.face_colors.empty() || colors_.empty()) {
      return as_light(mesh_.face_colors.empty() ? Rgb{} : mesh_.face_colors[triangle_]);
    }
    const auto& [a, b, c] = mesh_.triangles[triangle_];
    const Real3 p = as_light(colors_[a]);
    const Real3 q = as_light(colors_[b]);
    const Real3 r = as_light(colors_[c]);
    return {mixed(p[0], q[0], r[0], place), mixed(p[1], q[1], r[1], place), mixed(p[2], q[2], r[2], place)};
  }

  const TriangleMesh& mesh_;
  std::span<const Rgb> colors_;
  std::size_t triangle_;
  UnitTriangle corners_;
  const MeshSurface* surface_ = nullptr;
  bool has_place_ = true;  ///< on the surface's pictures, which count for nothing else
  Real3 corner_{};         ///< the first, in voxels; the edges from it to the others:
  Real3 edge_b_{}, edge_c_{};
  double bb_ = 0, bc_ = 0, cc_ = 0, area_ = 0;  ///< products of the edges; the square of twice the area
  std::array<std::array<double, 2>, 3> texcoord_{};
  double half_u_ = 0, half_v_ = 0;  ///< of what a voxel covers
  /// Of the picture's copy that all of the triangle lies on, beyond which it has no colour; all that there is, if none.
  std::array<double, 2> low_{}, high_{};
};

/// The colours of the vertices. Those that all triangles around them are smaller than a voxel have the average, as light,
/// of all such in their voxel: else what is finer than voxels would flicker from one to the next.
std::vector<Rgb> vertex_colors(const TriangleMesh& mesh, const std::vector<UnitPoint>& units) {
  std::vector<Rgb> colors = mesh.face_colors.empty() ? mesh.colors : std::vector<Rgb>();
  std::vector<bool> is_fine(colors.size(), true);
  for (const auto& corners : mesh.triangles) {
    const auto& [a, b, c] = corners;
    bool is_small = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({units[a][axis], units[b][axis], units[c][axis]});
      is_small = is_small && high - low <= kUnitsPerVoxel;
    }
    for (std::size_t i = 0; !is_small && !colors.empty() && i < 3; ++i) {
      is_fine[corners[i]] = false;
    }
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> fine;  // by their voxels
  for (std::uint32_t i = 0; i < colors.size(); ++i) {
    if (is_fine[i] && units[i][0] != 0) {  // 0 is of no triangle
      const auto voxel = [&](std::size_t axis) {
        return static_cast<std::uint64_t>(units[i][axis] >> kUnitBits);
      };
      fine.emplace_back(voxel(2) << 40 | voxel(1) << 20 | voxel(0), i);
    }
  }
  std::sort(fine.begin(), fine.end());
  for (std::size_t first = 0, last = 0; first < fine.size(); first = last) {
    Real3 light{};
    for (; last < fine.size() && fine[last].first == fine[first].first; ++last) {
      light = plus(light, as_light(colors[fine[last].second]));
    }
    const auto count = static_cast<double>(last - first);
    const Rgb average = as_color({light[0] / count, light[1] / count, light[2] / count});
    for (std::size_t i = first; i < last; ++i) {
      colors[fine[i].second] = average;
    }
  }
  return colors;
}

}  // namespace

void voxelise_shaded(const TriangleMesh& mesh, int level, bool z_up,
                     const std::function<std::uint8_t(Rgb, std::uint32_t power_q8)>& material_of,
                     const BlockSink& sink, const Progress& progress) {
  const std::vector<UnitPoint> units = quantise_vertices(mesh, level, z_up);
  const std::vector<Rgb> colors = vertex_colors(mesh, units);
  const std::size_t count = mesh.triangles.size();
  const auto triangle_at = [&](std::size_t i) {
    const auto& [a, b, c] = mesh.triangles[i % count];
    return CellTriangle{{units[a], units[b], units[c]}, i >= count, static_cast<std::uint32_t>(i % count)};
  };
  std::vector<std::uint64_t> edges;
  for (std::size_t i = 0; i < count; ++i) {
    MeshShade(mesh, colors, i, triangle_at(i).corners).add_edges(edges);
  }
  std::sort(edges.begin(), edges.end());
  std::uint64_t clear = 0;
  std::optional<MeshShade> shade;  // of the last triangle
  std::uint32_t number = 0;
  const auto material_at = [&](const CellTriangle& triangle, const UnitPoint& voxel) {
    if (!shade || number != triangle.number) {
      number = triangle.number;
      shade.emplace(mesh, colors, number, triangle.corners);
    }
    const auto shown = shade->at(voxel, triangle.only_over, edges);
    clear += !shown && !triangle.only_over ? 1U : 0U;
    fail_if(clear > kMostClearVoxels, "its triangles lie over each other too often where they are clear");
    return shown ? std::optional<std::uint8_t>(material_of(shown->color, shown->power_q8)) : std::nullopt;
  };
  voxelise_triangles(count, 2, triangle_at, level, material_at, sink, progress);
}

ColorHistogram mesh_colors(const TriangleMesh& mesh, int level, bool z_up) {
  ColorHistogram histogram;
  if (!is_shaded(mesh)) {
    return histogram;
  }
  const auto count = [&](Rgb color, std::uint32_t power_q8) {
    histogram.add(color, power_q8);
    return std::uint8_t{0};
  };
  voxelise_shaded(mesh, level, z_up, count, [](const UnitPoint&, int, std::uint8_t) {}, {});
  return histogram;
}

}  // namespace thimble::tools
