/// @file baked_scene.h
/// A whole scene as bytes: compact tree, palette, camera, lighting, and tables that make tracing faster.
///
/// `thimble bake` writes them, as a file (`.oct`) or as a C array for flash (`.h`); a program opens them
/// where they lie. Nothing is copied or unpacked, no alignment is needed (a brick map wants the bytes to
/// start at a multiple of 8), and the bytes are the same on every chip. src/FORMAT.md has the layout: a
/// header with a version, a CRC-32 and a list of sections.
///
/// What it does not do: hold a scene that is still being built (octree.h), or several trees.
#ifndef THIMBLE_BAKE_BAKED_SCENE_H
#define THIMBLE_BAKE_BAKED_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "../picture/camera.h"
#include "../picture/pixel.h"
#include "../tree/compact_tree.h"

namespace thimble {

/// The version of the format that is written, and the only one that is read. src/FORMAT.md, "Versions", says
/// when it goes up.
inline constexpr uint8_t kBakedVersion = 1;
/// Bytes before the list of sections, and bytes of the list for each of them.
inline constexpr size_t kBakedHeaderBytes = 16;
inline constexpr size_t kBakedEntryBytes = 12;
/// The most sections that a scene may have, known kinds and unknown ones.
inline constexpr uint32_t kMaxSections = 16;
/// Limits of the parts.
inline constexpr size_t kMaxPaletteColors = 256;
inline constexpr size_t kMaxNameBytes = 255;

/// The bit that marks a kind whose section changes no picture. A reader passes over a kind with it that it
/// does not know, and refuses the scene for an unknown kind without it.
inline constexpr uint32_t kOptionalKind = uint32_t{1} << 31;

/// What a section holds. 0 is no kind.
enum class SectionKind : uint32_t {
  kTree = 1,                  ///< the compact tree (exactly one)
  kPalette = 2,               ///< r, g, b a material, up to 256
  kCamera = 3,                ///< SceneCamera
  kBrickMap = 4,              ///< tables for frames on a chip (brick_map.h)
  kName = 5,                  ///< what it was made from: text in UTF-8, no final zero
  kLighting = 6,              ///< surfaces, lights, sky, fog, water (light/scene.h)
  kLook = kOptionalKind | 1,  ///< what `thimble render` needs to know of the source; nothing to the core
};

/// How a scene wants to be looked at. The picture's size is the display's own.
struct SceneCamera {
  bool is_perspective = true;
  /// Bits of a ray's direction: 0 for as many as the picture needs, or 8 .. 20 (camera.h).
  uint8_t direction_bits = 0;
  Vec3Q8 eye;     ///< -4 .. 5 world sizes
  Vec3Q8 target;  ///< what is looked at, and what a camera that moves turns around
  /// Where it looks, up to kMaxViewComponent: a direction finer than 1/256 voxel at `target` can say, so that
  /// a board draws the very picture that a host with real numbers drew. All 0: look_at(eye, target). Whoever
  /// moves the eye clears it.
  Vec3i forward;
  Vec3i up;                             ///< all 0: default_up
  Q16 fov_degrees = Q16::saturate(60);  ///< perspective: vertical
  Q14 span;                             ///< orthographic: width of the picture in voxels
};

/// Sets `result` up for a picture of that size in a world of 2^level. Errors, with `*result` as it was: those
/// of `Camera::set`. A camera that a scene was baked with is refused for pictures only where an orthographic
/// one becomes too high (kOutOfRange) or its pixels too fine (kTooFine).
Status set_camera(const SceneCamera& camera, int32_t width_px, int32_t height_px, int level, Camera* result);

/// The parts that a baked scene is made of; empty ones are left out.
struct BakedParts {
  ConstBytes tree;  ///< a compact tree and nothing behind it
  Span<const Rgb8> palette;
  const SceneCamera* camera = nullptr;
  ConstBytes brick_map;
  ConstBytes name;
  ConstBytes lighting;  ///< as `BakedLighting::make` writes it
  ConstBytes look;      ///< for `thimble render`
};
/// Bytes that `BakedScene::make` writes for these parts; SIZE_MAX when a scene cannot hold them.
size_t baked_bytes(const BakedParts& parts);

/// Views into the bytes of a baked scene; plain data, copy it as you like. Valid as long as the bytes are.
class BakedScene {
 public:
  /// Writes the header, the list and the sections to the front of `to`, which does not overlap the parts, and
  /// opens them as `scene` (null: only the bytes are wanted). The tree may lie in `to`, behind a list of
  /// kMaxSections. kOutOfMemory when they do not fit, kBadArgument when the tree does not open, the camera makes
  /// no view or a part is too long; nothing is written then. The CRC-32 makes it read what it wrote: two passes.
  static Status make(const BakedParts& parts, Bytes to, BakedScene* scene);

  /// Looks at the header, the list of sections and what each must hold; does not read the tree's nodes, so
  /// its cost does not grow with the scene. A scene that opens is safe to trace, whatever its bytes say.
  /// `bytes` may be longer than the scene.
  /// Errors, which leave `*scene` as it was: kDamaged (not a baked scene, another version, a section that
  /// this version does not know and that is not optional, sections that do not lie within the bytes, overlap
  /// or are missing, a tree that does not open, a camera that no view could be made of).
  static Status open(ConstBytes bytes, BakedScene* scene);

  /// Reads every byte once: what `open` looks at, the CRC-32, the tree. Returns nullptr for a sound scene,
  /// otherwise a short English phrase saying what is wrong (kAnotherVersion among them). `place` (may be
  /// null) gets the offset of the field or section concerned, or the number of the tree's node.
  static const char* validate(ConstBytes bytes, uint32_t* place = nullptr);
  /// The same for the scene opened: kOk or kDamaged. A board does it at its start.
  Status validate() const { return validate(bytes_) == nullptr ? Status::kOk : Status::kDamaged; }

  const CompactTree& tree() const { return tree_; }
  /// Colours by material; may be empty.
  Span<const Rgb8> palette() const { return palette_; }
  bool has_camera() const { return has_camera_; }
  const SceneCamera& camera() const { return camera_; }
  /// The bytes of a section; empty when there is none of that kind. At most kMaxSections steps.
  ConstBytes section(SectionKind kind) const;
  /// All bytes, and the CRC-32 that the header states.
  ConstBytes bytes() const { return bytes_; }
  uint32_t crc32() const { return crc32_; }

 private:
  static const char* read(ConstBytes bytes, BakedScene* scene, uint32_t* place);
  static const char* check_around(ConstBytes bytes, ConstBytes* tree, uint32_t* place);

  ConstBytes bytes_;
  CompactTree tree_;
  Span<const Rgb8> palette_;
  SceneCamera camera_;
  uint32_t crc32_ = 0;
  bool has_camera_ = false;
};

}  // namespace thimble

#endif
