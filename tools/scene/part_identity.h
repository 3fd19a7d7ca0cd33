/// @file part_identity.h
/// What tells parts of one picture from parts of another: checksums of the scene, the camera and the options. What
/// only decides who draws and how fast is in none of them.
#ifndef THIMBLE_TOOLS_SCENE_PART_IDENTITY_H
#define THIMBLE_TOOLS_SCENE_PART_IDENTITY_H

#include <cstdint>
#include <span>
#include <string_view>

#include "scene/built_scene.h"
#include "scene/default_look.h"
#include "scene/lit_description.h"

namespace thimble::tools {

class SceneSource;

/// A CRC-32 of one thing after the other.
class CrcSum {
 public:
  void add(std::span<const std::uint8_t> bytes);
  void add(std::string_view text);
  void add(std::int64_t number);
  /// Numbers as a JSON or a text would keep them apart: each with its own width.
  template <class... Numbers>
  void add_all(Numbers... numbers) {
    (add(static_cast<std::int64_t>(numbers)), ...);
  }
  std::uint32_t value() const { return crc_; }

 private:
  std::uint32_t crc_ = 0;
};

/// Of what was built: its voxels with their materials, the palette, and the light that the scene itself states.
std::uint32_t scene_crc32(const SceneSource& source, const BuiltScene& built);

/// What a picture is drawn with: added to the checksum of a camera or of options.
void add_camera(const SceneCamera& camera, CrcSum* sum);
void add_lighting(const LitDescription& lit, const UsedMaterials& used, EffectSet effects, int level,
                  CrcSum* sum);
void add_look(const Look& look, int level, CrcSum* sum);

}  // namespace thimble::tools

#endif
