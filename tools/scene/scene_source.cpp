#include "scene/scene_source.h"

#include <algorithm>
#include <utility>

#include "output/units.h"
#include "readers/oct.h"
#include "readers/read_any.h"
#include "scene/generators.h"
#include "scene/named_scenes.h"
#include "scene/palette.h"
#include "scene/voxelise.h"
#include "scene/world_fit.h"
#include "thimble/light/scene.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

// Calls `progress` once every so many voxels with the part done.
class Meter {
 public:
  Meter(const Progress& progress, std::uint64_t total) : progress_(progress), total_(total) {}
  void step() {
    constexpr std::uint64_t kEvery = 1 << 16;
    if (++done_ % kEvery == 0 && progress_ && total_ != 0) {
      progress_(std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_)));
    }
  }

 private:
  const Progress& progress_;
  std::uint64_t total_;
  std::uint64_t done_ = 0;
};

void check_depth(int depth) {
  if (depth < kMinLevel || depth > kMaxLevel) {
    throw InputError("--depth must be " + std::to_string(kMinLevel) + " to " + std::to_string(kMaxLevel));
  }
}

class GeneratedScene final : public SceneSource {
 public:
  explicit GeneratedScene(const GeneratorSpec& spec)
      : spec_(spec), palette_(generator_palette(spec.kind)), camera_(generator_camera(spec)) {
    level_ = spec.depth;
  }
  std::string kind() const override {
    constexpr std::array kNames{"points", "cluster", "spheres", "water", "demo"};  // by GeneratorKind
    return std::string("generator ") + kNames[static_cast<std::size_t>(spec_.kind)];
  }
  std::uint64_t points() const override { return is_point_set() ? spec_.count : 0; }
  bool is_point_set() const override {
    return spec_.kind == GeneratorKind::kPoints || spec_.kind == GeneratorKind::kCluster;
  }
  bool single_material() const override { return is_point_set(); }
  const Palette& palette() const override { return palette_; }
  const SceneCamera* camera() const override { return camera_ ? &*camera_ : nullptr; }
  LitDescription lighting() const override { return generator_lighting(spec_); }
  void stream(const VoxelSink& sink, const Progress& progress) const override {
    Meter meter(progress, is_point_set() ? spec_.count : std::uint64_t{1} << (3 * spec_.depth - 3));
    generate(spec_, [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
      sink(x, y, z, material);
      meter.step();
    });
  }

 private:
  GeneratorSpec spec_;
  Palette palette_;
  std::optional<SceneCamera> camera_;
};

// The level of a world for voxels that lie where they lie: the smallest, or `depth` where that is enough.
int level_for(const std::array<std::int32_t, 3>& size, std::optional<int> depth) {
  const std::int32_t largest = std::max({size[0], size[1], size[2]});
  int needed = kMinLevel;
  while (needed <= kMaxLevel && (std::int32_t{1} << needed) < largest) {
    ++needed;
  }
  if (needed > kMaxLevel) {
    throw InputError("the scene is " + std::to_string(largest) + " voxels long; the largest world has " +
                     std::to_string(1 << kMaxLevel));
  }
  const int level = depth.value_or(needed);
  if (level < needed) {
    throw InputError("the scene is " + std::to_string(largest) + " voxels long and needs --depth " +
                     std::to_string(needed));
  }
  return level;
}

class VoxelModelScene final : public SceneSource {
 public:
  VoxelModelScene(std::unique_ptr<VoxelModel> model, std::optional<int> depth) : model_(std::move(model)) {
    level_ = level_for(model_->size(), depth);
    model_->for_each([&](auto, auto, auto, auto) { ++voxels_; });
  }
  std::string kind() const override {
    return model_->frames() == 1 ? "voxel model"
                                 : "voxel model of " + std::to_string(model_->frames()) + " frames";
  }
  std::uint64_t points() const override { return voxels_; }
  bool is_point_set() const override { return false; }
  bool single_material() const override { return false; }
  bool is_scalable() const override { return false; }
  std::array<std::int32_t, 3> extent() const override { return model_->size(); }
  const Palette& palette() const override { return model_->palette(); }
  std::uint32_t frames() const override { return model_->frames(); }
  void stream(const VoxelSink& sink, const Progress& progress) const override {
    Meter meter(progress, voxels_);
    model_->for_each([&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
      sink(x, y, z, material);
      meter.step();
    });
  }

 private:
  std::unique_ptr<VoxelModel> model_;
  std::uint64_t voxels_ = 0;
};

class VoxelGridScene final : public SceneSource {
 public:
  VoxelGridScene(std::unique_ptr<VoxelGrid> grid, std::optional<int> depth)
      : grid_(std::move(grid)), colors_(histogram()) {
    level_ = level_for(grid_->size(), depth);
  }
  std::string kind() const override { return "voxel grid"; }
  std::uint64_t points() const override { return voxels_; }
  bool is_point_set() const override { return false; }
  bool single_material() const override { return colors_.colors() == 0; }
  bool is_scalable() const override { return false; }
  std::array<std::int32_t, 3> extent() const override { return grid_->size(); }
  const Palette& palette() const override { return colors_.palette(); }
  void stream(const VoxelSink& sink, const Progress& progress) const override {
    Meter meter(progress, voxels_);
    const bool has_color = grid_->has_color();
    grid_->for_each([&](std::int32_t x, std::int32_t y, std::int32_t z, Rgb color) {
      sink(x, y, z, has_color ? colors_.index(color) : std::uint8_t{0});
      meter.step();
    });
  }

 private:
  ColorHistogram histogram() {
    ColorHistogram colors;
    const bool has_color = grid_->has_color();
    grid_->for_each([&](auto, auto, auto, Rgb color) {
      ++voxels_;
      if (has_color) {
        colors.add(color);
      }
    });
    return colors;
  }

  std::unique_ptr<VoxelGrid> grid_;
  std::uint64_t voxels_ = 0;
  PaletteMap colors_;
};

class PointScene final : public SceneSource {
 public:
  PointScene(std::unique_ptr<PointCloud> cloud, const SceneArguments& arguments)
      : cloud_(std::move(cloud)),
        survey_(survey_points(*cloud_)),
        colors_(survey_.colors),
        as_voxels_(arguments.as_voxels) {
    constexpr int kDefaultDepth = 9;
    level_ = arguments.depth.value_or(as_voxels_ ? smallest_level(survey_) : kDefaultDepth);
  }
  std::string kind() const override {
    return as_voxels_ ? "points as voxels" : "point cloud, fitted to the world";
  }
  std::uint64_t points() const override { return survey_.points; }
  bool is_point_set() const override { return true; }
  bool single_material() const override { return colors_.colors() == 0; }
  bool is_scalable() const override { return !as_voxels_; }
  std::array<std::int32_t, 3> extent() const override {
    if (!as_voxels_) {
      return SceneSource::extent();
    }
    std::array<std::int32_t, 3> result{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      result[axis] = static_cast<std::int32_t>(std::clamp(survey_.bounds.high[axis], 0.0, 4095.0)) + 1;
    }
    return result;
  }
  const Palette& palette() const override { return colors_.palette(); }
  void stream(const VoxelSink& sink, const Progress& progress) const override {
    Meter meter(progress, survey_.points);
    const VoxelSink counted = [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
      sink(x, y, z, material);
      meter.step();
    };
    if (as_voxels_) {
      place_points(*cloud_, level_, &colors_, counted);
    } else {
      fit_points(*cloud_, survey_, level_, &colors_, counted);
    }
  }

 private:
  std::unique_ptr<PointCloud> cloud_;
  PointSurvey survey_;
  PaletteMap colors_;
  bool as_voxels_;
};

class MeshScene final : public SceneSource {
 public:
  MeshScene(TriangleMesh mesh, const SceneArguments& arguments)
      : mesh_(std::move(mesh)), colors_(triangle_colors(mesh_)), z_up_(arguments.z_up || mesh_.is_z_up) {
    constexpr int kDefaultDepth = 9;
    level_ = arguments.depth.value_or(kDefaultDepth);
    if (mesh_.triangles.empty()) {
      throw InputError("no triangles");
    }
  }
  std::string kind() const override { return "triangle mesh, voxelised"; }
  bool is_mesh() const override { return true; }
  std::uint64_t points() const override { return mesh_.positions.size(); }
  bool is_point_set() const override { return false; }
  bool single_material() const override { return colors_.colors() == 0; }
  const Palette& palette() const override { return colors_.palette(); }
  void stream(const VoxelSink& sink, const Progress& progress) const override {
    voxelise(mesh_, level_, z_up_, &colors_, sink, progress);
  }
  void stream_blocks(const VisitBlock& visit, const Progress& progress) const override {
    const BlockSink sink = [&](const UnitPoint& voxel, int level, std::uint8_t material) {
      visit({voxel[0], voxel[1], voxel[2]}, level, material);
    };
    voxelise(mesh_, level_, z_up_, &colors_, sink, progress);
  }

 private:
  TriangleMesh mesh_;
  PaletteMap colors_;
  bool z_up_;
};

class BakedFileScene final : public SceneSource {
 public:
  BakedFileScene(BakedFile file, std::optional<int> depth) : file_(std::move(file)) {
    level_ = tree().level();
    if (depth && *depth != level_) {
      throw InputError("was baked with depth " + std::to_string(level_) + "; --depth cannot change that");
    }
    palette_.fill(default_material());
    for (std::size_t i = 0; i < file_.scene.palette().size; ++i) {
      const Rgb8 color = file_.scene.palette()[i];
      palette_[i].color = {color.r, color.g, color.b};
    }
    BakedLighting lighting;
    if (BakedLighting::open(file_.scene.section(SectionKind::kLighting), level_, &lighting) != Status::kOk) {
      return;  // baked without
    }
    lit_ = describe_baked(lighting, palette_);
    for (std::size_t i = 0; i < lighting.scene.surfaces.size; ++i) {
      const Rgb color = palette_[i].color;
      palette_[i] = material_of(lighting.scene.surfaces[i]);
      palette_[i].color = color;
    }
  }
  std::string kind() const override { return "baked scene"; }
  std::uint64_t points() const override { return tree().voxel_count(); }
  bool is_point_set() const override { return false; }
  bool single_material() const override { return !tree().many_materials() && tree().uniform_material() == 0; }
  bool has_colors() const override {
    const Rgb plain = default_material().color;
    const Rgb first = palette_[0].color;
    return !single_material() || first.r != plain.r || first.g != plain.g || first.b != plain.b;
  }
  bool is_scalable() const override { return false; }
  const SceneCamera* camera() const override {
    return file_.scene.has_camera() ? &file_.scene.camera() : nullptr;
  }
  LitDescription lighting() const override { return lit_ ? *lit_ : describe_palette(palette_); }
  const BakedScene* baked() const override { return &file_.scene; }
  std::optional<LookNote> look_note() const override {
    return read_look_note(file_.scene.section(SectionKind::kLook));
  }
  std::array<std::int32_t, 3> extent() const override {
    const Vec3i& max = tree().bounds().high;
    return {max.x, max.y, max.z};
  }
  const Palette& palette() const override { return palette_; }
  void stream(const VoxelSink& sink, const Progress& progress) const override {
    Meter meter(progress, tree().voxel_count());
    for_each_block(tree(), [&](const Vec3i& corner, int level, std::uint8_t material) {
      for_voxels(corner, level, [&](std::int32_t x, std::int32_t y, std::int32_t z) {
        sink(x, y, z, material);
        meter.step();
      });
    });
  }

 private:
  const CompactTree& tree() const { return file_.scene.tree(); }

  BakedFile file_;
  Palette palette_;
  std::optional<LitDescription> lit_;
};

std::unique_ptr<SceneSource> scene_of(Source source, const SceneArguments& arguments, SceneOpening* opening,
                                      const Progress& progress) {
  if (auto* cloud = std::get_if<std::unique_ptr<PointCloud>>(&source)) {
    return std::make_unique<PointScene>(std::move(*cloud), arguments);
  }
  if (arguments.as_voxels) {
    throw InputError("--as-voxels is for point files");
  }
  if (const auto* text = std::get_if<std::shared_ptr<const SceneText>>(&source)) {
    return open_text_scene(**text, arguments, opening, progress);
  }
  if (auto* grid = std::get_if<std::unique_ptr<VoxelGrid>>(&source)) {
    return std::make_unique<VoxelGridScene>(std::move(*grid), arguments.depth);
  }
  if (auto* model = std::get_if<std::unique_ptr<VoxelModel>>(&source)) {
    return std::make_unique<VoxelModelScene>(std::move(*model), arguments.depth);
  }
  if (auto* baked = std::get_if<BakedFile>(&source)) {
    return std::make_unique<BakedFileScene>(std::move(*baked), arguments.depth);
  }
  return std::make_unique<MeshScene>(std::move(std::get<TriangleMesh>(source)), arguments);
}

}  // namespace

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
  const std::int32_t side = std::int32_t{1} << level_;
  return {side, side, side};
}

void SceneSource::stream_blocks(const VisitBlock& visit, const Progress& progress) const {
  const BakedScene* scene = baked();
  if (scene != nullptr) {
    for_each_block(scene->tree(), visit);
    return;
  }
  stream(
      [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
        visit({x, y, z}, 0, material);
      },
      progress);
}

std::unique_ptr<SceneSource> open_scene(const SceneArguments& arguments, const Progress& progress) {
  SceneArguments found = arguments;
  if (!parse_generator(arguments.scene)) {
    found.scene = scene_path(arguments.scene);
  }
  return open_scene(found, nullptr, progress);
}

std::unique_ptr<SceneSource> open_scene(const SceneArguments& arguments, SceneOpening* opening,
                                        const Progress& progress) {
  if (arguments.depth) {
    check_depth(*arguments.depth);
  }
  if (auto spec = parse_generator(arguments.scene)) {
    if (arguments.as_voxels) {
      throw UsageError("--as-voxels is for point files, and this is a generator");
    }
    if (arguments.as_points || arguments.as_heights) {
      throw UsageError("--as-points and --as-heights are for .npy and .npz, and this is a generator");
    }
    if (arguments.frame) {
      throw UsageError("--frame is for .vox files with frames, and this is a generator");
    }
    if (arguments.depth) {
      spec->depth = *arguments.depth;
    }
    return std::make_unique<GeneratedScene>(*spec);
  }
  const ArrayAs as = arguments.as_heights  ? ArrayAs::kHeights
                     : arguments.as_points ? ArrayAs::kPoints
                                           : ArrayAs::kByShape;
  Source source = read_scene_file({arguments.scene, arguments.frame, as}, progress);
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
