// thimble image: a scene behind a program that is built already.
#include <cstdlib>
#include <filesystem>

#include "commands/bake_command.h"
#include "commands/commands.h"
#include "scene/board_images.h"
#include "scene/named_scenes.h"

namespace thimble::tools {
namespace {

struct ImageCommand : BakeCommand {
  std::string app = "demo";
  std::string folder;
};

constexpr std::uint64_t kMostImageBytes = std::uint64_t{16} << 20;
// Sets of effects that a board has programs for (platform/images.sh).
constexpr const char* kSets[] = {"plain", "sun", "all"};

// Those of the board and the application, sorted. `folder` empty: $THIMBLE_IMAGES, or the folder beside the program.
std::vector<BoardImage> load_images(std::string folder, const platform::BoardFacts& board,
                                    const std::string& app) {
  if (const char* named = std::getenv("THIMBLE_IMAGES"); folder.empty() && named != nullptr) {
    folder = named;
  }
  if (folder.empty()) {
    folder = folder_beside_program("images");
  }
  std::vector<BoardImage> images;
  for (const char* set : kSets) {
    const std::string path = folder + "/" + board.name + "-" + app + "-" + set + ".elf.gz";
    std::error_code error;
    if (!folder.empty() && std::filesystem::exists(path, error)) {
      try {
        images.push_back(open_image(load_file(path, kMostImageBytes).text(), board));
      } catch (const InputError& wrong) {
        throw InputError(path, " ", wrong.what());
      }
    }
  }
  fail_if(images.empty(), "there is no image of ", app, " for ", board.name,
          folder.empty() ? "" : " in " + folder,
          "; make images builds them, --images or $THIMBLE_IMAGES says where they are");
  sort_images(&images);
  return images;
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
  const bool is_dig = command.app == "dig";
  command.room = [&](EffectSet effects) {
    return is_dig ? images.front().room() : room_behind(images, effects);
  };
  BakingOptions options;
  const Baked baked = bake(&command, *source, &options);
  const BoardImage* const image = is_dig ? &images.front() : image_for(images, baked);
  fail_if(image == nullptr, not_drawn_text(command, baked.effects));
  fail_if(command.app == "water" && (baked.effects & Effect::kWater) == 0,
          "holds no water that water could move: it has no `water` statement");
  outputs[0]->write(image_file(*image, baked.bytes, board, command.output));
  outputs.write(1, stats_text(baked_stats(command, *source, baked, options.limit_bytes)));
  outputs.commit();
  if (!command.scene.quiet) {
    const std::uint64_t ram = drawing_ram_bytes(board, baked.effects);
    const std::string text = baked_text(command, options, baked) + board.name + ": flash " +
                             grouped(baked.bytes.size()) + " of the " + grouped(image->room()) +
                             " bytes behind " + command.app +
                             (ram > board.ram_bytes ? "; too little RAM" : "") + "\n";
    std::fputs(text.c_str(), stderr);
  }
}

}  // namespace

void add_image(CLI::App& app) {
  CLI::App* sub =
      add_command(app, "image",
                  "Put a scene behind a program for a board that is built already: a file to flash or "
                  "to drag onto the board's drive, without a compiler.");
  ImageCommand* const command = options_for<ImageCommand>(*sub, run);
  command->scene.add_scene(*sub);
  add_path_option(
      *sub, "-o,--output", "FILE", &command->output,
      "what is written: .elf, .bin or .hex, and what the board's drive or emulator takes (.uf2 for "
      "pico, .gba for gba)")
      ->required();
  add_board(*sub, &command->scene.board, "the board, which must be given")->required();
  add_choice_option(*sub, "--app", {"demo", "dig", "water"}, &command->app, "the application that shows it");
  add_fitting(*sub, command);
  add_effect_list(
      *sub, &command->effects,
      "what the scene is baked for, as in thimble bake: auto, none, or effects with commas between them");
  add_path_option(
      *sub, "--images", "DIR", &command->folder,
      "where make images has put the programs (default: $THIMBLE_IMAGES, or beside this command)");
  add_picture_view(*sub, &command->view);
  command->scene.add_report(*sub);
  also_check(*sub, [command] {
    refuse_if(command->output != "-" && !takes_ending(*command->scene.board, command->output), "--output: \"",
              command->output, "\" ends in nothing that ", command->scene.board->name, " takes");
  });
}

}  // namespace thimble::tools
