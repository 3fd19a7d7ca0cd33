#include "commands/scene_options.h"

#include <sstream>
#include <thread>

#include "commands/stats.h"
#include "scene/board_fit.h"
#include "scene/gpu_engine.h"
#include "wide/limits.h"

namespace thimble::tools {

void SceneOptions::add_scene(CLI::App& app, bool required) {
  app.add_option(
         "scene", arguments.scene,
         "a file (.vox .scene .oct .ply .obj .off .stl .glb .gltf .xyz .csv .txt .tsv .pts .pcd .las .laz "
         ".npy "
         ".npz .asc .binvox .qb .qbcl .kvx .kv6 .vxl .gox .schematic .schem .litematic .nbt .mts .bt .ot, a "
         "Gadget-1 snapshot, .gz .zst .xz of any, a .zip of one) or a generator: points:N, cluster:N, "
         "spheres, water "
         "or demo, each with ,seed=S,depth=L; or the name of a scene that comes with Thimble, such as castle")
      ->type_name("SCENE")
      ->required(required);
  add_whole_option(
      app, "--depth", "L", kMinLevel, kMaxLevel, &arguments.depth,
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
  app.get_option("--as-heights")->excludes(app.get_option("--as-points"));
  add_whole_option(
      app, "--colors", "FULL", 1, 65535, &arguments.full_color,
      "points, .obj, .ply and .off: what a full red, green or blue is in the file (default: 1 where none is "
      "above it, else 255, else 65535)");
  add_flag(app, "--z-up", &arguments.z_up, "meshes: z is up in the file (default: y is, but in .stl)");
  add_real_option(
      app, "--fit", "P", 50, 100, [this](double percent) { arguments.fit_percent = percent; },
      "point files: points far from P per cent of them are left out where the world would be eight times as "
      "long for them; 100 takes all (default: 99)");
  add_text_option(
      app, "--clip", "BOX",
      [this](const std::string& text) {
        std::array<double, 6> box{};
        const bool is_box =
            parse_reals(text, box) && box[0] <= box[3] && box[1] <= box[4] && box[2] <= box[5];
        arguments.clip = is_box ? std::optional(box) : std::nullopt;
        return is_box ? "" : "is not X,Y,Z,X,Y,Z, a box's low and high corner in the file's coordinates";
      },
      "point files: only the points of the box X,Y,Z,X,Y,Z, its low and high corner in the file's "
      "coordinates");
  add_whole_option(app, "--frame", "N", 0, UINT32_MAX - 1, &arguments.frame,
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
      app, "--structure",
      {{"dense", StructureKind::kDense},
       {"pool", StructureKind::kPool},
       {"compact", StructureKind::kCompact}},
      &structure,
      "what is built and traced: one bit a voxel, an octree that can be edited, or a compact one");
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

CLI::Option* add_board(CLI::App& app, const platform::BoardFacts** board, const std::string& help) {
  std::vector<std::string> all;
  for (const platform::BoardFacts& each : platform::boards()) {
    all.emplace_back(each.name);
  }
  const std::string names = joined(all, ", ");
  return add_text_option(
             app, "--board", "NAME",
             [board, names](const std::string& text) {
               *board = platform::find_board(text.c_str());
               return *board != nullptr ? std::string() : "is not a board; there are " + names;
             },
             help + "; " + names)
      ->check(offering(all));
}

std::unique_ptr<SceneSource> SceneOptions::open() const {
  auto scene = with_progress("reading", quiet,
                             [&](const Progress& progress) { return open_scene(arguments, progress); });
  print_notes(scene->notes(), quiet);
  return scene;
}

BuiltScene SceneOptions::build(const SceneSource& source, BuildOptions options) const {
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
      throw InputError("takes ", grouped(baked->bytes().size), " bytes, ", board->name, " has ",
                       grouped(scene_flash_bytes(*board)), " bytes of flash for a scene");
    }
  }
  options.coarsen = coarsen;
  options.threads = build_threads;
  return with_progress("building", quiet,
                       [&](const Progress& progress) { return BuiltScene(source, options, progress); });
}

namespace {

std::vector<std::string> offered() {
  std::vector<std::string> words{"auto", "none", "all"};
  const std::vector<std::string> names = effect_list(Effect::kAll);
  words.insert(words.end(), names.begin(), names.end());
  return words;
}

// What is wrong with `text`, if anything.
std::string take_effects(const std::string& text, EffectChoice* choice) {
  const auto parsed = parse_effects(text);
  const std::optional<bool> smooth = choice->smooth;
  *choice = parsed.value_or(EffectChoice{});
  choice->smooth = smooth;
  if (parsed) {
    return {};
  }
  std::string nearest;
  std::istringstream names(text);
  for (std::string name; nearest.empty() && std::getline(names, name, ',');) {
    nearest = parse_effects(name) ? "" : suggestion(name, offered());
  }
  return "is not auto, none, all or a list such as shadows,sky of " + effect_names() + nearest;
}

// Refuses what this build was made without.
void choose(const std::string& name, std::string* chosen) {
  refuse_if(name == "wide" && WideRenderer::instruction_sets().empty(),
            "--engine: \"wide\" is not in this build (-DTHIMBLE_WIDE=OFF); auto and ray64 are");
  refuse_if(name == "gpu" && !GpuEngine::is_in_build(),
            "--engine: \"gpu\" is not in this build (-DTHIMBLE_GPU=OFF); auto and ray64 are");
  *chosen = name;
}

// Draws, or traces: what the engine `does`.
void add_engine(CLI::App& app, std::string* name, const std::vector<std::string>& names, const char* does,
                const std::string& help) {
  add_choice_option(
      app, "--engine", names, [name, names](std::size_t index) { choose(names[index], name); }, help)
      ->default_str("auto");
  also_check(app, [&app, name, does] {
    const std::string structure = text_given(app, "--structure");
    refuse_if((*name == "wide" || *name == "gpu") && !structure.empty() && structure != "compact",
              "--engine ", *name, " ", does, " --structure compact only");
  });
}

}  // namespace

void add_effect_list(CLI::App& app, EffectChoice* choice, const std::string& help, const std::string& usual,
                     const std::string& value) {
  add_text_option(
      app, "--effects", value, [choice](const std::string& text) { return take_effects(text, choice); }, help)
      ->default_str(usual)
      ->check(offering(offered()));
  add_choice_option(
      app, "--normals", {{"auto", std::nullopt}, {"face", false}, {"smooth", true}}, &choice->smooth,
      "what light sees: the faces of the voxels, the slope of the surface (the effect smooth-normals), or "
      "what the effects say");
}

void add_effect_options(CLI::App& app, EffectWishes* wishes, const std::string& more,
                        const std::string& usual) {
  add_effect_list(
      app, &wishes->choice,
      "what light does: auto (what the scene's materials, lights, water and sky call for), none, all (that, "
      "light, shadows, occlusion, glow and smooth normals), or with commas between them any of " +
          joined(effect_list(Effect::kAll), ", ") + more,
      usual, "auto|none|all|LIST");
  add_whole_option(app, "--bounces", "N", 0, kMaxBounces, &wishes->bounces,
                   concat("rays that follow one another from a pixel by mirrors, glass and water, 0 to ",
                          kMaxBounces, " (default: the scene's own, else ", kDefaultBounces, ")"));
}

int all_cores() {
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, wide::kMaxThreads);
}

void add_threads(CLI::App& app, int* threads, const std::string& help) {
  *threads = all_cores();
  add_whole_option(app, "--threads", "N", 1, wide::kMaxThreads, threads, help)->default_str("all cores");
}

void EngineOptions::add_to(CLI::App& app, bool all_cores) {
  add_engine(
      app, &name, {"auto", "wide", "gpu", "ray64", "ray32"}, "draws",
      "wide: object order, with vectors and threads, for --structure compact where there is room; gpu: the "
      "best Vulkan device, without glass, water and mirrors, for --structure compact, without --memory and "
      "--board; ray64, "
      "ray32: ray by ray with products of that width; the answers are the same, but ray32 refuses rays that "
      "need more; auto: wide where it can be, but not with --board, else ray64");
  threads = all_cores ? tools::all_cores() : 1;
  add_whole_option(app, "--threads", "N", 1, wide::kMaxThreads, &threads,
                   "threads that build, and that draw with the wide engine or with effects")
      ->default_str(all_cores ? "all cores; 1 with --memory or --board, whose bytes they count in" : "1");
  also_check(app, [this, &app] { threads_given = is_given(app, "--threads"); });
}

void EngineOptions::add_ray_engines_to(CLI::App& app) {
  add_engine(
      app, &name, {"auto", "gpu", "ray64", "ray32"}, "traces",
      "gpu: the best Vulkan device, for --structure compact, without --memory and --board (then nodes are "
      "its steps); ray64, ray32: products of that width; the answers are the same, but ray32 refuses rays "
      "that need more; auto: with vectors from 100,000 rays on, where there is room and not with --board "
      "(then nodes are its steps, else those of the tree), else ray64");
}

std::unique_ptr<GpuEngine> EngineOptions::gpu(const BuiltScene& built, EffectSet effects) const {
  const EffectSet missing = effects & ~GpuEngine::effects();
  refuse_if(name == "gpu" && missing != Effect::kNone, "--engine gpu does not draw the effects ",
            effects_text(missing), "; --engine auto does");
  const Span<const Rgb8> palette(built.palette().data(), built.palette().size());
  return name == "gpu" ? GpuEngine::make(built.compact(), palette, threads) : nullptr;
}

void EngineOptions::check(bool is_plain, bool is_lit, bool at_edges) const {
  const bool draws_plain = name == "wide" || (name == "gpu" && !is_lit);
  refuse_if(draws_plain && !is_plain, "--engine ", name,
            " draws one sample a pixel at full depth, without --samples, --cutoff and --max-depth");
  refuse_if(name == "wide" && is_lit, "--engine wide draws without --effects and --bounces");
  refuse_if(name == "gpu" && at_edges,
            "--engine gpu draws the same samples for all pixels, without --samples auto");
}

void EngineOptions::check_budget(bool has_budget) const {
  refuse_if(name == "gpu" && has_budget,
            "--engine gpu keeps the scene in the GPU's memory, without --memory and --board");
}

std::unique_ptr<WideRenderer> EngineOptions::wide_renderer(BuiltScene* built, std::int32_t width_px,
                                                           std::int32_t height_px) const {
  if (name != "wide" && (name != "auto" || built->draws_from_file())) {
    return nullptr;
  }
  const bool is_compact = built->structure() == StructureKind::kCompact;
  auto renderer = is_compact
                      ? WideRenderer::make(built->compact(), &built->arena(), width_px, height_px, threads)
                      : nullptr;
  if (renderer == nullptr && name == "wide") {
    fail_if(!is_compact, "--engine wide draws --structure compact only");
    const std::int32_t least_rows = std::min(height_px, WideRenderer::kLeastRows);
    throw InputError("no room for --engine wide within --memory: it takes about ",
                     grouped(WideRenderer::bytes(built->compact(), width_px, least_rows, 1)),
                     " bytes beside the rest, and ", grouped(built->arena().free_bytes()), " are left");
  }
  return renderer;
}

std::unique_ptr<LitStreams> EngineOptions::lit_streams(BuiltScene* built, EffectSet effects,
                                                       const LitScene& scene) const {
  if (name == "gpu") {
    return gpu(*built, effects);
  }
  return name == "auto" && !built->draws_from_file()
             ? LitStreams::make(built->compact(), &built->arena(), effects, scene, threads)
             : nullptr;
}

int EngineOptions::lit_threads(BuiltScene* built, EffectSet effects) const {
  const std::size_t more = built->arena().free_bytes() / lit_render_bytes(effects);
  return static_cast<int>(std::min(static_cast<std::size_t>(threads), 1 + more));
}

void EngineOptions::add_board_engines_to(CLI::App& app) {
  add_engine(
      app, &name, {"auto", "wide", "ray64"}, "draws",
      "what draws demo's frames without light; the pictures are the same. wide: object order, with vectors "
      "and threads, in memory of this machine's own, and the first frame by the core too, for the stack, and "
      "compared; ray64: the core, as on the board (by bricks where the scene has a brick map); auto: wide "
      "where it can be, else ray64. Frames with light, those thinned or refined to hold a rate, and other "
      "applications are always the core's");
  add_threads(app, &threads, "threads that draw with the wide engine");
}

void EngineOptions::add_view_engines_to(CLI::App& app) {
  add_engine(
      app, &name, {"auto", "gpu", "wide"}, "draws",
      "what draws the scene's own look. gpu: the best Vulkan device, on which the scene stays; wide: this "
      "machine's processors; auto: a GPU, where there is one, it draws what the scene calls for and its "
      "first picture is the core's, else wide; the pictures are the same");
}

TraceOptions EngineOptions::trace_options() const {
  TraceOptions options;
  options.width = name == "ray32" ? Width::k32 : Width::k64;
  return options;
}

}  // namespace thimble::tools
