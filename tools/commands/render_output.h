/// What `thimble render` writes: a picture, a film, or with --rows and --part a part of one, for `thimble join`.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "commands/camera_path.h"
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

struct RenderOutput {
  std::string path;  ///< --output
  std::function<void(const Image& image)>
      take{};  ///< gets the picture, as its file would hold it, in place of that
  std::string hits_path;
  std::string depth_path;
  int turntable = 0;               ///< frames of a film; 0: none
  std::string camera_path;         ///< a file of a film's cameras; empty: none
  std::optional<double> seconds;   ///< from one of them to the next; else each is a frame
  CameraPath cameras;              ///< of the film's frames, once they are read
  std::optional<RowRange> played;  ///< frames of an animated scene, which the film shows
  std::optional<RowRange> rows;    ///< a part of a picture
  std::optional<RowRange> frames;  ///< a part of a film

  /// What makes a film, --rows and --part.
  void add_films(CLI::App& app);
  bool is_film() const { return turntable != 0 || !camera_path.empty() || played; }
  PartKind film_kind() const {
    return turntable != 0 ? PartKind::kTurntable : played ? PartKind::kAnimation : PartKind::kCameraPath;
  }
  /// The option that makes it one.
  const char* film_option() const {
    return turntable != 0 ? "--turntable" : played ? "--frames" : "--camera-path";
  }
  /// The one file that holds it all; empty for a picture a frame.
  std::string whole_path() const;
  /// Of the whole film, once its cameras are read.
  std::int64_t film_frames() const {
    return turntable != 0 ? turntable
           : played       ? played->count
                          : static_cast<std::int64_t>(cameras.cameras.size());
  }
  /// The names of a picture a frame.
  std::vector<std::string> sequence() const;
  /// How the picture is kept: `of_rows` for a part of one, unless it is to be rows of a .pbm.
  ImageKind kind(ImageKind of_rows) const;
  /// Ends the command as wrong usage where --output, --rows, --part and what makes a film do not go together,
  /// or with what is transparent.
  void check(bool is_transparent) const;
  /// Reads the cameras, and refuses rows and frames that there are not. Throws OutputError.
  void read_sizes(const ViewWishes& view, bool fov_given);
};

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

/// Of these bytes alone, as 8 hex digits.
std::string crc_of(std::span<const std::uint8_t> bytes);

/// Of what was built: its voxels with their materials, the palette, and the light that the scene itself states.
std::uint32_t scene_crc32(const SceneSource& source, const BuiltScene& built);

/// What a picture is drawn with: added to the checksum of a camera or of options.
void add_camera(const SceneCamera& camera, CrcSum* sum);
void add_lighting(const LitDescription& lit, const UsedMaterials& used, EffectSet effects, int level,
                  CrcSum* sum);
void add_look(const Look& look, int level, CrcSum* sum);

}  // namespace thimble::tools
