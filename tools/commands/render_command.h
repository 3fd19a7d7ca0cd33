/// The options of `thimble render`, what it writes, and the ways to draw it.
#pragma once

#include "commands/stats.h"
#include "output/part_file.h"
#include "scene/default_look.h"

namespace thimble::tools {

// --camera-path: the cameras of a film, a line each.

struct PathCamera {
  ViewWishes view;
  std::uint64_t line = 0;   ///< of the file, from 1
  bool is_between = false;  ///< on the way from there to the next
};

struct CameraPath {
  std::vector<PathCamera> cameras;  ///< one or more
  bool has_fov = false;             ///< whether the file says each camera's angle
};

/// The columns, for help and errors.
extern const char* const kPathColumns;

/// Reads all cameras; what the file does not say is that of `view`. Throws OutputError, which names the line, for
/// what is no number, not finite, out of range, too little, too much or too many (kMostFilmFrames), and for a file
/// that cannot be read.
CameraPath read_camera_path(const std::string& path, const ViewWishes& view);

/// So many frames from each camera of `keys` to the next: eye, target, up and angle go along Catmull-Rom splines, which
/// pass through the keys at a speed that does not jump (E. Catmull, R. Rom, "A class of local interpolating splines",
/// 1974), and a frame at the last one. Throws InputError for more than kMostFilmFrames.
CameraPath smoothed(const CameraPath& keys, int frames);

/// A camera each, in the world of `shape`. Throws OutputError, which names the line of a camera that cannot be set.
std::vector<Framing> frame_path(const std::string& path, const CameraPath& cameras, const SceneShape& shape);

// What is written: a picture, a film, or with --rows and --part a part of one, for `thimble join`.

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

/// A CRC-32 of one thing after the other.
class CrcSum {
 public:
  void add(std::span<const std::uint8_t> bytes);
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

/// The part of a picture or of a film that is drawn, but for what it holds: the checksums of what was built (its voxels with
/// their materials, the palette, and the light that the scene itself states), of its cameras and of its options.
PartHeader part_header(const SceneSource& source, const BuiltScene& built,
                       const std::vector<Framing>& framings, const CrcSum& options);

/// What a picture is drawn with: added to the checksum of options.
void add_lighting(const LitDescription& lit, const UsedMaterials& used, EffectSet effects, int level,
                  CrcSum* sum);
void add_look(const Look& look, int level, CrcSum* sum);

/// How the scene is to look.
struct RenderLook {
  LookWishes wishes;
  bool given = false;  ///< --background or --ground
  bool verbose = false;
  ShadeMode shade = ShadeMode::kDepth;
  std::string shade_name;  ///< empty unless given

  bool is_ink() const { return shade_name == kInk; }
};

struct RenderCommand {
  SceneOptions scene;
  EngineOptions engine;
  ViewWishes view;
  bool fov_given = false;
  Quality quality;
  EffectWishes effects;
  RenderLook look;
  RenderOutput output;
};

/// The files that it writes, by their place in the set.
enum RenderFile : std::size_t { kPicture, kHits, kDepths, kStats };

/// All of its options, for `command`.
void add_render_options(CLI::App& app, RenderCommand* command);
/// Draws `source` instead of opening the command's scene, for whoever takes the picture (`RenderOutput::take`).
void render(RenderCommand command, const SceneSource& source);

/// Rows in a band of `row_bytes` each: as many as a sixteenth of the budget holds, fewer when the scene needs
/// the room; at most `most`.
std::int32_t band_rows(const RenderCommand& command, std::size_t row_bytes, std::int32_t most);

/// Writes the picture, or the `part` of one that it is, to the command's file or whoever takes it, and for the files of
/// hits and distances traces once more, pixel by pixel: by `gpu` if it is not null.
void write_frame(const RenderCommand& command, ImageKind kind, const Image& image,
                 const std::function<PartHeader()>& part, const QualityFrame& frame, GpuEngine* gpu,
                 const Camera& camera, Stats* stats, OutputSet& outputs);

/// Writes --stats, gives the files their names and tells a person what the scene takes and what came of it.
void finish(const RenderCommand& command, const Stats& stats, const std::string& note, OutputSet& outputs);

/// Whether the scene's own look is drawn: nobody said how to shade, and nothing that was said forbids light.
bool takes_look(const RenderCommand& command);
/// The scene's own look in the view of `command`, for what is no file of a picture.
struct LookPicture {
  Image image;
  SceneCamera camera;
  std::string note;  ///< of the camera
  Stats stats;
};
LookPicture draw_look(const RenderCommand& command, const SceneSource& source);
/// Draws that: a picture, or a film; or a part of one.
void render_look(const RenderCommand& command, const SceneSource& source, OutputSet& outputs);

/// Whether a picture of that name is a page that turns (page.cpp); ends the command as wrong usage where other
/// options forbid it; draws the poster and writes it.
bool names_page(std::string_view path);
void check_page(const RenderCommand& command);
void render_page(const RenderCommand& command, const SceneSource& source, OutputSet& outputs);

// Pages to hand on: the template that `make web` builds (platform/web/share.html), and what it is filled in with.

inline constexpr std::size_t kMostPosterBytes = 60000;

/// Throws OutputError where there is none.
std::string load_page();
/// What stands before its scenes, each value in its places, one after the other, and behind them. Throws OutputError where it
/// is another page.
std::pair<std::string, std::string> around_scenes(
    const std::string& page, std::initializer_list<std::pair<std::string_view, std::string>> values);

/// The address of a JPEG of that picture within so many bytes: as good as there is room for. Throws InputError.
std::string poster_url(const Image& image, std::size_t most_bytes);
/// The first column's, at the top and at the bottom, for what is behind the picture.
std::string edge_colors(const Image& image);

/// The scene as the page reads it: the bytes of `thimble bake` with that camera, whose picture is that of the scene itself,
/// compressed. With a limit blocks are merged until the bytes before that keep it, where they can.
std::vector<std::uint8_t> page_scene(const RenderCommand& command, const SceneSource& source,
                                     const SceneCamera& camera,
                                     std::optional<std::uint64_t> most_bytes = std::nullopt);
/// The element that holds it.
std::string scene_element(std::span<const std::uint8_t> packed);

}  // namespace thimble::tools
