// thimble boards: what the boards are, and what of a scene fits on each.
#include <cstring>
#include <map>
#include <tuple>

#include "boards/frame_costs.h"
#include "commands/commands.h"
#include "counted/counted.h"
#include "scene/baking.h"
#include "scene/board_fit.h"

namespace thimble::tools {
namespace {

using platform::BoardFacts;

struct BoardsCommand {
  SceneOptions scene;
  ReportPaths files;
};

// The scene in the forms that boards take.
struct SceneSizes {
  int depth = 0;
  std::uint64_t voxels = 0;
  std::uint64_t baked_bytes = 0;
  std::uint64_t pool_bytes = 0;                 ///< to build it voxel by voxel
  std::map<int, std::uint64_t> bytes_of_depth;  ///< baked, for the depths tried
  EffectSet effects = Effect::kNone;            ///< that the scene states
  bool is_scalable = false;
  int most_depth = 0;                                       ///< deeper ones were not to be tried
  std::map<std::string, std::uint64_t> frame_instructions;  ///< by board
};

const char* screen_name(platform::Screen screen) {
  constexpr std::array kScreenNames{"none", "oled", "lcd", "plain"};  // in the order of `Screen`
  return kScreenNames[static_cast<std::size_t>(screen)];
}

// Bytes of the scene when it is baked; and fewer than it takes a depth deeper.
struct BakedSize {
  std::uint64_t bytes = 0;
  std::uint64_t least_of_next = 0;
  EffectSet effects = Effect::kNone;
};

BakedSize size_when_baked(const BoardsCommand& command, const SceneSource& source, const Progress& progress) {
  BakingOptions options;
  options.name = scene_name(command.scene.arguments.scene);
  options.camera = [&](const CompactTree& tree) {
    return frame_scene({}, source, {tree.level(), tree.bounds()}).kept;
  };
  const Baked baked = bake_scene(source, options, progress);
  // A depth deeper every voxel beside a block becomes a node below the nodes that are there. Few of those
  // are filled to solid blocks then; an eighth is left for them.
  const CompactTree& tree = baked.scene.tree();
  std::uint64_t voxels = 0;
  walk_blocks(tree, [&](const Vec3i&, int level, std::uint8_t) { voxels += level == 0 ? 1U : 0U; });
  return {baked.bytes.size(), (tree.node_count() + voxels) / 8 * 7, baked.effects};
}

// As `bake --board --effects none` does, with a map whatever its size.
std::uint64_t count_frame(const BoardFacts& board, const SceneSource& source, counted::FrameWork* work) {
  ViewWishes view;
  view.width_px = board.width_px;
  view.height_px = board.height_px;
  view.side = NamedView::kBest;
  view.fov_degrees = kPictureFov;
  BakingOptions options;
  options.brick_map = true;
  options.effects = {false};
  options.camera = [&](const CompactTree& tree) {
    return frame_round(view, source, shape_of(source, tree)).kept;
  };
  const BakedScene* const given = source.baked();
  const Baked made = given != nullptr ? Baked() : bake_scene(source, options);
  const ConstBytes bytes = (given != nullptr ? *given : made.scene).bytes();
  const bool is_ink = bits_per_pixel(board.format) == 1;
  return counted::count_frames(bytes.data, bytes.size, board.width_px, board.height_px, is_ink, work)
             ? bytes.size
             : 0;
}

// Frames a second of a scene on each board, before anybody has one.
class BoardFrames {
 public:
  explicit BoardFrames(const SceneSource& source) : source_(source) {}

  // Instructions of a frame of the scene without light by the brick map, as `bench` counts them (the median of eight
  // views), within a fifth (tests/budgets/scene_frames.csv); 0 where scene and map do not fit beside the
  // program, or the world has no map. Bakes for each size of display once.
  std::uint64_t instructions(const BoardFacts& board) {
    const auto cost = std::find_if(std::begin(kFrameCosts), std::end(kFrameCosts), [&](const FrameCost& one) {
      return std::strcmp(one.cpu, board.cpu) == 0;
    });
    if (source_.level() > board.most_map_level || cost == std::end(kFrameCosts)) {
      return 0;
    }
    const Counted& work = counted(board);
    if (work.bytes == 0 || work.bytes > scene_flash_bytes(board)) {
      return 0;
    }
    const auto all = [&](const counted::FrameWork& one) {
      return static_cast<std::int64_t>(one.blocks * cost->block_hundredths / 100 + one.hits * cost->hit);
    };
    const std::int64_t frame = std::int64_t{board.frame_instructions} + all(work.scene) - all(work.demo);
    return static_cast<std::uint64_t>(std::max<std::int64_t>(frame, 1));
  }

 private:
  struct Counted {
    std::uint64_t bytes = 0;  ///< baked, with a map; 0: it has none
    counted::FrameWork scene;
    counted::FrameWork demo;
  };
  const Counted& counted(const BoardFacts& board) {
    const auto [at, is_new] =
        counted_.try_emplace({board.width_px, board.height_px, bits_per_pixel(board.format) == 1});
    Counted& counted = at->second;
    if (is_new) {
      counted.bytes = count_frame(board, source_, &counted.scene);
      SceneArguments arguments;
      arguments.scene = "demo";
      count_frame(board, *open_scene(arguments), &counted.demo);
    }
    return counted;
  }

  const SceneSource& source_;
  std::map<std::tuple<std::int32_t, std::int32_t, bool>, Counted> counted_;  ///< by width, height, ink
};

SceneSizes measure(const BoardsCommand& command) {
  SceneSizes sizes;
  const auto source = command.scene.open();
  ProgressBar bar("measuring", command.scene.quiet);
  const auto progress = [&](double done) { bar.update(done); };
  sizes.depth = source->level();
  const BakedSize size = size_when_baked(command, *source, progress);
  sizes.baked_bytes = size.bytes;
  sizes.effects = size.effects;
  BuildOptions pool;
  pool.structure = StructureKind::kPool;
  const BuiltScene built(*source, pool, progress);
  sizes.voxels = built.voxels();
  sizes.pool_bytes = built.high_water_bytes();
  sizes.bytes_of_depth[sizes.depth] = sizes.baked_bytes;
  sizes.most_depth = sizes.depth;
  BoardFrames frames(*source);
  for (const BoardFacts& board : platform::boards()) {
    const bool fits = sizes.baked_bytes <= scene_flash_bytes(board);
    sizes.frame_instructions[board.name] = fits ? frames.instructions(board) : 0;
  }
  sizes.is_scalable = source->is_scalable();
  if (!sizes.is_scalable) {
    return sizes;
  }
  // The voxels of solid bodies grow eightfold with each depth, so those stop earlier.
  constexpr int kMostSolidDepth = 9;
  sizes.most_depth =
      source->is_point_set() || source->is_mesh() ? kMaxLevel : std::max(sizes.depth, kMostSolidDepth);
  std::uint64_t least = UINT64_MAX;
  std::uint64_t most = 0;
  for (const BoardFacts& board : platform::boards()) {
    least = std::min(least, scene_flash_bytes(board, sizes.effects));
    most = std::max(most, scene_flash_bytes(board, sizes.effects));
  }
  SceneArguments arguments = command.scene.arguments;
  const auto try_depth = [&](int depth) {
    arguments.depth = depth;
    const auto other = open_scene(arguments);
    const BakedSize result = size_when_baked(command, *other, progress);
    sizes.bytes_of_depth[depth] = result.bytes;
    return result;
  };
  BakedSize last = size;
  for (int depth = sizes.depth - 1; depth >= kMinLevel && last.bytes > least; --depth) {
    last = try_depth(depth);
  }
  last = size;
  for (int depth = sizes.depth + 1; depth <= sizes.most_depth && last.bytes <= most; ++depth) {
    if (last.least_of_next > most) {
      break;  // the deeper one takes more than every board has, and long to make
    }
    last = try_depth(depth);
  }
  return sizes;
}

// The deepest depth whose baked scene the board's flash holds; 0 when none of those tried does.
int deepest(const SceneSizes& sizes, const BoardFacts& board) {
  int result = 0;
  for (const auto& [depth, bytes] : sizes.bytes_of_depth) {
    if (bytes <= scene_flash_bytes(board, sizes.effects)) {
      result = std::max(result, depth);
    }
  }
  return result;
}

// Building and drawing on the chip: the pool, and what drawing takes.
std::uint64_t building_ram_bytes(const SceneSizes& sizes, const BoardFacts& board) {
  return drawing_ram_bytes(board) + sizes.pool_bytes;
}

// One instruction a cycle: no waiting for flash, and no two at once. 0 of no instructions.
double frames_per_second(const BoardFacts& board, std::uint64_t instructions) {
  return instructions == 0 ? 0 : board.core_mhz * 1e6 / static_cast<double>(instructions);
}
double frames_per_second(const BoardFacts& board) {
  return frames_per_second(board, board.frame_instructions);
}

// The one with the least memory that turns the scene at so many frames a second, or null.
const BoardFacts* smallest(const SceneSizes& sizes, double frames) {
  const BoardFacts* found = nullptr;
  for (const BoardFacts& board : platform::boards()) {
    const auto bytes = [](const BoardFacts& one) { return std::uint64_t{one.ram_bytes} + one.flash_bytes; };
    if (frames_per_second(board, sizes.frame_instructions.at(board.name)) >= frames &&
        (found == nullptr || bytes(board) < bytes(*found))) {
      found = &board;
    }
  }
  return found;
}

JsonRow row_of(const BoardFacts& board, const SceneSizes* sizes) {
  JsonRow row;
  put_all(
      &row, "board", board.name, "title", board.title, "core", board.cpu, "ram_bytes", board.ram_bytes,
      "flash_bytes", board.flash_bytes, "stack_bytes", board.stack_bytes, "screen", screen_name(board.screen),
      "width_px", board.width_px, "height_px", board.height_px, "pixel_format", format_name(board.format),
      "buttons", board.buttons, "core_mhz", board.core_mhz, "frame_instructions", board.frame_instructions,
      "frames_per_second_estimate", frames_per_second(board), "scene_flash_bytes",
      scene_flash_bytes(board, sizes == nullptr ? Effect::kNone : sizes->effects), "state_bytes",
      render_bytes(), "band_bytes", board_band_bytes(board), "drawing_ram_bytes", drawing_ram_bytes(board));
  if (sizes != nullptr) {
    const std::uint64_t instructions = sizes->frame_instructions.at(board.name);
    const std::uint64_t building = building_ram_bytes(*sizes, board);
    put_all(&row, "depth", sizes->depth, "voxels", sizes->voxels, "baked_bytes", sizes->baked_bytes,
            "fits_flash", sizes->baked_bytes <= scene_flash_bytes(board, sizes->effects) ? 1 : 0,
            "pool_bytes", sizes->pool_bytes, "building_ram_bytes", building, "builds_in_ram",
            building <= board.ram_bytes ? 1 : 0, "deepest_depth", deepest(*sizes, board),
            "deepest_tried_depth", sizes->bytes_of_depth.rbegin()->first, "scene_frame_instructions",
            instructions, "scene_frames_per_second_estimate", frames_per_second(board, instructions));
  }
  return row;
}

std::string boards_text() {
  const auto facts = [](const BoardFacts& board) {
    return cells_of(board.name, board.cpu,
                    concat(board.width_px, "x", board.height_px, " ", format_name(board.format)),
                    screen_name(board.screen), board.buttons, grouped(board.ram_bytes),
                    grouped(board.flash_bytes), grouped(board.stack_bytes));
  };
  const auto speed = [](const BoardFacts& board) {
    return cells_of(board.name, board.core_mhz, grouped(board.frame_instructions),
                    fixed(frames_per_second(board), 1));
  };
  return table_of({"board", "core", "picture", "display", "buttons", "RAM", "flash", "stack"}, 4,
                  platform::boards(), facts) +
         "\nExact frames of the demonstration: instructions counted; frames a second estimated, at one\n"
         "instruction a cycle.\n\n" +
         table_of({"board", "MHz", "instructions", "frames a second"}, 1, platform::boards(), speed);
}

std::string scene_text(const BoardsCommand& command, const SceneSizes& sizes) {
  std::string text =
      concat("\n", printable(command.scene.arguments.scene), "\n", counted(sizes.voxels, "voxel"),
             " at depth ", sizes.depth, ", ", grouped(sizes.baked_bytes), " bytes baked, ",
             grouped(sizes.pool_bytes), " bytes as a pool built on the chip\n\n");
  const Cells head = cells_of("board", "scene flash", "scene", "RAM to draw", "fits", "RAM to build", "fits",
                              "deepest", "a second");
  text += table_of(head, 1, platform::boards(), [&](const BoardFacts& board) {
    const std::uint64_t flash = scene_flash_bytes(board, sizes.effects);
    const std::uint64_t building = building_ram_bytes(sizes, board);
    const auto yes = [](bool fits) { return fits ? "yes" : "no"; };
    const double share = 100 * static_cast<double>(sizes.baked_bytes) / static_cast<double>(flash);
    const int depth = deepest(sizes, board);
    const double frames = frames_per_second(board, sizes.frame_instructions.at(board.name));
    const bool open_end = sizes.is_scalable && depth == sizes.most_depth && depth < kMaxLevel;
    return cells_of(board.name, grouped(flash), sizes.baked_bytes <= flash ? fixed(share, 1) + " %" : "no",
                    grouped(drawing_ram_bytes(board)), yes(drawing_ram_bytes(board) <= board.ram_bytes),
                    grouped(building), yes(building <= board.ram_bytes),
                    depth == 0 ? "-" : (open_end ? ">= " : "") + std::to_string(depth),
                    frames == 0 ? "-" : fixed(frames, 1));
  });
  text +=
      "\nscene flash: what the demonstration leaves (make firmware), with the effects that the scene\n"
      "states; scene: the baked scene's part of it, without the brick map and the light that bake adds\n"
      "where there is room. RAM: renderer, a band of " +
      std::to_string(kBoardBandRows) +
      " rows and the stack; to build it also the\npool. deepest: the deepest --depth that fits the flash" +
      (sizes.is_scalable ? "" : "; this scene has one depth only") +
      ".\na second: exact frames without light, where its brick map fits, too, within a fifth.\n\n";
  constexpr int kWantedFrames = 10;
  const BoardFacts* const board = smallest(sizes, kWantedFrames);
  text += board == nullptr
              ? std::string("no board is known to turn it at 10 frames a second\n")
              : std::string("the smallest board that turns it at 10 frames a second: ") + board->name + "\n";
  return text;
}

void run(const BoardsCommand& command) {
  const std::string& scene = command.scene.arguments.scene;
  ReportFiles files(command.files, scene);
  std::optional<SceneSizes> sizes;
  if (!scene.empty()) {
    sizes = measure(command);
  }
  files.write(objects_of(platform::boards(),
                         [&](const BoardFacts& board) { return row_of(board, sizes ? &*sizes : nullptr); }),
              {});
  files.print(boards_text() + (sizes ? scene_text(command, *sizes) : ""));
}

}  // namespace

void add_boards(CLI::App& app) {
  CLI::App* sub = add_command(
      app, "boards",
      "The boards and their limits; with a scene also what of it fits: its baked bytes against the flash, "
      "the RAM to draw it and to build it on the chip, the deepest --depth, and frames a second.");
  BoardsCommand* const command = options_for<BoardsCommand>(*sub, run);
  command->scene.add_scene(*sub, false);
  for (const char* name : {"--depth", "--as-voxels", "--z-up"}) {
    sub->get_option(name)->needs(sub->get_option("scene"));
  }
  add_path_option(
      *sub, "--csv", "FILE.csv", &command->files.csv,
      "a line a board: board, title, core, ram_bytes, flash_bytes, stack_bytes, screen, width_px, height_px, "
      "pixel_format, buttons, core_mhz, frame_instructions (the demonstration's), frames_per_second_estimate "
      "(at one instruction a cycle), scene_flash_bytes (flash less code), state_bytes, band_bytes, "
      "drawing_ram_bytes (state, band and stack); with a scene also depth, voxels, baked_bytes, fits_flash, "
      "pool_bytes, building_ram_bytes (those and the pool), builds_in_ram, deepest_depth (0: none tried), "
      "deepest_tried_depth, scene_frame_instructions (of an exact frame without light, within a fifth; 0 "
      "where "
      "scene and brick map do not fit), scene_frames_per_second_estimate");
  add_path_option(*sub, "--json", "FILE.json", &command->files.json, "the same, an array of objects");
  add_flag(*sub, "--quiet", &command->scene.quiet, "no progress bar");
}

}  // namespace thimble::tools
