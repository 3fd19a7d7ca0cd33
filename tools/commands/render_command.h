/// @file render_command.h
/// The options of `thimble render`, and the ways to draw it.
#ifndef THIMBLE_TOOLS_COMMANDS_RENDER_COMMAND_H
#define THIMBLE_TOOLS_COMMANDS_RENDER_COMMAND_H

#include <optional>
#include <string>

#include "commands/camera_path.h"
#include "commands/scene_options.h"
#include "commands/stats.h"
#include "output/image.h"
#include "output/output_set.h"
#include "scene/default_look.h"
#include "scene/framing.h"
#include "scene/sampling.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

class GpuEngine;

struct RenderCommand {
  SceneOptions scene;
  EngineOptions engine;
  ViewWishes view;
  Quality quality;
  EffectWishes effects;
  LookWishes look;
  bool wishes_look = false;  ///< --background or --ground
  bool verbose = false;
  int turntable = 0;        ///< frames of a film; 0: none
  std::string camera_path;  ///< a file of a film's cameras; empty: none
  bool fov_given = false;
  CameraPath path;                 ///< what it holds, once it is read
  std::optional<RowRange> rows;    ///< a part of a picture
  std::optional<RowRange> frames;  ///< a part of a film
  ShadeMode shade = ShadeMode::kDepth;
  std::string shade_name;  ///< empty unless given
  std::string output;
  std::string hits_path;
  std::string depth_path;

  bool is_film() const { return turntable != 0 || !camera_path.empty(); }
};

/// The files that it writes, by their place in the set.
enum RenderOutput : std::size_t { kPicture, kHits, kDepths, kStats };

/// Rows in a band of `row_bytes` each: as many as a sixteenth of the budget holds, fewer when the scene needs
/// the room; at most `most`.
std::int32_t band_rows(const RenderCommand& command, std::size_t row_bytes, std::int32_t most);

/// Pixel by pixel once more, for the files that hold hits and distances; by `gpu` if it is not null.
void write_hits(const RenderCommand& command, const QualityFrame& frame, GpuEngine* gpu, const Camera& camera,
                OutputFile* csv, OutputFile* pfm);

/// For a person: what the scene takes, and what came of it.
void print_summary(const Stats& stats, const std::string& note);

/// Whether the scene's own look is drawn: nobody said how to shade, and nothing that was said forbids light.
bool takes_look(const RenderCommand& command);
/// Draws that: a picture, or a film with --turntable or --camera-path; or a part of one.
void render_look(const RenderCommand& command, const SceneSource& source, OutputSet& outputs);

}  // namespace thimble::tools

#endif
