/// @file part_options.h
/// --rows and --part: a part of a picture or of a film, for `thimble join`.
#ifndef THIMBLE_TOOLS_COMMANDS_PART_OPTIONS_H
#define THIMBLE_TOOLS_COMMANDS_PART_OPTIONS_H

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "output/image.h"
#include "output/part_file.h"
#include "scene/built_scene.h"
#include "scene/default_look.h"
#include "scene/lit_description.h"

namespace CLI {
class App;
}

namespace thimble::tools {

class OutputFile;
struct RenderCommand;

/// An option that is FIRST:COUNT.
void add_range(CLI::App& app, const std::string& name, std::optional<RowRange>* range,
               const std::string& help);
/// Ends the command as wrong usage where `range` reaches beyond `all` rows or frames.
void check_range(const std::string& name, const RowRange& range, std::int64_t all,
                 const std::string& of_what);

/// Ends the command as wrong usage where --output, --rows, --part, --turntable and --camera-path do not go together.
void check_output(const RenderCommand& command);

/// Whether a part of that name is drawn in one bit a pixel: its ending is .pbm.part.
bool is_mono_part(const std::string& output);

/// The part of a picture that these rows are. `image` is Rgb888, with or without alpha, or Mono1.
void write_rows(OutputFile* file, PartHeader header, const Image& image, std::int32_t height_px);

// What tells parts of one picture from parts of another: checksums of the scene, the camera and the options. What
// only decides who draws and how fast is in none of them.

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
