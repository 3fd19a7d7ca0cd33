// In place of view.cpp and the viewer in a build without the wide renderer.
#include <memory>
#include <string>

#include "commands/arguments.h"
#include "commands/commands.h"

namespace thimble::tools {

void add_view_command(CLI::App& app) {
  CLI::App* sub = add_command(app, "view", "Look around in a scene: not in this build (-DTHIMBLE_WIDE=OFF).");
  auto scene = std::make_shared<std::string>();
  sub->add_option("scene", *scene, "a file, a generator, or the name of a scene")->type_name("SCENE");
  when_chosen(*sub, [scene] {
    refuse_usage("this build has no viewer (-DTHIMBLE_WIDE=OFF); thimble render " + *scene +
                 " -o picture.png draws the scene");
  });
}

}  // namespace thimble::tools
