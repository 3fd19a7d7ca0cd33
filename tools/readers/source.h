/// What a reader of scene files hands over. A reader turns bytes into one of these and knows nothing of
/// arenas or pictures, nor (but for the one of baked scenes) of trees; `scene/` turns a source into voxels.
///
/// Memory: a source keeps at most the file's (decompressed) bytes and what they really hold, never what a
/// header claims. Streaming methods may be called any number of times and give the same sequence each time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>
#include <vector>

#include "output/progress.h"
#include "readers/file_bytes.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/scene.h"

namespace thimble::tools {

struct Rgb {
  std::uint8_t r = 255, g = 255, b = 255;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

/// Kept for the effects, not used by plain colour shading.
using thimble::SurfaceKind;

/// One palette entry. Parameters as in the file, clamped to their documented ranges; absent ones keep these
/// defaults.
struct Material {
  Rgb color;
  std::uint8_t alpha = 255;
  SurfaceKind kind = SurfaceKind::kDiffuse;
  double weight = 1;        ///< v150 MATT weight or v200 blend weight, 0..1
  double roughness = 0;     ///< 0..1
  double ior = 1.3;         ///< index of refraction, >= 1
  double attenuation = 0;   ///< >= 0
  double flux = 0;          ///< emission power
  double emission = 0;      ///< 0..1
  double density = 0;       ///< media density, >= 0
  double metalness = 0;     ///< 0..1
  double transparency = 0;  ///< 0..1
};
using Palette = std::array<Material, 256>;

/// What a file says and its source leaves out or had to decide: a sentence each, without "note:" and without a
/// full stop.
using Notes = std::vector<std::string>;
/// Adds one of these pieces where `is_so`.
template <class... Pieces>
void note_if(bool is_so, Notes& notes, const Pieces&... pieces) {
  if (is_so) {
    notes.push_back(concat(pieces...));
  }
}

/// The smallest box along the axes that holds the points added.
template <class Number>
struct Extent {
  std::array<Number, 3> low{}, high{};
  bool empty = true;

  /// Grows the box; of reals, finite ones.
  void add(const std::array<Number, 3>& point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = empty ? point[axis] : std::min(low[axis], point[axis]);
      high[axis] = empty ? point[axis] : std::max(high[axis], point[axis]);
    }
    empty = false;
  }
};

/// Voxels with whole-number positions: `.vox`.
class VoxelModel {
 public:
  Notes notes{};
  virtual ~VoxelModel() = default;
  using Visit = std::function<void(std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material)>;
  /// Calls `visit` for each voxel, in the file's order; a position may repeat (the last one wins). The
  /// models' declared boxes are moved together so that the lowest corner of them all is 0,0,0: a single model
  /// keeps its indices.
  virtual void for_each(const Visit& visit) const = 0;
  /// Extent of the models' boxes on each axis, at least one past the largest position; all 0 without voxels.
  virtual std::array<std::int32_t, 3> size() const = 0;
  virtual const Palette& palette() const = 0;
  /// Frames of the animation that this is one of; 1 where it is none.
  virtual std::uint32_t frames() const { return 1; }
  /// As `for_each`, for what all its frames show, models that stand still once.
  virtual void for_each_in_frames(const Visit& visit) const { for_each(visit); }
};

/// Some formats repeat voxels in a few bytes; so many, a solid world of level 10, take minutes.
inline constexpr std::uint64_t kMostGridVoxels = std::uint64_t{1} << 30;
inline void check_grid_voxels(std::uint64_t voxels) {
  fail_if(voxels > kMostGridVoxels, "holds more than the limit of ", kMostGridVoxels, " solid voxels");
}

/// Voxels with whole-number positions and a colour of their own each: `.binvox`, `.qb`, `.schematic` ...
class VoxelGrid {
 public:
  Notes notes{};
  virtual ~VoxelGrid() = default;
  using Visit = std::function<void(std::int32_t x, std::int32_t y, std::int32_t z, Rgb color)>;
  /// Calls `visit` for each solid voxel, in an order of the format's own; where a position repeats, the last
  /// one counts. z is up.
  virtual void for_each(const Visit& visit) const = 0;
  /// What the file declares on each axis, past every position; none is 0.
  const std::array<std::int32_t, 3>& size() const { return size_; }
  /// Otherwise every colour is white.
  bool has_color() const { return has_color_; }
  /// Its steps stand for a slope.
  virtual bool is_landscape() const { return false; }

 protected:
  /// Streams once. Throws InputError `sentence` where nothing is solid.
  void check_solid(const char* sentence) const {
    std::uint64_t voxels = 0;
    for_each([&](auto, auto, auto, auto) { check_grid_voxels(++voxels); });
    fail_if(voxels == 0, sentence);
  }
  void set_size(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    size_ = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), static_cast<std::int32_t>(z)};
  }

  std::array<std::int32_t, 3> size_{};
  bool has_color_ = true;
};

/// What an array of N x 3 to N x 9 numbers is taken for: points by its shape, heights where --as-heights says so.
enum class ArrayAs : std::uint8_t { kByShape, kPoints, kHeights };

/// Longest side of a `VoxelGrid`: beyond that no world holds it.
inline constexpr std::uint32_t kGridSideLimit = 4096;

struct CloudPoint {
  double x = 0, y = 0, z = 0;  ///< finite where a cloud gives it, as in the file
  Rgb color;                   ///< white where the file has none
  std::uint64_t line = 0;      ///< 1-based line of a text file or 1-based point number of a binary one
  bool is_finite() const { return std::isfinite(x) && std::isfinite(y) && std::isfinite(z); }
};

/// Points with real coordinates: `.xyz`, `.csv`, `.ply` without faces, `.pcd`, `.las`, Gadget-1 snapshots.
class PointCloud {
 public:
  Notes notes{};
  virtual ~PointCloud() = default;
  using Visit = std::function<void(const CloudPoint&)>;
  virtual void for_each(const Visit& visit) const = 0;
  virtual bool has_color() const = 0;
  /// What `CloudPoint::line` counts, for an error's sentence: "line" or "point".
  virtual const char* counts_in() const { return "point"; }
};

class Texture;

/// How a texture continues outside its picture.
enum class Wrap : std::uint8_t { kRepeat, kMirror, kClamp };

/// What some triangles of a mesh look like where they lie, beside their own colours.
struct MeshSurface {
  std::shared_ptr<const Texture> color{};    ///< times the triangle's own colour, as light; null: that alone
  std::shared_ptr<const Texture> opacity{};  ///< its alpha counts; null: that of `color`
  std::shared_ptr<const Texture> glow{};     ///< times `emission`; null: that alone
  std::array<double, 3> emission{};  ///< light that it gives off itself; 1: as bright as a screen's white
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  double alpha = 1;   ///< times that of the pictures
  double cutoff = 0;  ///< nothing is there where alpha is less; 0: alpha means nothing
};
/// No texture coordinate: the triangle is on no picture.
inline constexpr std::uint32_t kNoTexcoord = UINT32_MAX;

/// Triangles with real coordinates: `.obj`, `.off`, `.stl`, `.gltf`, `.ply` with faces. Polygons are already
/// cut.
struct TriangleMesh {
  std::vector<std::array<double, 3>> positions;         ///< all finite
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `positions`, in range
  std::vector<Rgb> colors;                              ///< one a position, or empty
  std::vector<Rgb> face_colors{};                       ///< one a triangle, or empty; counts before `colors`
  bool is_z_up = false;                                 ///< the format says so; else y is taken to be up
  bool is_unlit = false;                                ///< its colours are drawn as they are, without light
  Notes notes{};
  std::vector<MeshSurface> surfaces{};      ///< empty where no triangle has more than its colour
  std::vector<std::uint32_t> surface_of{};  ///< one a triangle, in range, or empty as `surfaces` are
  std::vector<std::array<float, 2>>
      texcoords{};  ///< u, and v that runs down; 0 to 1 is the picture once; u NaN: none
  std::vector<std::array<std::uint32_t, 3>> texcoord_corners{};  ///< one a triangle; empty: as `triangles`
};

/// A scene baked by `thimble bake`, checked to its last byte: `.oct`.
struct BakedFile {
  SharedBytes file;
  BakedScene scene;  ///< views into `file`
};

/// What a person wrote: models to be opened and put together, lights, a camera (scene_text.h).
struct SceneText;

using Source = std::variant<std::unique_ptr<VoxelModel>, std::unique_ptr<PointCloud>, TriangleMesh, BakedFile,
                            std::shared_ptr<const SceneText>, std::unique_ptr<VoxelGrid>>;

/// What the reader had to say; nothing of a kind that has no notes.
Notes notes_of(const Source& source);
/// Notes that `points` of a file, if any, are not finite and left out.
void note_left_out(Notes& notes, std::uint64_t points);

// Where voxels go: everything in `scene/` streams into one of these and keeps no list of voxels.

/// One solid voxel with its palette index. A position may come more than once; the last call decides its
/// material. May throw, which ends the streaming; the streaming functions hold nothing that would leak.
using VoxelSink = std::function<void(std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material)>;

/// Calls visit(x, y, z) for the voxels of a block of 2^level a side.
template <class Visit>
void for_voxels(const Vec3i& corner, int level, const Visit& visit) {
  const std::int32_t side = std::int32_t{1} << level;
  for (std::int32_t z = corner.z; z < corner.z + side; ++z) {
    for (std::int32_t y = corner.y; y < corner.y + side; ++y) {
      for (std::int32_t x = corner.x; x < corner.x + side; ++x) {
        visit(x, y, z);
      }
    }
  }
}

}  // namespace thimble::tools
