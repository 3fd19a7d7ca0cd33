// In place of view.cpp and the viewer in a build without the wide renderer.
#include "commands/commands.h"

namespace thimble::tools {

void add_view_command(CLI::App& app) {
  CLI::App* sub = add_command(app, "view", "Look around in a scene: not in this build (-DTHIMBLE_WIDE=OFF).");
  std::string* const scene = options_for<std::string>(*sub, [](const std::string& given) {
    refuse_usage("this build has no viewer (-DTHIMBLE_WIDE=OFF); thimble render " + given +
                 " -o picture.png draws the scene");
  });
  sub->add_option("scene", *scene, "a file, a generator, or the name of a scene")->type_name("SCENE");
}

}  // namespace thimble::tools
