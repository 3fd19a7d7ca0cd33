/// @file baked_scene.h
/// A whole scene as bytes: compact tree, palette, camera, and tables that make tracing faster.
///
/// `thimble bake` writes them, as a file (`.oct`) or as a C array for flash (`.h`); a program opens them
/// where they lie. Nothing is copied or unpacked, no alignment is needed, and the bytes are the same on every
/// chip. src/FORMAT.md has the layout: a header with a version, a CRC-32 and a list of sections.
///
/// What it does not do: hold a scene that is still being built (octree.h), or several trees.
#ifndef THIMBLE_BAKED_SCENE_H
#define THIMBLE_BAKED_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/compact_tree.h"
#include "thimble/fixed.h"
#include "thimble/pixel.h"
#include "thimble/span.h"
#include "thimble/status.h"
#include "thimble/vec.h"

namespace thimble {

/// What a section holds. A reader passes over the kinds that it does not know.
enum class SectionKind : uint32_t {
  kTree = 1,      ///< the compact tree (exactly one)
  kPalette = 2,   ///< r, g, b a material, up to 256
  kCamera = 3,    ///< SceneCamera
  kBrickMap = 4,  ///< tables for frames on a chip (brick_map.h)
  kName = 5,      ///< what it was made from: text in UTF-8, no final zero
};

/// How a scene wants to be looked at. The picture's size is the display's own.
struct SceneCamera {
  bool is_perspective = true;
  Vec3Q8 eye;
  Vec3Q8 target;
  Vec3i up;                             ///< all 0: default_up
  Q16 fov_degrees = Q16::saturate(60);  ///< perspective: vertical
  int32_t span_q14 = 0;                 ///< orthographic: width of the picture in voxels, 1/16384
};

/// Views into the bytes of a baked scene; plain data, copy it as you like. Valid as long as the bytes are.
class BakedScene {
 public:
  /// Looks at the header, the list of sections and what each must hold; does not read the tree's nodes, so
  /// its cost does not grow with the scene. A scene that opens is safe to trace, whatever its bytes say.
  /// Errors, which leave `*scene` as it was: kDamaged (not a baked scene, another version, sections that do
  /// not lie within the bytes, overlap or are missing, a tree that does not open, a camera that no view could
  /// be made of).
  static Status open(ConstBytes bytes, BakedScene* scene);

  /// Recomputes the CRC-32 and validates the tree: kOk or kDamaged. Reads every byte once; a board does it at
  /// its start.
  Status validate() const;

  const CompactTree& tree() const { return tree_; }
  /// Colours by material; may be empty.
  Span<const Rgb8> palette() const { return palette_; }
  bool has_camera() const { return has_camera_; }
  const SceneCamera& camera() const { return camera_; }
  /// The bytes of a section; empty when there is none of that kind.
  ConstBytes section(SectionKind kind) const;
  /// All bytes, and the CRC-32 that the header states.
  ConstBytes bytes() const { return bytes_; }
  uint32_t crc32() const { return crc32_; }

 private:
  ConstBytes bytes_;
  CompactTree tree_;
  Span<const Rgb8> palette_;
  SceneCamera camera_;
  uint32_t crc32_ = 0;
  bool has_camera_ = false;
};

/// The parts that a baked scene is made of; empty ones are left out.
struct BakedParts {
  ConstBytes tree;
  Span<const Rgb8> palette;
  const SceneCamera* camera = nullptr;
  ConstBytes brick_map;
  ConstBytes name;
};
/// Bytes that `bake` writes for these parts.
size_t baked_bytes(const BakedParts& parts);
/// Writes the header, the list and the sections to the front of `to`. kOutOfMemory when they do not fit,
/// kBadArgument when the tree does not open or a part is too long; nothing is written then.
Status bake(const BakedParts& parts, Bytes to);

}  // namespace thimble

#endif
