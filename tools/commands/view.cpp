// thimble view: a scene to look around in.
#include <cstdio>
#include <memory>

#include "commands/arguments.h"
#include "commands/commands.h"
#include "commands/scene_options.h"
#include "commands/view_options.h"
#include "output/output_file.h"
#include "thimble/picture/shading.h"
#include "viewer/controls.h"
#include "viewer/viewer.h"

namespace thimble::tools {
namespace {

struct ViewCommand {
  SceneOptions scene;
  viewer::ViewerOptions viewer;
  EffectWishes effects;
  EngineOptions engine;
  ShadeMode shade = ShadeMode::kDepth;
  int bench_frames = 0;
  int across = 2;  ///< --samples, where it is given
  bool at_edges = false;
};

void run(const ViewCommand& command) {
  viewer::ViewerOptions options = command.viewer;
  options.scene = command.scene.arguments;
  viewer::LookWishes& look = options.look;
  if (!look.shade_word.empty()) {
    look.shade = command.shade;
  }
  if (command.effects.given) {
    look.effects = command.effects.choice;
    look.effects_word = look.effects->automatic ? "auto"
                        : look.effects->on_top  ? "all"
                                                : effects_text(look.effects->effects);
  }
  look.bounces = command.effects.bounces;
  look.engine = command.engine.name;
  refuse_if(look.engine == "gpu" && (look.shade || look.effects),
            "--engine gpu draws the scene's own look, without --shade and --effects");
  look.smooth = command.effects.choice.smooth;
  refuse_if(command.effects.named() && look.shade && command.shade != ShadeMode::kColor, "--shade ",
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
  auto command = std::make_shared<ViewCommand>();
  viewer::ViewerOptions& options = command->viewer;
  CLI::App* sub = add_command(app, "view", "Look around in a scene (thimble SCENE does the same).");
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
  add_effect_options(*sub, &command->effects, {}, "the scene's own look; none with --shade");
  add_samples(*sub, &command->across, &command->at_edges, "in the picture at rest",
              "those of the scene's own look, else 4");
  also_check(*sub, [sub, command] {
    if (is_given(*sub, "--samples")) {
      command->viewer.look.across = command->across;
      command->viewer.look.at_edges = command->at_edges;
    }
  });
  command->engine.add_view_engines_to(*sub);
  add_threads(*sub, &options.threads, "threads that read and draw");
  add_whole_option(
      *sub, "--bench", "N", 1, 100000, &command->bench_frames,
      "no screen: turn once around the scene in N frames, finish the picture, and print what it took as CSV");
  sub->footer("Keys and mouse:\n" + viewer::keys_text());
  when_chosen(*sub, [command] { run(*command); });
}

}  // namespace thimble::tools
