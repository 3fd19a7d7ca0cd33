// thimble bake: a scene as bytes for flash.
#include <cstdio>
#include <memory>

#include "commands/arguments.h"
#include "commands/commands.h"
#include "commands/scene_options.h"
#include "commands/stats.h"
#include "commands/view_options.h"
#include "output/c_header.h"
#include "output/output_set.h"
#include "output/progress.h"
#include "output/units.h"
#include "scene/baking.h"
#include "scene/board_fit.h"
#include "scene/framing.h"
#include "scene/generators.h"

namespace thimble::tools {
namespace {

struct BakeCommand {
  SceneOptions scene;  // its --memory is the limit of what is written
  ViewWishes view;
  std::string output;
  std::string identifier = kDefaultIdentifier;
  bool as_header = false;
  bool brick_map = false;
  EffectChoice effects;

  FlashLimit limit() const { return {scene.board, scene.memory_bytes}; }
};

BakingOptions baking_options(const BakeCommand& command, const SceneSource& source, std::string* note) {
  BakingOptions options;
  options.limit_bytes = command.limit().bytes();
  options.name = scene_name(command.scene.arguments.scene);
  options.brick_map = command.brick_map || command.scene.board != nullptr;
  options.effects = command.effects;
  options.default_look = source.baked() == nullptr && !parse_generator(command.scene.arguments.scene);
  if (const platform::BoardFacts* const board = command.scene.board) {
    options.most_map_level = board->most_map_level;
    options.display = DisplayFacts{board->format, board->width_px, board->height_px};
  } else {
    options.keeps_look = options.default_look;
    options.display = DisplayFacts{PixelFormat::kRgb888, command.view.width_px, command.view.height_px};
  }
  options.camera = [&command, &source, note](const CompactTree& tree) {
    const SceneShape shape = shape_of(tree);
    const bool for_board = command.scene.board != nullptr;
    Framing framing =
        for_board ? frame_round(command.view, source, shape) : frame_scene(command.view, source, shape);
    if (note != nullptr && !framing.note.empty()) {
      *note = framing.note;
    }
    return framing.kept;
  };
  return options;
}

// What would fit instead, what loses least first: found by baking so.
std::string advice(const BakeCommand& command, const SceneSource& source, EffectSet effects) {
  std::string text = ";";
  const auto fits = [&](const BakeCommand& other, const SceneSource& from, Baked* baked) {
    BakingOptions options = baking_options(other, from, nullptr);
    *baked = with_progress("trying what would fit", command.scene.quiet, [&](const Progress& progress) {
      return bake_within(other.limit(), from, &options, progress);
    });
    return baked->fits;
  };
  Baked baked;
  if (effects != Effect::kNone) {
    BakeCommand plain = command;
    plain.effects = {};
    plain.effects.automatic = false;
    plain.effects.is_given = true;
    if (fits(plain, source, &baked)) {
      text += " --effects none fits with all its voxels in " + grouped(baked.bytes.size()) + " bytes;";
    }
  }
  text += source.is_scalable() ? " --coarsen makes the finest tree that fits"
                               : " this scene has one depth only, --coarsen makes the finest tree that fits";
  BakeCommand shallow = command;
  for (int depth = source.level() - 1; source.is_scalable() && depth >= kMinLevel; --depth) {
    shallow.scene.arguments.depth = depth;
    try {
      const auto smaller = open_scene(shallow.scene.arguments);
      if (fits(shallow, *smaller, &baked)) {
        text += "; --depth " + std::to_string(depth) + " fits with " + grouped(baked.bytes.size()) + " bytes";
        break;
      }
    } catch (const InputError&) {
      break;  // a pipe is read only once; and a camera may suit one world and not another
    }
  }
  return text + (command.scene.board == nullptr ? "" : " (make firmware takes such options as BAKE=\"...\")");
}

void report(const BakeCommand& command, const BakingOptions& options, const Baked& baked, bool lost_light,
            const std::string& note) {
  const CompactTree& tree = baked.scene.tree();
  const std::uint64_t bytes = baked.bytes.size();
  std::string text;
  if (!note.empty()) {
    text += "note: " + note + "\n";
  }
  const double a_voxel = static_cast<double>(bytes) / static_cast<double>(tree.voxel_count());
  text += grouped(tree.voxel_count()) + (tree.voxel_count() == 1 ? " voxel" : " voxels") + " in " +
          grouped(bytes) + " bytes (depth " + std::to_string(tree.level()) +
          (tree.voxel_count() == 0 ? "" : ", " + fixed(a_voxel, 2) + " bytes a voxel") + ")\n";
  if (baked.effects != Effect::kNone) {
    text += "for the effects " + effects_text(baked.effects) + "\n";
  }
  if (command.scene.board != nullptr && options.brick_map && !tree.empty() &&
      tree.level() <= options.most_map_level && baked.scene.section(SectionKind::kBrickMap).empty()) {
    text += "without a brick map, for which there is no room: frames take several times longer\n";
  }
  if (lost_light) {
    text += "without light, for which there is no room\n";
  }
  if (tree.solid_added() != 0) {
    text += "coarsened to fit: " + grouped(tree.solid_added()) +
            (tree.solid_added() == 1 ? " voxel" : " voxels") + " of solid volume added\n";
  }
  if (const platform::BoardFacts* board = command.scene.board) {
    const std::uint64_t flash = scene_flash_bytes(*board, baked.effects);
    const std::uint64_t ram = drawing_ram_bytes(*board, baked.effects);
    text += std::string(board->name) + ": flash " + grouped(bytes) + " of the " + grouped(flash) +
            " bytes beside the demonstration's " + grouped(code_flash_bytes(*board, baked.effects)) +
            "; RAM " + grouped(ram) + " of " + grouped(board->ram_bytes) + " bytes (renderer " +
            grouped(lit_render_bytes(baked.effects)) + ", band of " + std::to_string(kBoardBandRows) +
            " rows " + grouped(board_band_bytes(*board)) + ", stack " + grouped(board->stack_bytes) + ")" +
            (ram > board->ram_bytes ? ": too much" : "") + "\n";
  }
  std::fputs(text.c_str(), stderr);
}

Stats stats_of(const BakeCommand& command, const SceneSource& source, const Baked& baked,
               std::optional<std::uint64_t> limit) {
  const CompactTree& tree = baked.scene.tree();
  Stats stats;
  stats.scene = command.scene.arguments.scene;
  stats.depth = tree.level();
  stats.points = source.points();
  stats.voxels = tree.voxel_count();
  stats.nodes = tree.node_count();
  stats.tree_bytes = tree.size_bytes();
  stats.budget_bytes = limit.value_or(baked.bytes.size());
  stats.high_water_bytes = baked.work_bytes;
  stats.solid_added = tree.solid_added();
  stats.build_seconds = baked.seconds;
  stats.baked_bytes = baked.bytes.size();
  stats.baked_crc32 = crc_text(baked.scene.crc32());
  if (command.scene.board != nullptr) {
    stats.board = command.scene.board->name;
  }
  return stats;
}

void run(const BakeCommand& given) {
  BakeCommand command = given;
  use_display(command.scene.board, &command.view);
  OutputSet outputs({command.output, command.scene.stats_path}, {command.scene.arguments.scene});
  const auto source = command.scene.open();
  std::string note;
  BakingOptions options = baking_options(command, *source, &note);
  options.coarsen = command.scene.coarsen;
  const bool lit = options.default_look;
  const Baked baked = with_progress("baking", command.scene.quiet, [&](const Progress& progress) {
    return bake_within(command.limit(), *source, &options, progress);
  });
  if (!baked.fits) {
    throw InputError(too_large_text(command.limit(), baked, options, source->level()) +
                     (options.coarsen ? "" : advice(command, *source, baked.effects)));
  }

  if (command.as_header) {
    outputs[0]->write(c_header_text(baked.scene, command.identifier));
  } else {
    outputs[0]->write(baked.bytes);
  }
  if (outputs[1] != nullptr) {
    outputs[1]->write(stats_text(stats_of(command, *source, baked, options.limit_bytes)));
  }
  outputs.commit();
  if (!command.scene.quiet) {
    report(command, options, baked, lit && !options.default_look, note);
  }
}

}  // namespace

void add_bake(CLI::App& app) {
  auto command = std::make_shared<BakeCommand>();
  CLI::App* sub = add_command(
      app, "bake", "Bake a scene: its compact tree, palette and camera as one block of bytes for flash.");
  command->scene.add_scene(*sub);
  add_text_option(
      *sub, "-o,--output", "FILE",
      [command](const std::string& text) {
        command->output = text;
        command->as_header = ends_in(text, ".h");
        return text == "-" || command->as_header || ends_in(text, ".oct") ? "" : "does not end in .oct or .h";
      },
      "the bytes as a file (.oct) or as a C and C++ header (.h); - is the bytes on standard output")
      ->required();
  add_bytes(*sub, "--memory", &command->scene.memory_bytes,
            "the most bytes that the baked scene may take, such as 65536, 64K or 2M (default: no limit)");
  add_board(*sub, &command->scene.board,
            "the limit is what the demonstration leaves of the board's flash (the smaller counts if --memory "
            "is given too), and the camera frames the scene for its display, so that all of it stays in the "
            "picture while it turns");
  add_flag(*sub, "--coarsen", &command->scene.coarsen,
           "when it does not fit, merge blocks of voxels until it just does; this only adds solid");
  add_flag(*sub, "--brick-map", &command->brick_map,
           "add a table that makes frames on a chip several times faster, in worlds of up to 1,024 a side "
           "(256 on most boards), as long as all keeps the limit; --board always does");
  add_effect_list(
      *sub, &command->effects,
      "what the scene is baked for: auto (what its materials and lights call for), none, or effects with "
      "commas between them; a header states the set as a macro, so that firmware holds no others (default: "
      "auto, for a file that states no light a sun over the viewer's shoulder with shadows and a light "
      "sky, for a mesh smooth-normals, and for a board's display of few greys edges instead of the sky; the "
      "ground, which is no voxels, and the gentle end of bright tones are drawn by thimble render, for the "
      "baked scene as for its file, and never by a chip)",
      false);
  add_text_option(
      *sub, "--name", "IDENT",
      [command](const std::string& text) {
        command->identifier = text;
        return is_identifier(text) ? "" : "cannot be the name of an array in C and C++";
      },
      "what a header calls the array; its macros begin with the same in capitals")
      ->default_str(kDefaultIdentifier);
  add_picture_view(*sub, &command->view);
  command->scene.add_report(*sub);
  when_chosen(*sub, [command] { run(*command); });
}

}  // namespace thimble::tools
