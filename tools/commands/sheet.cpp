// thimble sheet: every scene of a folder on one picture, or on one page.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "commands/commands.h"
#include "commands/limited_picture.h"
#include "commands/render_command.h"
#include "host/canvas.h"
#include "output/plot.h"
#include "output/version.h"
#include "readers/read_any.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kMostTiles = 1024;
constexpr std::uint64_t kMemoryBytes = std::uint64_t{480} << 20;  // of all processes that draw
constexpr int kMostProcesses = 4;                                 // so that each has enough of it for a scene
constexpr int kSeconds = 10;                                      // for one scene
constexpr int kPollMicroseconds = 2000;
constexpr std::size_t kMostWaiting = 32;                       // pictures that are there, for an earlier one
constexpr std::size_t kMostSceneBytes = std::size_t{4} << 20;  // of one in a page

constexpr Rgb8 kSheet{32, 34, 38};
constexpr Rgb8 kNoPicture{48, 50, 56};  // where there is no picture
constexpr Rgb8 kCaption{206, 210, 216};
constexpr Rgb8 kFolder{130, 134, 142};
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

// By its name or its first bytes; what is packed, by its name.
bool is_scene_file(const std::filesystem::path& path) {
  std::array<char, kFirstLookBytes> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  return find_reader(path.string(), {first.data(), static_cast<std::size_t>(file.gcount())}) != nullptr;
}

// The scenes of the folder and of those in it, by name; nothing hidden, and no link to a folder.
std::vector<std::string> find_scenes(const std::string& folder) {
  namespace fs = std::filesystem;
  std::vector<std::string> names;
  std::error_code error;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && at != fs::recursive_directory_iterator(); at.increment(error)) {
    std::error_code gone;
    if (at->path().filename().string().starts_with('.')) {
      at.disable_recursion_pending();
    } else if (at->is_regular_file(gone) && is_scene_file(at->path())) {
      names.push_back(at->path().lexically_relative(folder).string());
    }
  }
  fail_if(static_cast<bool>(error), "cannot be listed: ", error.message());
  fail_if(names.empty(), "no file in it is a scene");
  fail_if(names.size() > kMostTiles, "holds ", grouped(names.size()), " scenes, and a sheet has room for ",
          grouped(kMostTiles), "; name a folder in it");
  std::sort(names.begin(), names.end());
  return names;
}

// A scene of the folder, and what came of it.
struct Tile {
  Tile(const std::string& name, SmallPicture drawn)
      : picture(std::move(drawn)), file(name.substr(name.rfind('/') + 1)) {
    folder = name.substr(0, std::max<std::size_t>(name.size() - file.size(), 1) - 1);
    count = picture.error.empty() ? counted(picture.voxels, "voxel") : "cannot be drawn";
  }

  SmallPicture picture;
  std::string file;
  std::string folder;  // in that folder; empty: in itself
  std::string count;   // of voxels
};

// Draws them all, several at a time, and hands each on, in their order. How many could not be drawn.
std::size_t draw_tiles(const SheetCommand& command, const std::vector<std::string>& names,
                       std::size_t scene_bytes, const std::function<void(const Tile&)>& hand_on) {
  ProgressBar bar("drawing", command.quiet);
  struct Work {
    std::unique_ptr<LimitedPicture> drawing{};
    std::size_t index = 0;
  };
  std::vector<Work> works(static_cast<std::size_t>(std::min(command.processes, kMostProcesses)));
  const PictureLimits limits{kSeconds, kMemoryBytes / works.size(), false, scene_bytes};
  std::vector<std::optional<SmallPicture>> drawn(names.size());
  std::size_t failed = 0;
  for (std::size_t next = 0, at = 0; at < names.size(); ::usleep(kPollMicroseconds)) {
    for (Work& work : works) {
      SmallPicture picture;
      if (work.drawing != nullptr && work.drawing->take(&picture)) {
        work.drawing.reset();
        drawn[work.index] = std::move(picture);
      }
      if (work.drawing == nullptr && next < std::min(names.size(), at + kMostWaiting)) {
        work.index = next++;
        work.drawing = std::make_unique<LimitedPicture>(command.folder + "/" + names[work.index],
                                                        command.side_px, limits);
      }
    }
    for (; at < names.size() && drawn[at]; ++at) {
      const Tile tile(names[at], std::move(*drawn[at]));
      drawn[at].reset();
      failed += tile.picture.error.empty() ? 0U : 1U;
      hand_on(tile);
    }
    bar.update(static_cast<double>(at) / static_cast<double>(names.size()));
  }
  return failed;
}

// The end of a name counts more than its beginning.
std::string cut_to(const std::string& text, std::size_t columns) {
  return text.size() <= columns ? text : "..." + text.substr(text.size() - columns + 3);
}

void draw_tile(const Tile& tile, std::int32_t side_px, std::int32_t x, std::int32_t y, host::Canvas* canvas) {
  const auto columns = static_cast<std::size_t>(side_px / host::kGlyphWidthPx);
  const std::uint8_t* rgb = tile.picture.image.pixels.data();
  host::Canvas why;  // at whose edges the sentence is cut off
  if (!tile.picture.error.empty()) {
    constexpr std::int32_t kMarginPx = 2 * host::kGlyphWidthPx;
    why.resize(side_px, side_px);
    why.fill(0, 0, side_px, side_px, kNoPicture);
    host::draw_text(&why, kMarginPx, kMarginPx, 1, kWarning,
                    host::folded(printable(tile.picture.error), columns - 4));
    rgb = reinterpret_cast<const std::uint8_t*>(why.pixels.data());
  }
  host::draw_picture(canvas, {x, y, side_px, side_px, 1}, {rgb, side_px, side_px}, {});
  const auto write = [&](int line, Rgb8 color, const std::string& text) {
    host::draw_text(canvas, x, y + side_px + 4 + line * host::kGlyphHeightPx, 1, color, text);
  };
  write(0, kCaption, cut_to(printable(tile.file), columns));
  write(1, kCaption, tile.count);
  write(2, kFolder, cut_to(printable(tile.folder), columns));
}

std::size_t write_sheet(const SheetCommand& command, const std::vector<std::string>& names,
                        OutputFile* file) {
  const auto count = static_cast<std::int32_t>(names.size());
  // A little wider than high, as tiles are a little higher than wide.
  const auto usual = static_cast<std::int32_t>(std::ceil(std::sqrt(1.5 * count)));
  const std::int32_t columns = std::min(count, command.columns == 0 ? usual : command.columns);
  const std::int32_t rows = (count + columns - 1) / columns;
  const std::int32_t across = command.side_px + kGapPx;
  const std::int32_t down = command.side_px + kCaptionPx + kGapPx;
  host::Canvas canvas;
  canvas.resize(columns * across + kGapPx, rows * down + kGapPx);
  canvas.fill(0, 0, canvas.width_px, canvas.height_px, kSheet);
  std::int32_t i = 0;
  const std::size_t failed = draw_tiles(command, names, 0, [&](const Tile& tile) {
    draw_tile(tile, command.side_px, kGapPx + i % columns * across, kGapPx + i / columns * down, &canvas);
    ++i;
  });
  const auto* const first = reinterpret_cast<const std::uint8_t*>(canvas.pixels.data());
  static_assert(sizeof(Rgb8) == 3);
  write_picture(
      file, command.output,
      {canvas.width_px, canvas.height_px, PixelFormat::kRgb888, {first, first + 3 * canvas.pixels.size()}});
  return failed;
}

// Of a page: what share.js of platform/web opens by a click.
std::string figure_of(const Tile& tile, const std::string& path) {
  const std::string name = xml_text(path);
  const bool opens = !tile.picture.scene.empty();
  std::string text = "<figure>";
  std::string shown = "<p>" + xml_text(tile.picture.error) + "</p>";
  if (tile.picture.error.empty()) {
    shown = "<img alt=\"" + name + "\" src=\"" + poster_url(tile.picture.image, kMostPosterBytes) + "\">";
  }
  if (opens) {
    text = "<figure data-name=\"" + name + "\" data-colors=\"" + edge_colors(tile.picture.image) + "\">";
    shown = "<a>" + shown + "</a>";
  }
  return text + shown + "<figcaption>" + xml_text(tile.file) + "<br>" + tile.count + "<br><small>" +
         xml_text(tile.folder) + "</small></figcaption>" + (opens ? scene_element(tile.picture.scene) : "") +
         "</figure>\n";
}

// A page whose pictures open as pages of one scene do.
std::size_t write_page(const SheetCommand& command, const std::vector<std::string>& names, OutputFile* file) {
  const auto [before, behind] = around_scenes(
      load_page(),
      {{"description", counted(names.size(), "scene") + ", ray traced by Thimble. Click one to turn it."},
       {"version", kVersionNumber},
       {"colors", "#202226, #202226"},
       {"turn", "0"},
       {"background", "0"},
       {"ground", "-1"},
       {"preview", "data:,"},
       {"title", xml_text(std::filesystem::canonical(command.folder).filename().string())}});
  file->write(before + "<main");
  if (command.columns != 0) {
    file->write(concat(" style=\"grid-template-columns: repeat(", command.columns, ", 1fr)\""));
  }
  file->write(">\n");
  std::size_t at = 0;
  const std::size_t failed = draw_tiles(command, names, kMostSceneBytes,
                                        [&](const Tile& tile) { file->write(figure_of(tile, names[at++])); });
  file->write("</main>\n<img id=\"poster\" alt=\"\" hidden>\n" + behind);
  return failed;
}

void run(const SheetCommand& command) {
  OutputSet outputs({command.output}, {});
  const std::vector<std::string> names = find_scenes(command.folder);
  const std::size_t failed = names_page(command.output) ? write_page(command, names, outputs[0])
                                                        : write_sheet(command, names, outputs[0]);
  outputs.commit();
  if (!command.quiet) {
    std::fprintf(stderr, "%s", counted(names.size(), "scene").c_str());
    std::fprintf(stderr, failed == 0 ? "\n" : ", %s of them could not be drawn\n", grouped(failed).c_str());
  }
}

}  // namespace

void add_sheet(CLI::App& app) {
  CLI::App* sub =
      add_command(app, "sheet",
                  "Draw every scene of a folder, and of the folders in it, on one picture, or on a page "
                  "whose pictures open and turn. What cannot be drawn is said on its tile.");
  SheetCommand* const command = options_for<SheetCommand>(*sub, run);
  sub->add_option("scene", command->folder, "the folder")->type_name("FOLDER")->required();
  add_output_option(
      *sub, "-o,--output", "FILE", &command->output,
      [](const std::string& path) {
        return names_page(path) || (path != "-" && image_kind(path).has_value());
      },
      std::string(kImageEndings) + ", or .html",
      std::string("the sheet, ") + kImageEndings +
          "; or .html, one file, whose scenes take 4 MiB each at most")
      ->required();
  add_whole_option(*sub, "--size", "N", 96, 1024, &command->side_px, "pixels a side of each picture");
  add_whole_option(*sub, "--columns", "N", 1, kMostTiles, &command->columns, "pictures in a row")
      ->default_str("a little more than there are rows");
  add_threads(*sub, &command->processes,
              "scenes drawn at once, 4 at most, each by a process of its own, which gets 10 s and its share "
              "of 480 MB");
  add_flag(*sub, "--quiet", &command->quiet, "no progress bar and no summary on standard error");
}

}  // namespace thimble::tools
