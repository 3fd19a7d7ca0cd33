// thimble render SCENE -o F.html: one file that shows the scene and lets it be turned, without a network.
#include <algorithm>
#include <string>
#include <string_view>

#include "commands/arguments.h"
#include "commands/page.h"
#include "commands/render_command.h"
#include "output/plot.h"
#include "output/units.h"
#include "output/version.h"
#include "scene/baking.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kMostPreviewBytes = 8000;
constexpr std::int32_t kPreviewPx = 320;  // the longer side of what stands for the file in a list
constexpr int kFramesASecond = 10;

// Each of the scene's frames that are to be shown, or the scene.
std::string scene_scripts(const RenderCommand& command, const SceneSource& first,
                          const LookPicture& picture) {
  std::string text;
  const auto add = [&](const SceneSource& source) {
    text += scene_element(page_scene(command, source, picture.camera));
  };
  add(first);
  for (std::int32_t i = 1; i < command.output.played.value_or(RowRange{}).count; ++i) {
    SceneArguments arguments = command.scene.arguments;
    arguments.frame = static_cast<std::uint32_t>(command.output.played->first + i);
    add(*open_scene(arguments));
  }
  return text;
}

// As share.cpp of tools/web reads it.
std::uint32_t background_number(const Background& background) {
  const Rgb8 color = background.color;
  return background.kind == BackgroundKind::kColor      ? 2U + (static_cast<std::uint32_t>(color.r) << 16 |
                                                           static_cast<std::uint32_t>(color.g) << 8 | color.b)
         : background.kind == BackgroundKind::kGradient ? 1U
                                                        : 0U;
}

}  // namespace

bool names_page(std::string_view path) {
  return ends_in(path, ".html");
}

void check_page(const RenderCommand& command) {
  const RenderOutput& output = command.output;
  if (!takes_look(command) || command.quality.is_sampled || command.effects.choice.smooth ||
      command.effects.bounces || !output.hits_path.empty() || !output.depth_path.empty() ||
      !output.camera_path.empty()) {
    refuse_usage(
        "an .html shows the scene's own look to turn it, without --shade, --effects, --normals, "
        "--bounces, --samples, --structure, --engine, --cutoff, --max-depth, --board, --hits, "
        "--depth-image and --camera-path");
  }
}

void render_page(const RenderCommand& command, const SceneSource& source, OutputSet& outputs) {
  const std::string page = load_page();
  const LookPicture picture = draw_look(command, source);
  RenderCommand small = command;
  const std::int32_t side = std::max(command.view.width_px, command.view.height_px);
  small.view.width_px = std::max(1, command.view.width_px * std::min(kPreviewPx, side) / side);
  small.view.height_px = std::max(1, command.view.height_px * std::min(kPreviewPx, side) / side);
  const std::string name = scene_name(command.scene.arguments.scene);
  const std::string title = xml_text(name.substr(0, name.find('.')));
  const auto [before, behind] = around_scenes(
      page, {{"description", counted(picture.stats.voxels, "voxel") +
                                 ", ray traced by Thimble. Drag to turn, wheel or pinch to come nearer."},
             {"version", version_number()},
             {"colors", edge_colors(picture.image)},
             {"turn", shortest(static_cast<double>(command.output.turntable) / kFramesASecond)},
             {"background", std::to_string(background_number(command.look.wishes.background))},
             {"ground", std::to_string(command.look.wishes.ground ? *command.look.wishes.ground : -1)},
             {"preview", poster_url(draw_look(small, source).image, kMostPreviewBytes)},
             {"title", title}});
  OutputFile& file = *outputs[kPicture];
  file.write(before);
  file.write("<img id=\"poster\" alt=\"" + title + "\" src=\"" + poster_url(picture.image, kMostPosterBytes) +
             "\">\n");
  file.write(scene_scripts(command, source, picture));
  file.write(behind);
  finish(command, picture.stats, picture.note, outputs);
}

}  // namespace thimble::tools
