/// The options of `thimble render`, and the ways to draw it.
#pragma once

#include <memory>
#include <string>

#include "commands/render_output.h"
#include "commands/scene_options.h"
#include "commands/stats.h"
#include "commands/view_options.h"
#include "output/output_file.h"
#include "scene/default_look.h"
#include "scene/framing.h"
#include "scene/sampling.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

class GpuEngine;

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
void add_render_options(CLI::App& app, const std::shared_ptr<RenderCommand>& command);
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

}  // namespace thimble::tools
