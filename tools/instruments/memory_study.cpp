#include "instruments/memory_study.h"

#include <algorithm>
#include <memory>

#include "instruments/stopwatch.h"
#include "scene/baking.h"
#include "scene/built_scene.h"
#include "scene/scene_source.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kDense = static_cast<std::size_t>(MemoryStructure::kDense);
constexpr std::size_t kPool = static_cast<std::size_t>(MemoryStructure::kPool);
constexpr std::size_t kCompact = static_cast<std::size_t>(MemoryStructure::kCompact);
constexpr std::size_t kShared = static_cast<std::size_t>(MemoryStructure::kShared);

// The same view of a world with 2^levels fewer voxels a side.
SceneCamera scaled(const SceneCamera& camera, int levels) {
  SceneCamera result = camera;
  for (int axis = 0; axis < 3; ++axis) {
    result.eye[axis] = Q8::from_raw(camera.eye[axis].raw >> levels);
    result.target[axis] = Q8::from_raw(camera.target[axis].raw >> levels);
  }
  result.span = Q14::from_raw(std::max(1, camera.span.raw >> levels));
  return result;
}

// Frames of all structures by turns, so that whatever else the machine does meets all of them.
void draw(const DepthScene& scene, const Camera& camera, Shading shading, int frames, DepthRow* row) {
  const DepthRange range = depth_range(camera, scene.compact().bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  std::vector<std::uint8_t> pixels(band_bytes(PixelFormat::kRgb888, camera.width_px(), camera.height_px()));
  Band band;
  band.pixels = Bytes(pixels.data(), pixels.size());
  band.rows = camera.height_px();
  std::array<std::vector<double>, kMemoryStructures> times_ms;
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t i = 0; i < kMemoryStructures; ++i) {
      if (i == kDense && !scene.has_dense()) {
        continue;
      }
      RenderCounts counts;
      const Stopwatch watch;
      if (scene.render(static_cast<MemoryStructure>(i), camera, shading, band, &counts) != Status::kOk) {
        throw InputError("the rays of this camera cannot be traced");
      }
      times_ms[i].push_back(watch.ms());
      row->structures[i].visits_per_ray =
          static_cast<double>(counts.node_visits) / static_cast<double>(counts.rays);
    }
  }
  for (std::size_t i = 0; i < kMemoryStructures; ++i) {
    if (!times_ms[i].empty()) {
      const auto middle = times_ms[i].begin() + static_cast<std::ptrdiff_t>(times_ms[i].size() / 2);
      std::nth_element(times_ms[i].begin(), middle, times_ms[i].end());
      row->structures[i].frame_ms = *middle;
    }
  }
}

// Bytes of all structures; `bits` is the same scene in one material, or null when it is in one already.
void count_bytes(const SceneSource& source, const DepthScene& scene, const DepthScene* bits, DepthRow* row) {
  row->grid = scene.dense_size();
  row->units = static_cast<std::uint64_t>(row->grid.x) * static_cast<std::uint64_t>(row->grid.y) *
               static_cast<std::uint64_t>(row->grid.z);
  row->voxels = scene.voxels();
  row->leaves = scene.leaves();
  row->pool_nodes = scene.pool().nodes_used();
  row->compact_nodes = scene.compact().node_count();
  row->dag_nodes = scene.shared().node_count();
  row->dag_table_bytes = scene.shared_work_bytes();
  for (std::size_t i = 0; i < kMemoryStructures; ++i) {
    StructureFigures& figures = row->structures[i];
    const auto structure = static_cast<MemoryStructure>(i);
    figures.bytes = scene.bytes(structure);
    std::uint64_t colored = figures.bytes;
    std::uint64_t places = row->leaves;
    if (i == kDense) {
      places = row->units;
      colored += places;
    } else if (i == kCompact && bits == nullptr) {
      CompactShape shape = scene.shape();
      shape.many_materials = true;
      colored = compact_bytes(shape);
    } else if (i == kShared) {
      colored = scene.shared().bytes_with_materials();
    }
    figures.stored_bytes[0] = bits == nullptr ? figures.bytes : bits->bytes(structure);
    for (std::size_t stored = 1; stored < kStoredKinds; ++stored) {
      figures.stored_bytes[stored] = colored + places * (kStoredBytes[stored] - kStoredBytes[1]);
    }
  }
  auto& structures = row->structures;
  structures[kDense].build_bytes = structures[kDense].bytes;
  structures[kPool].build_bytes = scene.pool().high_water_bytes();
  // As the command builds: single voxels from a list of keys, all else from a pool.
  const std::uint64_t key_bytes = source.single_material() && row->depth <= 10 ? 4 : 8;
  structures[kCompact].build_bytes =
      structures[kCompact].bytes +
      (source.is_point_set() ? row->voxels * key_bytes : scene.pool().high_water_bytes());
  structures[kShared].build_bytes =
      std::max(structures[kCompact].build_bytes,
               structures[kCompact].bytes + scene.shared_work_bytes() + structures[kShared].bytes);
}

// Merges blocks of the pool until its compact tree takes at most `limit` bytes. False when one block is left
// that does not.
bool coarsen_to_bytes(Octree* pool, std::uint64_t limit) {
  for (;;) {
    const std::uint64_t size = compact_bytes(compact_shape(*pool));
    if (size <= limit) {
      return true;
    }
    const std::uint64_t nodes = pool->nodes_used();
    if (nodes <= 1) {
      return false;
    }
    const std::uint64_t fewer = std::clamp<std::uint64_t>(nodes * limit / size, 1, nodes - 1);
    if (pool->coarsen_to(static_cast<std::size_t>(fewer)) != Status::kOk) {
      return false;
    }
  }
}

std::vector<BudgetRow> budgets_of(const StudyOptions& options, const std::vector<DepthRow>& depths) {
  std::vector<std::uint64_t> budgets;
  if (options.budget_sweep) {
    const auto& own = depths.back().structures;
    const std::uint64_t whole = std::max({own[kPool].bytes, own[kCompact].bytes, own[kShared].bytes});
    for (std::uint64_t budget = 1024;; budget *= 2) {
      budgets.push_back(budget);
      if (budget >= whole) {
        break;
      }
    }
  }
  if (options.budget_bytes &&
      std::find(budgets.begin(), budgets.end(), *options.budget_bytes) == budgets.end()) {
    budgets.push_back(*options.budget_bytes);
  }
  std::sort(budgets.begin(), budgets.end());
  std::vector<BudgetRow> rows;
  for (const std::uint64_t budget : budgets) {
    BudgetRow row;
    row.budget_bytes = budget;
    for (const DepthRow& depth : depths) {
      for (std::size_t i = 0; i < kMemoryStructures; ++i) {
        row.depth[i] = depth.structures[i].bytes <= budget ? depth.depth : row.depth[i];
      }
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

MemoryStudy study_memory(const SceneSource& source, const std::string& name, const StudyOptions& options,
                         const Progress& progress) {
  MemoryStudy study;
  const int own_depth = source.level();
  std::vector<SolidBlock> blocks;
  std::vector<Rgb8> palette;
  {
    const BuiltScene built(source, {}, [&](double done) { progress(0.2 * done); });
    blocks = solid_blocks(built.compact());
    palette = built.palette();
  }
  int last_color = 0;
  for (const SolidBlock& block : blocks) {
    last_color = std::max<int>(last_color, block.material);
  }

  // The deepest one is the judge: all pictures are of its rays, so that nothing but the scene differs.
  DepthScene own(blocks, own_depth, 0, false);
  const Framing framing = frame_scene(options.view, source, own_depth, own.compact().bounds());
  const Camera& camera = framing.camera;
  study.note = framing.note;
  study.pixels =
      static_cast<std::uint64_t>(camera.width_px()) * static_cast<std::uint64_t>(camera.height_px());
  Shading shading;
  shading.mode = options.shade;
  shading.palette = Span<const Rgb8>(palette.data(), palette.size());
  const DepthRange range = depth_range(camera, own.compact().bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  const TracedPicture reference = trace_picture(own.compact(), camera, shading);
  const std::string kept_name = scene_name(name).substr(0, kMaxNameBytes);
  BakedParts parts;
  parts.tree = {own.compact().bytes(), own.compact().size_bytes()};
  parts.palette = {palette.data(), blocks.empty() ? 0 : static_cast<std::size_t>(last_color) + 1};
  parts.camera = &framing.kept;
  parts.name = {reinterpret_cast<const std::uint8_t*>(kept_name.data()), kept_name.size()};
  study.around_tree_bytes = baked_bytes(parts) - own.compact().size_bytes();

  for (int depth = 1; depth <= own_depth; ++depth) {
    const auto part = [&](double done) { progress(0.2 + 0.7 * (depth - 1 + done) / own_depth); };
    const int levels = own_depth - depth;
    const std::vector<SolidBlock> coarse = coarser(blocks, levels);
    const auto made = levels == 0 ? nullptr : std::make_unique<DepthScene>(coarse, depth, 0, false);
    DepthScene& scene = made == nullptr ? own : *made;
    DepthRow row;
    row.depth = depth;
    {
      const auto bits =
          scene.compact().many_materials() ? std::make_unique<DepthScene>(coarse, depth, 0, true) : nullptr;
      count_bytes(source, scene, bits.get(), &row);
    }
    part(0.2);
    Camera view;
    if (options.frames > 0) {
      if (set_camera(scaled(framing.kept, levels), camera.width_px(), camera.height_px(), depth, &view) ==
          Status::kOk) {
        if (row.structures[kDense].bytes <= kMostDenseBytes) {
          scene.make_dense(coarse);
        }
        part(0.3);
        draw(scene, view, shading, options.frames, &row);
      } else if (study.note.empty()) {
        study.note = "a world of depth " + std::to_string(depth) +
                     " is too small for rays of so fine a picture: no frames of it are drawn";
      }
    }
    part(0.8);
    if (levels != 0) {
      const DepthScene shown(coarse, own_depth, levels, false);
      row.error = picture_error(trace_picture(shown.compact(), camera, shading), reference);
    }
    part(1);
    study.depths.push_back(row);
  }

  // From the largest budget down: merging is nested, so each goes on where the one before ended.
  study.budgets = budgets_of(options, study.depths);
  for (std::size_t i = study.budgets.size(); i-- > 0;) {
    BudgetRow& row = study.budgets[i];
    if (coarsen_to_bytes(&own.pool(), row.budget_bytes)) {
      std::vector<std::uint8_t> bytes(compact_bytes(compact_shape(own.pool())));
      std::size_t size = 0;
      CompactTree tree;
      if (CompactTree::make(own.pool(), Bytes(bytes.data(), bytes.size()), &tree, &size) != Status::kOk) {
        throw InputError("internal error: a coarsened tree that cannot be written");
      }
      row.coarsened_bytes = size;
      row.solid_added = own.pool().voxels() - study.depths.back().voxels;
      row.coarsened_error = picture_error(trace_picture(tree, camera, shading), reference);
    }
    progress(1 - 0.1 * static_cast<double>(i) / static_cast<double>(study.budgets.size()));
  }
  return study;
}

}  // namespace thimble::tools
