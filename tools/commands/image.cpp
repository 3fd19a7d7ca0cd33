// thimble image: a scene behind a program that is built already.
#include <cstdio>
#include <memory>

#include "commands/arguments.h"
#include "commands/bake_command.h"
#include "commands/commands.h"
#include "output/output_set.h"
#include "output/units.h"
#include "scene/board_fit.h"
#include "scene/board_images.h"

namespace thimble::tools {
namespace {

struct ImageCommand : BakeCommand {
  std::string app = "demo";
  std::string folder;
};

const std::vector<std::string> kApps{"demo", "dig", "water"};

// The smallest that draws it.
const BoardImage& image_for(const ImageCommand& command, const std::vector<BoardImage>& images,
                            const Baked& baked) {
  BakedLighting lighting;
  bool has_metal = false;
  if (BakedLighting::open(baked.scene.section(SectionKind::kLighting), baked.scene.tree().level(),
                          &lighting) == Status::kOk) {
    for (const Surface& surface : lighting.scene.surfaces) {
      has_metal = has_metal || surface.kind == SurfaceKind::kMetal;
    }
  }
  // Metals show their own light where nobody wants mirrors, and a program that has mirrors would show them.
  const bool has_dull_metal = has_metal && (baked.effects & Effect::kMirror) == 0;
  for (const BoardImage& image : images) {
    if (command.app == "dig" ||
        (image.draws(baked.effects) && !(has_dull_metal && (image.mark.effects & Effect::kMirror) != 0))) {
      return image;
    }
  }
  throw InputError(not_drawn_text(command, baked.effects));
}

void run(const ImageCommand& given) {
  ImageCommand command = given;
  const platform::BoardFacts& board = *command.scene.board;
  use_display(&board, &command.view);
  OutputSet outputs({command.output, command.scene.stats_path}, {command.scene.arguments.scene});
  const std::vector<BoardImage> images =
      about("the images", [&] { return load_images(command.folder, board, command.app); });
  const auto source = command.scene.open();
  // `dig` shows no light, whatever the scene has.
  command.room = [&](EffectSet effects) {
    std::uint64_t most = 0;
    for (const BoardImage& image : images) {
      most = std::max(most, command.app == "dig" || image.draws(effects) ? image.room() : 0);
    }
    return most;
  };
  BakingOptions options;
  const Baked baked = bake(&command, *source, &options);
  const BoardImage& image = image_for(command, images, baked);
  if (command.app == "water" && (baked.effects & Effect::kWater) == 0) {
    throw InputError("holds no water that water could move: it has no `water` statement");
  }
  outputs[0]->write(image_file(image, baked.bytes, board, command.output));
  if (outputs[1] != nullptr) {
    outputs[1]->write(stats_text(baked_stats(command, *source, baked, options.limit_bytes)));
  }
  outputs.commit();
  if (!command.scene.quiet) {
    const std::uint64_t ram = drawing_ram_bytes(board, baked.effects);
    const std::string text = baked_text(command, options, baked) + board.name + ": flash " +
                             grouped(baked.bytes.size()) + " of the " + grouped(image.room()) +
                             " bytes behind " + command.app +
                             (ram > board.ram_bytes ? "; too little RAM" : "") + "\n";
    std::fputs(text.c_str(), stderr);
  }
}

}  // namespace

void add_image(CLI::App& app) {
  auto command = std::make_shared<ImageCommand>();
  CLI::App* sub =
      add_command(app, "image",
                  "Put a scene behind a program for a board that is built already: a file to flash or "
                  "to drag onto the board's drive, without a compiler.");
  command->scene.add_scene(*sub);
  add_path_option(
      *sub, "-o,--output", "FILE", &command->output,
      "what is written: .elf, .bin or .hex, and what the board's drive or emulator takes (.uf2 for "
      "pico, .gba for gba)")
      ->required();
  add_board(*sub, &command->scene.board, "the board, which must be given")->required();
  add_choice_option(
      *sub, "--app", kApps, [command](std::size_t index) { command->app = kApps[index]; },
      "the application that shows it")
      ->default_str("demo");
  add_fitting(*sub, command.get());
  add_effect_list(
      *sub, &command->effects,
      "what the scene is baked for, as in thimble bake: auto, none, or effects with commas between them");
  add_path_option(
      *sub, "--images", "DIR", &command->folder,
      "where make images has put the programs (default: $THIMBLE_IMAGES, or beside this command)");
  add_picture_view(*sub, &command->view);
  command->scene.add_report(*sub);
  also_check(*sub, [command] {
    if (command->output != "-" && !takes_ending(*command->scene.board, command->output)) {
      refuse_usage("--output", "\"" + command->output + "\" ends in nothing that " +
                                   command->scene.board->name + " takes");
    }
  });
  when_chosen(*sub, [command] { run(*command); });
}

}  // namespace thimble::tools
