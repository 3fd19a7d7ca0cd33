// thimble view: a scene to look around in.
#include "commands/commands.h"
#include "viewer/controls.h"
#include "viewer/viewer.h"

namespace thimble::tools {
namespace {

struct ViewCommand {
  SceneOptions scene;
  viewer::ViewerOptions viewer;
  EngineOptions engine;
  ShadeMode shade = ShadeMode::kDepth;
  int bench_frames = 0;
};

void run(const ViewCommand& command) {
  viewer::ViewerOptions options = command.viewer;
  options.scene = command.scene.arguments;
  viewer::LookWishes& look = options.look;
  if (!look.shade_word.empty()) {
    look.shade = command.shade;
  }
  look.engine = command.engine.name;
  refuse_if(look.engine == "gpu" && (look.shade || look.effects.choice.is_given),
            "--engine gpu draws the scene's own look, without --shade and --effects");
  refuse_if(look.effects.named() && look.shade && command.shade != ShadeMode::kColor, "--shade ",
            look.shade_word, " shows no light, and so no --effects");
  if (command.bench_frames != 0) {
    std::printf("%s\n%s\n", viewer::kBenchColumns,
                viewer::bench_viewer(options, command.bench_frames).c_str());
    return;
  }
  viewer::run_viewer(options);
}

}  // namespace

void add_view_command(CLI::App& app) {
  CLI::App* sub = add_command(app, "view", "Look around in a scene (thimble SCENE does the same).");
  ViewCommand* const command = options_for<ViewCommand>(*sub, run);
  viewer::ViewerOptions& options = command->viewer;
  command->scene.add_scene(*sub);
  options.view.width_px = 1280;
  options.view.height_px = 720;
  add_picture_view(*sub, &options.view, false);
  add_choice_option(*sub, "--display",
                    {{"auto", host::ScreenKind::kAuto},
                     {"window", host::ScreenKind::kWindow},
                     {"terminal", host::ScreenKind::kTerminal}},
                    &options.display, "where; auto: an X11 window where DISPLAY works, else the terminal");
  add_shade(*sub, &command->shade, "as for render; without it and --effects the scene decides, as there",
            &options.look.shade_word);
  add_effect_options(*sub, &options.look.effects, {}, "the scene's own look; none with --shade");
  add_samples(*sub, &options.look.across, &options.look.at_edges, "in the picture at rest",
              "those of the scene's own look, else 4");
  command->engine.add_view_engines_to(*sub);
  add_threads(*sub, &options.threads, "threads that read and draw");
  add_whole_option(
      *sub, "--bench", "N", 1, 100000, &command->bench_frames,
      "no screen: turn once around the scene in N frames, finish the picture, and print what it took as CSV");
  sub->footer("Keys and mouse:\n" + viewer::keys_text());
}

}  // namespace thimble::tools
