#include "scene/scene_source.h"

#include <algorithm>
#include <bit>

#include "output/units.h"
#include "readers/read_any.h"
#include "readers/text.h"
#include "scene/generators.h"
#include "scene/named_scenes.h"
#include "scene/palette.h"
#include "scene/voxelise.h"
#include "scene/world_fit.h"
#include "thimble/light/scene.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

// What a source will stream, about: where nothing counts it, as much as solid scenes have.
std::uint64_t voxels_of(const SourceFacts& facts) {
  return facts.points != 0 ? facts.points : std::uint64_t{1} << (3 * facts.level - 3);
}

std::unique_ptr<SceneSource> generated_scene(const GeneratorSpec& spec) {
  constexpr std::array kNames{"points", "cluster", "spheres", "water", "demo"};  // by GeneratorKind
  const bool is_points = is_counted(spec.kind);
  SourceFacts facts;
  facts.kind = std::string("generator ") + kNames[static_cast<std::size_t>(spec.kind)];
  facts.level = spec.depth;
  facts.points = is_points ? spec.count : 0;
  facts.is_point_set = is_points;
  facts.single_material = is_points;
  facts.palette = generator_palette(spec.kind);
  facts.camera = generator_camera(spec);
  facts.lighting = generator_lighting(spec);
  return std::make_unique<SceneSource>(std::move(facts),
                                       [spec](const VoxelSink& sink) { generate(spec, sink); });
}

// The level of a world for voxels that lie where they lie: the smallest, or `depth` where that is enough.
int level_for(const std::array<std::int32_t, 3>& size, std::optional<int> depth) {
  const std::int32_t largest = std::max({size[0], size[1], size[2], 1});
  const int needed =
      std::max(kMinLevel, static_cast<int>(std::bit_width(static_cast<unsigned>(largest - 1))));
  fail_if(needed > kMaxLevel, "the scene is ", largest, " voxels long; the largest world has ",
          1 << kMaxLevel);
  const int level = depth.value_or(needed);
  fail_if(level < needed, "the scene is ", largest, " voxels long and needs --depth ", needed);
  return level;
}

std::unique_ptr<SceneSource> model_scene(std::unique_ptr<VoxelModel> read, std::optional<int> depth) {
  const std::shared_ptr<const VoxelModel> model = std::move(read);
  SourceFacts facts;
  facts.frames = model->frames();
  facts.kind = facts.frames == 1 ? "voxel model" : concat("voxel model of ", facts.frames, " frames");
  facts.extent = model->size();
  facts.level = level_for(*facts.extent, depth);
  model->for_each([&](auto, auto, auto, auto) { ++facts.points; });
  facts.is_scalable = false;
  facts.palette = model->palette();
  if (facts.frames > 1) {
    SourceFacts all = facts;
    all.points = 0;
    model->for_each_in_frames([&](auto, auto, auto, auto) { ++all.points; });
    facts.in_frames = std::make_shared<SceneSource>(
        std::move(all), [model](const VoxelSink& sink) { model->for_each_in_frames(sink); });
  }
  return std::make_unique<SceneSource>(std::move(facts),
                                       [model](const VoxelSink& sink) { model->for_each(sink); });
}

// Puts voxels together to cubes of 4 a side of one material, so that a solid grid is built in few steps. Voxels of one
// cube keep the order in which they came.
class CubeGather {
 public:
  explicit CubeGather(const VisitBlock& visit) : visit_(visit), cubes_(std::size_t{1} << kSlotBits) {}

  void add(std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
    const auto part = [](std::int32_t at) { return static_cast<std::uint32_t>(at) >> 2; };
    const std::uint32_t place = part(x) | part(y) << 10 | part(z) << 20;
    const std::uint64_t key = std::uint64_t{material} << 30 | place;
    Cube& cube = cubes_[place * 0x9E3779B1U >> (32 - kSlotBits)];
    if (cube.key != key) {
      pass_on(cube);
      cube = {key, 0};
    }
    cube.voxels |= std::uint64_t{1} << ((x & 3) | (y & 3) << 2 | (z & 3) << 4);
    if (cube.voxels == ~std::uint64_t{0}) {
      visit_({x & ~3, y & ~3, z & ~3}, 2, material);
      cube.voxels = 0;
    }
  }
  void end() const {
    for (const Cube& cube : cubes_) {
      pass_on(cube);
    }
  }

 private:
  static constexpr int kSlotBits = 18;
  struct Cube {
    std::uint64_t key = 0;     // the material and where it is, in cubes
    std::uint64_t voxels = 0;  // a bit each
  };

  void pass_on(const Cube& cube) const {
    const auto corner = [&](int axis) {
      return static_cast<std::int32_t>(cube.key >> 10 * axis & 1023) << 2;
    };
    for (std::uint64_t left = cube.voxels; left != 0; left &= left - 1) {
      const int bit = std::countr_zero(left);
      visit_({corner(0) | (bit & 3), corner(1) | (bit >> 2 & 3), corner(2) | bit >> 4}, 0,
             static_cast<std::uint8_t>(cube.key >> 30));
    }
  }

  const VisitBlock& visit_;
  std::vector<Cube> cubes_;
};

std::unique_ptr<SceneSource> grid_scene(std::unique_ptr<VoxelGrid> read, std::optional<int> depth) {
  const std::shared_ptr<const VoxelGrid> grid = std::move(read);
  SourceFacts facts;
  facts.is_landscape = grid->is_landscape();
  facts.kind = facts.is_landscape ? "heights, as a landscape a sixth as high as wide" : "voxel grid";
  ColorHistogram histogram;
  const bool has_color = grid->has_color();
  Rgb counted;  // its run is counted in one
  std::uint64_t times = 0;
  grid->for_each([&](auto, auto, auto, Rgb color) {
    check_grid_voxels(++facts.points);
    if (has_color && !(color == counted)) {
      histogram.add(counted, 0, times);
      counted = color;
      times = 0;
    }
    ++times;
  });
  if (has_color) {
    histogram.add(counted, 0, times);
  }
  const auto colors = std::make_shared<const PaletteMap>(histogram);
  facts.extent = grid->size();
  facts.level = level_for(*facts.extent, depth);
  facts.single_material = colors->colors() == 0;
  facts.is_scalable = false;
  facts.palette = colors->palette();
  facts.color_error = colors->error();
  const auto stream = [grid, colors](const VoxelSink& sink) {
    Rgb last;
    std::uint8_t material = colors->index(last);  // 0 of a grid without colours
    grid->for_each([&](std::int32_t x, std::int32_t y, std::int32_t z, Rgb color) {
      if (!(color == last)) {
        last = color;
        material = colors->index(color);
      }
      sink(x, y, z, material);
    });
  };
  return std::make_unique<SceneSource>(
      std::move(facts), stream, [stream](const VisitBlock& visit, const Progress& /*progress*/) {
        CubeGather cubes(visit);
        stream([&](auto x, auto y, auto z, auto m) { cubes.add(x, y, z, m); });
        cubes.end();
      });
}

std::unique_ptr<SceneSource> point_scene(std::unique_ptr<PointCloud> read, const SceneArguments& arguments) {
  constexpr int kDefaultDepth = 9;
  constexpr double kColumnSides = 16;  // a column so many times as high as wide is no place that was scanned
  // A cloud, what the first pass learned of it, and its colours.
  struct Points {
    Points(std::unique_ptr<PointCloud> read, const FitWishes* wishes)
        : cloud(std::move(read)), survey(survey_points(*cloud)), colors(survey.colors) {
      if (wishes != nullptr) {
        choose_world(*cloud, *wishes, &survey);
      }
    }
    std::unique_ptr<PointCloud> cloud;
    PointSurvey survey;
    PaletteMap colors;
  };
  const bool as_voxels = arguments.as_voxels;
  if (as_voxels && (arguments.fit_percent || arguments.clip)) {
    throw UsageError("--fit and --clip choose what fills the world, and --as-voxels leaves all as it is");
  }
  FitWishes wishes;
  wishes.percent = arguments.fit_percent.value_or(wishes.percent);
  if (arguments.clip) {
    const auto& [x0, y0, z0, x1, y1, z1] = *arguments.clip;
    wishes.clip = Bounds{{x0, y0, z0}, {x1, y1, z1}, false};
  }
  const auto points = std::make_shared<const Points>(std::move(read), as_voxels ? nullptr : &wishes);
  SourceFacts facts;
  facts.kind = as_voxels ? "points as voxels" : "point cloud, fitted to the world";
  facts.level =
      arguments.depth.value_or(as_voxels ? smallest_level(*points->cloud, points->survey) : kDefaultDepth);
  facts.points = points->survey.points;
  facts.is_point_set = true;
  facts.single_material = points->colors.colors() == 0;
  facts.is_scalable = !as_voxels;
  for (std::size_t axis = 0; as_voxels && axis < 3; ++axis) {
    const double high = std::clamp(points->survey.bounds.high[axis], 0.0, 4095.0);
    facts.extent = facts.extent.value_or(std::array<std::int32_t, 3>{});
    (*facts.extent)[axis] = static_cast<std::int32_t>(high) + 1;
  }
  facts.palette = points->colors.palette();
  facts.color_error = points->colors.error();
  const int level = facts.level;
  auto scene =
      std::make_unique<SceneSource>(std::move(facts), [points, as_voxels, level](const VoxelSink& sink) {
        if (as_voxels) {
          place_points(*points->cloud, level, &points->colors, sink);
        } else {
          fit_points(*points->cloud, points->survey, level, &points->colors, sink);
        }
      });
  const Bounds& world = points->survey.world;
  const auto extent_of = [&](std::size_t axis) { return world.high[axis] - world.low[axis]; };
  const double wide = std::max(extent_of(0), extent_of(1));
  if (!as_voxels && wide > 0 && extent_of(2) > kColumnSides * wide &&
      std::max(-world.low[0], world.high[0]) <= 180 && std::max(-world.low[1], world.high[1]) <= 90) {
    scene->add_notes({concat(printable(arguments.scene), ": it is ",
                             static_cast<long long>(std::min(extent_of(2) / wide, 1e9)),
                             " times as high as wide: x and y may be degrees, and z metres")});
  }
  if (points->survey.left_out != 0) {
    scene->add_notes(
        {concat(printable(arguments.scene), ": ", points->survey.left_out, " of ", points->survey.points,
                wishes.clip ? " points are outside of --clip and left out"
                            : " points are far from all others and left out; --fit 100 takes them")});
  }
  return scene;
}

std::unique_ptr<SceneSource> mesh_scene(TriangleMesh read, const SceneArguments& arguments) {
  const auto mesh = std::make_shared<const TriangleMesh>(std::move(read));
  const bool z_up = arguments.z_up || mesh->is_z_up;
  fail_if(mesh->triangles.empty(), "no triangles");
  SourceFacts facts;
  facts.kind = "triangle mesh, voxelised";
  facts.level = arguments.depth.value_or(arguments.mesh_depth);
  const auto colors = std::make_shared<const PaletteMap>(mesh_colors(*mesh, facts.level, z_up));
  facts.points = mesh->positions.size();
  facts.is_mesh = true;
  facts.is_z_up = z_up;
  facts.single_material = colors->colors() == 0;
  facts.palette = colors->palette();
  facts.color_error = colors->error();
  if (mesh->is_unlit) {
    facts.lighting = describe_unlit(facts.palette);
  }
  const int level = facts.level;
  return std::make_unique<SceneSource>(
      std::move(facts), [mesh, colors, level, z_up](const VisitBlock& visit, const Progress& progress) {
        const BlockSink sink = [&](const UnitPoint& voxel, int block_level, std::uint8_t material) {
          visit({voxel[0], voxel[1], voxel[2]}, block_level, material);
        };
        voxelise(*mesh, level, z_up, colors.get(), sink, progress);
      });
}

constexpr const char* kZUpIsForMeshes = "--z-up is for meshes";

std::unique_ptr<SceneSource> scene_of(Source source, const SceneArguments& arguments, SceneOpening* opening,
                                      const Progress& progress) {
  if (auto* cloud = std::get_if<std::unique_ptr<PointCloud>>(&source)) {
    fail_if(arguments.z_up, kZUpIsForMeshes);
    return point_scene(std::move(*cloud), arguments);
  }
  fail_if(arguments.as_voxels, "--as-voxels is for point files");
  fail_if(arguments.fit_percent || arguments.clip, "--fit and --clip are for point files");
  if (auto* mesh = std::get_if<TriangleMesh>(&source)) {
    return mesh_scene(std::move(*mesh), arguments);
  }
  fail_if(arguments.z_up, kZUpIsForMeshes);
  if (const auto* text = std::get_if<std::shared_ptr<const SceneText>>(&source)) {
    return open_text_scene(**text, arguments, opening, progress);
  }
  if (auto* grid = std::get_if<std::unique_ptr<VoxelGrid>>(&source)) {
    return grid_scene(std::move(*grid), arguments.depth);
  }
  if (auto* model = std::get_if<std::unique_ptr<VoxelModel>>(&source)) {
    return model_scene(std::move(*model), arguments.depth);
  }
  return baked_scene(std::move(std::get<BakedFile>(source)), arguments.depth);
}

}  // namespace

std::unique_ptr<SceneSource> baked_scene(BakedFile read, std::optional<int> depth) {
  const auto file = std::make_shared<const BakedFile>(std::move(read));
  const BakedScene& scene = file->scene;
  const CompactTree& tree = scene.tree();
  fail_if(depth && *depth != tree.level(), "was baked with depth ", tree.level(),
          "; --depth cannot change that");
  SourceFacts facts;
  facts.kind = "baked scene";
  facts.level = tree.level();
  facts.points = tree.voxel_count();
  facts.single_material = !tree.many_materials() && tree.uniform_material() == 0;
  facts.is_scalable = false;
  const Vec3i& high = tree.bounds().high;
  facts.extent = {high.x, high.y, high.z};
  Palette& palette = facts.palette;
  palette.fill(default_material());
  for (std::size_t i = 0; i < scene.palette().size; ++i) {
    const Rgb8 color = scene.palette()[i];
    palette[i].color = {color.r, color.g, color.b};
  }
  const Rgb plain = default_material().color;
  const Rgb first = palette[0].color;
  facts.has_colors = !facts.single_material || first.r != plain.r || first.g != plain.g || first.b != plain.b;
  BakedLighting lighting;
  if (BakedLighting::open(scene.section(SectionKind::kLighting), facts.level, &lighting) == Status::kOk) {
    facts.lighting = describe_baked(lighting, palette);
    for (std::size_t i = 0; i < lighting.scene.surfaces.size; ++i) {
      const Rgb color = palette[i].color;
      palette[i] = material_of(lighting.scene.surfaces[i]);
      palette[i].color = color;
    }
  }
  if (scene.has_camera()) {
    facts.camera = scene.camera();
  }
  facts.look_note = read_look_note(scene.section(SectionKind::kLook));
  facts.baked = file;
  return std::make_unique<SceneSource>(std::move(facts),
                                       [file](const VisitBlock& visit, const Progress& /*progress*/) {
                                         walk_blocks(file->scene.tree(), visit);
                                       });
}

SceneSource::SceneSource(SourceFacts facts, Stream stream, StreamBlocks blocks)
    : facts_(std::move(facts)), stream_(std::move(stream)), blocks_(std::move(blocks)) {}

void SceneSource::add_file(const std::string& path) {
  if (std::find(files_.begin(), files_.end(), path) == files_.end()) {
    files_.push_back(path);
  }
}

void SceneSource::add_notes(const Notes& notes) {
  for (const std::string& note : notes) {
    if (std::find(notes_.begin(), notes_.end(), note) == notes_.end()) {
      notes_.push_back(note);
    }
  }
}

std::array<std::int32_t, 3> SceneSource::extent() const {
  const std::int32_t side = std::int32_t{1} << facts_.level;
  return facts_.extent.value_or(std::array{side, side, side});
}

void SceneSource::stream(const VoxelSink& sink, const Progress& progress) const {
  if (!stream_) {
    stream_blocks(
        [&](const Vec3i& corner, int level, std::uint8_t material) {
          for_voxels(corner, level,
                     [&](std::int32_t x, std::int32_t y, std::int32_t z) { sink(x, y, z, material); });
        },
        progress);
    return;
  }
  ProgressMeter meter(progress, voxels_of(facts_));
  std::uint64_t done = 0;
  stream_([&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
    sink(x, y, z, material);
    meter.at(++done);
  });
}

void SceneSource::stream_blocks(const VisitBlock& visit, const Progress& progress) const {
  if (!blocks_) {
    stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
          visit({x, y, z}, 0, material);
        },
        progress);
    return;
  }
  ProgressMeter meter = facts_.is_mesh ? ProgressMeter() : ProgressMeter(progress, voxels_of(facts_));
  std::uint64_t done = 0;
  blocks_(
      [&](const Vec3i& corner, int level, std::uint8_t material) {
        visit(corner, level, material);
        meter.at(done += std::uint64_t{1} << (3 * level));
      },
      progress);
}

std::unique_ptr<SceneSource> open_scene(const SceneArguments& arguments, const Progress& progress) {
  SceneArguments found = arguments;
  if (!arguments.content && !parse_generator(arguments.scene)) {
    found.scene = scene_path(arguments.scene);
  }
  return open_scene(found, nullptr, progress);
}

std::unique_ptr<SceneSource> open_scene(const SceneArguments& arguments, SceneOpening* opening,
                                        const Progress& progress) {
  fail_if(arguments.depth && (*arguments.depth < kMinLevel || *arguments.depth > kMaxLevel),
          "--depth must be ", kMinLevel, " to ", kMaxLevel);
  if (auto spec = parse_generator(arguments.scene); spec && !arguments.content) {
    const auto refuse = [](bool is_given, const char* sentence) {
      if (is_given) {
        throw UsageError(sentence, ", and this is a generator");
      }
    };
    refuse(arguments.as_voxels, "--as-voxels is for point files");
    refuse(arguments.fit_percent || arguments.clip, "--fit and --clip are for point files");
    refuse(arguments.as_points || arguments.as_heights, "--as-points and --as-heights are for .npy and .npz");
    refuse(arguments.z_up, kZUpIsForMeshes);
    refuse(arguments.full_color != 0, "--colors is for files");
    refuse(arguments.frame.has_value(), "--frame and --frames are for .vox files with frames");
    if (arguments.depth) {
      spec->depth = *arguments.depth;
    }
    return generated_scene(*spec);
  }
  const ArrayAs as = arguments.as_heights  ? ArrayAs::kHeights
                     : arguments.as_points ? ArrayAs::kPoints
                                           : ArrayAs::kByShape;
  const ReadOptions options{arguments.scene, arguments.frame, as, arguments.full_color, opening != nullptr};
  Source source = arguments.content ? read_any(options, *arguments.content, progress)
                                    : read_scene_file(options, progress);
  Notes notes = notes_of(source);
  auto scene = scene_of(std::move(source), arguments, opening, progress);
  scene->add_file(arguments.scene);
  for (std::string& note : notes) {
    note.insert(0, printable(arguments.scene) + ": ");
  }
  scene->add_notes(notes);
  return scene;
}

}  // namespace thimble::tools
