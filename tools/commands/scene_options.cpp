#include "commands/scene_options.h"

#include <algorithm>
#include <cstdio>

#include "commands/arguments.h"
#include "output/progress.h"
#include "output/units.h"
#include "scene/board_fit.h"
#include "scene/built_scene.h"
#include "scene/scene_source.h"

namespace thimble::tools {

void SceneOptions::add_scene(CLI::App& app, bool required) {
  Option scene = add_argument(
      app, "scene", "SCENE", &arguments.scene,
      "a file (.vox .scene .oct .ply .obj .off .stl .glb .gltf .xyz .csv .txt .tsv .pts .pcd .las .npy "
      ".npz .asc .binvox .qb .kvx .schematic .schem .mts, a Gadget-1 snapshot, .gz of any) or a "
      "generator: points:N, cluster:N, spheres, water or demo, each with ,seed=S,depth=L; or the name "
      "of a scene that comes with Thimble, such as castle");
  if (required) {
    scene.required();
  }
  add_whole_option(
      app, "--depth", "L", kMinLevel, kMaxLevel,
      [this](std::int64_t level) { arguments.depth = static_cast<int>(level); },
      "the world is 2^L voxels a side, L from 1 to 12 (default: the least that holds a .vox, .scene or "
      "--as-voxels file, that of a baked scene, 9 for other files, 10 for points and cluster, 6 for the "
      "others)");
  add_flag(app, "--as-voxels", &arguments.as_voxels,
           "point files: coordinates are voxel indices; nothing is scaled, turned or moved");
  add_flag(app, "--as-points", &arguments.as_points,
           ".npy and .npz: an array of N x 3 to N x 9 numbers is points (which it is taken for), another an "
           "error");
  add_flag(app, "--as-heights", &arguments.as_heights,
           ".npy and .npz: an array of H x W numbers is heights at any W");
  add_flag(app, "--z-up", &arguments.z_up, "meshes: z is up in the file (default: y is, but in .stl)");
  add_whole_option(
      app, "--frame", "N", 0, UINT32_MAX - 1,
      [this](std::int64_t frame) { arguments.frame = static_cast<std::uint32_t>(frame); },
      "frame N of a .vox animation, counted from 0 (default: the first)");
}

void SceneOptions::add_report(CLI::App& app) {
  add_flag(app, "--quiet", &quiet, "no progress bar and no summary on standard error");
  add_path_option(app, "--stats", "FILE.json", &stats_path, "write counts, bytes and times as JSON");
}

void SceneOptions::add_to(CLI::App& app) {
  add_scene(app);
  add_bytes(app, "--memory", &memory_bytes,
            "the budget, such as 65536, 64K or 2M: one block of memory for all that lies between reader and "
            "display (default: as much as it takes)");
  add_board(app, &board,
            "keep to a board's RAM less its stack, as with --memory (the smaller of both counts); a baked "
            "scene lies in its flash and takes no RAM");
  add_flag(app, "--coarsen", &coarsen,
           "when the budget is short, merge blocks of voxels instead of failing; this only adds solid");
  add_choice_option(
      app, "--structure", {"dense", "pool", "compact"},
      [this](std::size_t index) { structure = static_cast<StructureKind>(index); },
      "what is built and traced: one bit a voxel, an octree that can be edited, or a compact one")
      .default_str("compact");
  add_report(app);
}

std::optional<std::uint64_t> SceneOptions::budget_bytes() const {
  if (board == nullptr) {
    return memory_bytes;
  }
  return std::min(free_ram_bytes(*board), memory_bytes.value_or(UINT64_MAX));
}

void add_bytes(CLI::App& app, const std::string& name, std::optional<std::uint64_t>* bytes,
               const std::string& help) {
  add_text_option(
      app, name, "BYTES",
      [bytes](const std::string& text) {
        *bytes = parse_bytes(text);
        return *bytes ? "" : "is not a number of bytes such as 65536, 64K or 2M";
      },
      help);
}

void add_board(CLI::App& app, const platform::BoardFacts** board, const std::string& help) {
  std::string names;
  std::vector<std::string> all;
  for (const platform::BoardFacts& each : platform::boards()) {
    names += (names.empty() ? "" : ", ") + std::string(each.name);
    all.emplace_back(each.name);
  }
  add_text_option(
      app, "--board", "NAME",
      [board, names](const std::string& text) {
        *board = platform::find_board(text.c_str());
        return *board != nullptr ? std::string() : "is not a board; there are " + names;
      },
      help + "; " + names)
      .offers(all);
}

std::unique_ptr<SceneSource> SceneOptions::open() const {
  std::unique_ptr<SceneSource> scene;
  {
    ProgressBar bar("reading", quiet);
    scene = open_scene(arguments, [&](double done) { bar.update(done); });
  }
  for (const std::string& note : quiet ? Notes() : scene->notes()) {
    std::fprintf(stderr, "note: %s\n", note.c_str());
  }
  return scene;
}

BuiltScene SceneOptions::build(const SceneSource& source, const DrawingBytes& drawing) const {
  BuildOptions options;
  options.structure = structure;
  options.memory_bytes = budget_bytes();
  if (board != nullptr) {
    if (!memory_bytes || *memory_bytes > free_ram_bytes(*board)) {
      options.budget_name = std::string(board->name) + "'s RAM less its stack";
    }
    options.baked_in_flash = true;
    const BakedScene* baked = source.baked();
    if (baked != nullptr && structure == StructureKind::kCompact &&
        baked->bytes().size > scene_flash_bytes(*board)) {
      throw InputError("takes " + grouped(baked->bytes().size) + " bytes, " + board->name + " has " +
                       grouped(scene_flash_bytes(*board)) + " bytes of flash for a scene");
    }
  }
  options.coarsen = coarsen;
  options.band_bytes = drawing.band;
  options.least_band_bytes = drawing.least_band;
  options.render_state_bytes = drawing.state;
  options.threads = build_threads;
  ProgressBar bar("building", quiet);
  return BuiltScene(source, options, [&](double done) { bar.update(done); });
}

BuiltScene SceneOptions::build(const SceneSource& source) const {
  return build(source, {});
}

}  // namespace thimble::tools
