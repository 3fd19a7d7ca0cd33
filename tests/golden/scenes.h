/// The golden frames: small scenes, cameras and formats whose pictures have one CRC-32 on every machine.
///
/// Everything here is integers and the caller's bytes, so that a microcontroller runs the very same frames
/// that a desktop does; golden_table.h holds what they must give. A frame is one picture: a scene, a view, a
/// shade mode and a pixel format. A variant is a way to draw it: a structure, an arithmetic width and a band
/// height. All variants of a frame give the same bytes.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/base/status.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/octree.h"

namespace thimble::golden {

enum class SceneId : uint8_t {
  kEmpty,         ///< nothing, level 5
  kFull,          ///< a solid world inserted as one box, level 5
  kSpheres,       ///< three spheres that overlap, one material each, voxel by voxel, level 5
  kManySpheres,   ///< five of them at level 6
  kFewPoints,     ///< 60 random voxels of random material, level 6
  kPoints,        ///< 1000 of them, all of material 0
  kShell,         ///< a hollow sphere two voxels thick, level 5
  kCheckerboard,  ///< every other voxel, two materials in turns, level 4
  kCoarsened,     ///< kManySpheres in a pool that is too small, so that blocks are merged
  kCorners,       ///< one voxel in each corner of the largest world, level 12
  kMarks,         ///< blocks on the axes that tell x from y from z and left from right, level 4
};
inline constexpr int kSceneCount = 11;

enum class Structure : uint8_t { kDense, kPool, kCompact };

/// What a scene is made in and with.
struct SceneInfo {
  const char* name;
  uint8_t level;
  /// Nodes of the pool it is built in: just enough, or for kCoarsened too few.
  uint16_t pool_nodes;
  bool coarsen;
  /// Whether a dense grid gives the same pictures in depth, normal and mono: one that fits, and no merged
  /// blocks.
  bool has_dense;
  /// Whether it also does in color: all of it has material 0.
  bool has_dense_color;
};
const SceneInfo& scene_info(SceneId id);

/// A scene in one of the structures; only that member is set up (kCompact also leaves the pool that it was
/// made from). Its bytes are in the arena it was built in.
struct World {
  Structure structure = Structure::kCompact;
  DenseGrid grid;
  Octree pool;
  CompactTree compact;
};

/// Builds a scene in bytes of `arena`. `kOutOfMemory` when they do not suffice; what was taken stays taken.
Status build_scene(SceneId id, Structure structure, Arena* arena, World* world);

/// A frame. Positions in 1/256 voxel.
struct Frame {
  const char* name;
  SceneId scene;
  bool perspective;
  Vec3i eye_q8;
  Vec3i target_q8;
  Vec3i up;  ///< all 0: the default
  /// Perspective: vertical field of view in degrees; orthographic: width of the picture in voxels.
  int32_t fov_or_span;
  uint8_t direction_bits;  ///< 0: automatic
  ShadeMode shade;
  PixelFormat format;
  int16_t width_px;
  int16_t height_px;
  /// Whether the 32-bit path takes its rays; where it does not, it must say so.
  bool narrow;
};
int frame_count();
const Frame& frame(int index);

/// Camera and shading of a frame. The depth planes just hold the world.
Status set_up(const Frame& frame, Camera* camera, Shading* shading);

struct Variant {
  Structure structure;
  Width width;
  int16_t band_rows;  ///< 0: the whole frame at once
};
int variant_count();
const Variant& variant(int index);
/// Whether a frame can be drawn that way (its structure holds what the frame shows; its width takes the
/// rays).
bool applies(const Frame& frame, const Variant& variant);

/// Draws `frame` from `world` in bands of `band_rows` (0: all) through `band`, and gives the CRC-32 of the
/// picture's bytes, rows without gaps. `counts` is added to. `kOutOfMemory` when a band does not fit.
Status frame_crc32(const Frame& frame, const World& world, Width width, int32_t band_rows, Bytes band,
                   uint32_t* crc, RenderCounts* counts);
/// The same with the camera and the shading that `set_up` gave for the frame, for whoever has a small stack.
Status frame_crc32(const Frame& frame, const World& world, const Camera& camera, const Shading& shading,
                   Width width, int32_t band_rows, Bytes band, uint32_t* crc, RenderCounts* counts);

}  // namespace thimble::golden
