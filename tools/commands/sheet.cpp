// thimble sheet: every scene of a folder on one picture.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "commands/arguments.h"
#include "commands/commands.h"
#include "commands/limited_picture.h"
#include "commands/scene_options.h"
#include "host/canvas.h"
#include "output/output_set.h"
#include "output/progress.h"
#include "output/units.h"
#include "readers/file_bytes.h"
#include "readers/read_any.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kMostTiles = 1024;
constexpr std::uint64_t kMemoryBytes = std::uint64_t{480} << 20;  // of all processes that draw
constexpr int kMostProcesses = 4;                                 // so that each has enough of it for a scene
constexpr int kSeconds = 10;                                      // for one scene
constexpr int kPollMicroseconds = 2000;

constexpr Rgb8 kSheet{32, 34, 38};
constexpr Rgb8 kNoPicture{48, 50, 56};  // where there is no picture
constexpr Rgb8 kCaption{206, 210, 216};
constexpr Rgb8 kWarning{240, 160, 112};
constexpr std::int32_t kGapPx = 12;
constexpr std::int32_t kCaptionPx = 3 * host::kGlyphHeightPx + 8;

struct SheetCommand {
  std::string folder;
  std::string output;
  std::int32_t side_px = 240;
  std::int32_t columns = 0;  ///< 0: by the number of scenes
  int processes = 1;
  bool quiet = false;
};

struct Tile {
  std::string name;  ///< in the folder
  SmallPicture picture{};
};

// By its name or its first bytes; what is packed, by its name.
bool is_scene_file(const std::filesystem::path& path) {
  std::array<char, kFirstLookBytes> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(first.data());
  return find_reader(path.string(), {bytes, static_cast<std::size_t>(file.gcount())}) != nullptr;
}

// The scenes of the folder and of those in it, by name; nothing hidden, and no link to a folder.
std::vector<Tile> find_scenes(const std::string& folder) {
  namespace fs = std::filesystem;
  std::vector<Tile> tiles;
  std::error_code error;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && at != fs::recursive_directory_iterator(); at.increment(error)) {
    std::error_code gone;
    if (at->path().filename().string().starts_with('.')) {
      at.disable_recursion_pending();
    } else if (at->is_regular_file(gone) && is_scene_file(at->path())) {
      tiles.push_back({at->path().lexically_relative(folder).string()});
    }
  }
  if (error) {
    throw InputError("cannot be listed: " + error.message());
  }
  if (tiles.empty()) {
    throw InputError("no file in it is a scene");
  }
  if (tiles.size() > kMostTiles) {
    throw InputError("holds " + grouped(tiles.size()) + " scenes, and a sheet has room for " +
                     grouped(kMostTiles) + "; name a folder in it");
  }
  std::sort(tiles.begin(), tiles.end(), [](const Tile& a, const Tile& b) { return a.name < b.name; });
  return tiles;
}

// Draws them all, several at a time.
void draw_tiles(const SheetCommand& command, std::vector<Tile>* tiles) {
  ProgressBar bar("drawing", command.quiet);
  struct Work {
    std::unique_ptr<LimitedPicture> drawing{};
    Tile* tile = nullptr;
  };
  std::vector<Work> works(static_cast<std::size_t>(std::min(command.processes, kMostProcesses)));
  const PictureLimits limits{kSeconds, kMemoryBytes / works.size()};
  std::size_t next = 0;
  for (std::size_t done = 0; done < tiles->size(); ::usleep(kPollMicroseconds)) {
    for (Work& work : works) {
      if (work.drawing != nullptr && work.drawing->take(&work.tile->picture)) {
        work.drawing.reset();
        ++done;
      }
      if (work.drawing == nullptr && next < tiles->size()) {
        work.tile = &(*tiles)[next++];
        work.drawing =
            std::make_unique<LimitedPicture>(command.folder + "/" + work.tile->name, command.side_px, limits);
      }
    }
    bar.update(static_cast<double>(done) / static_cast<double>(tiles->size()));
  }
}

// The end of a name counts more than its beginning.
std::string cut_to(const std::string& text, std::size_t columns) {
  return text.size() <= columns ? text : "..." + text.substr(text.size() - columns + 3);
}

void draw_tile(const Tile& tile, std::int32_t side_px, std::int32_t x, std::int32_t y, host::Canvas* canvas) {
  const auto columns = static_cast<std::size_t>(side_px / host::kGlyphWidthPx);
  const SmallPicture& picture = tile.picture;
  if (picture.error.empty()) {
    const std::uint8_t* pixel = picture.image.pixels.data();
    for (std::int32_t row = 0; row < side_px; ++row) {
      for (std::int32_t column = 0; column < side_px; ++column, pixel += 3) {
        canvas->row(y + row)[x + column] = {pixel[0], pixel[1], pixel[2]};
      }
    }
  } else {
    constexpr std::int32_t kMarginPx = 2 * host::kGlyphWidthPx;
    canvas->fill(x, y, side_px, side_px, kNoPicture);
    std::string why = host::folded(printable(picture.error), columns - 4);
    const auto most_lines = static_cast<std::size_t>((side_px - 2 * kMarginPx) / host::kGlyphHeightPx);
    for (std::size_t line = 0, end = 0; line < most_lines && end != std::string::npos; ++line) {
      end = why.find('\n', line == 0 ? 0 : end + 1);
      if (line + 1 == most_lines && end != std::string::npos) {
        why.resize(end);
      }
    }
    host::draw_text(canvas, x + kMarginPx, y + kMarginPx, 1, kWarning, why);
  }
  const std::int32_t below = y + side_px + 4;
  const std::size_t slash = tile.name.rfind('/');
  const std::string file = printable(slash == std::string::npos ? tile.name : tile.name.substr(slash + 1));
  host::draw_text(canvas, x, below, 1, kCaption, cut_to(file, columns));
  host::draw_text(canvas, x, below + host::kGlyphHeightPx, 1, kCaption,
                  !picture.error.empty() ? "cannot be drawn"
                  : picture.voxels == 1  ? "1 voxel"
                                         : grouped(picture.voxels) + " voxels");
  if (slash != std::string::npos) {
    host::draw_text(canvas, x, below + 2 * host::kGlyphHeightPx, 1, {130, 134, 142},
                    cut_to(printable(tile.name.substr(0, slash)), columns));
  }
}

Image sheet_of(const SheetCommand& command, const std::vector<Tile>& tiles) {
  const auto count = static_cast<std::int32_t>(tiles.size());
  // A little wider than high, as tiles are a little higher than wide.
  const auto usual = static_cast<std::int32_t>(std::ceil(std::sqrt(1.5 * count)));
  const std::int32_t columns = std::min(count, command.columns == 0 ? usual : command.columns);
  const std::int32_t rows = (count + columns - 1) / columns;
  const std::int32_t across = command.side_px + kGapPx;
  const std::int32_t down = command.side_px + kCaptionPx + kGapPx;
  host::Canvas canvas;
  canvas.resize(columns * across + kGapPx, rows * down + kGapPx);
  canvas.fill(0, 0, canvas.width_px, canvas.height_px, kSheet);
  for (std::int32_t i = 0; i < count; ++i) {
    draw_tile(tiles[static_cast<std::size_t>(i)], command.side_px, kGapPx + i % columns * across,
              kGapPx + i / columns * down, &canvas);
  }
  const auto* const first = reinterpret_cast<const std::uint8_t*>(canvas.pixels.data());
  static_assert(sizeof(Rgb8) == 3);
  return {canvas.width_px, canvas.height_px, PixelFormat::kRgb888, {first, first + 3 * canvas.pixels.size()}};
}

void run(const SheetCommand& command) {
  OutputSet outputs({command.output}, {});
  std::vector<Tile> tiles = find_scenes(command.folder);
  draw_tiles(command, &tiles);
  write_picture(outputs[0], command.output, sheet_of(command, tiles));
  outputs.commit();
  if (!command.quiet) {
    const auto failed = std::count_if(tiles.begin(), tiles.end(),
                                      [](const Tile& tile) { return !tile.picture.error.empty(); });
    std::fprintf(stderr, "%s %s", grouped(tiles.size()).c_str(), tiles.size() == 1 ? "scene" : "scenes");
    std::fprintf(stderr, failed == 0 ? "\n" : ", %s of them could not be drawn\n",
                 grouped(static_cast<std::uint64_t>(failed)).c_str());
  }
}

}  // namespace

void add_sheet(CLI::App& app) {
  auto command = std::make_shared<SheetCommand>();
  CLI::App* sub = add_command(app, "sheet",
                              "Draw every scene of a folder, and of the folders in it, on one picture. What "
                              "cannot be drawn is said on its tile.");
  sub->add_option("scene", command->folder, "the folder")->type_name("FOLDER")->required();
  add_output_option(
      *sub, "-o,--output", "FILE", &command->output,
      [](const std::string& path) { return path != "-" && image_kind(path).has_value(); }, kImageEndings,
      std::string("the sheet, ") + kImageEndings)
      ->required();
  add_whole_option(*sub, "--size", "N", 96, 1024, &command->side_px, "pixels a side of each picture")
      ->default_str("240");
  add_whole_option(*sub, "--columns", "N", 1, kMostTiles, &command->columns, "pictures in a row")
      ->default_str("a little more than there are rows");
  add_threads(*sub, &command->processes,
              "scenes drawn at once, 4 at most, each by a process of its own, which gets 10 s and its share "
              "of 480 MB");
  add_flag(*sub, "--quiet", &command->quiet, "no progress bar and no summary on standard error");
  when_chosen(*sub, [command] { run(*command); });
}

}  // namespace thimble::tools
