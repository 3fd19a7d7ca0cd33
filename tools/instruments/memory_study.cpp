#include "instruments/memory_study.h"

#include <algorithm>
#include <memory>

#include "output/hit_rows.h"
#include "readers/oct.h"
#include "readers/source.h"
#include "scene/baking.h"
#include "scene/built_scene.h"
#include "scene/host_memory.h"
#include "thimble/picture/render.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/octree.h"
#include "thimble/tree/shared_tree.h"

namespace thimble::tools {
namespace {

// A solid block of one material, 2^level voxels a side.
struct SolidBlock {
  Vec3i corner;
  std::uint8_t level = 0;
  std::uint8_t material = 0;
};

// The same scene `levels` depths coarser; both in Morton order.
std::vector<SolidBlock> coarser(const std::vector<SolidBlock>& blocks, int levels) {
  std::vector<SolidBlock> result;
  std::array<std::uint64_t, 256> volume{};
  for (std::size_t first = 0; first < blocks.size();) {
    const SolidBlock& block = blocks[first];
    const Vec3i corner{block.corner.x >> levels, block.corner.y >> levels, block.corner.z >> levels};
    if (block.level >= levels) {
      result.push_back({corner, static_cast<std::uint8_t>(block.level - levels), block.material});
      ++first;
      continue;
    }
    // All blocks inside one voxel follow each other.
    std::size_t end = first;
    volume.fill(0);
    for (; end < blocks.size() && blocks[end].corner.x >> levels == corner.x &&
           blocks[end].corner.y >> levels == corner.y && blocks[end].corner.z >> levels == corner.z;
         ++end) {
      volume[blocks[end].material] += std::uint64_t{1} << (3 * blocks[end].level);
    }
    const auto most = std::max_element(volume.begin(), volume.end());  // the first of equals
    result.push_back({corner, 0, static_cast<std::uint8_t>(most - volume.begin())});
    first = end;
  }
  return result;
}

// The blocks of one depth in all structures. Memory of its own, as much as it takes.
struct DepthScene {
  // A world of 2^world_level; the blocks' coordinates and sides are multiplied by 2^up. `one_material` makes all of them
  // material 0. The dense grid is filled by `make_dense` only. Throws InputError when the machine or the formats cannot
  // hold it.
  DepthScene(const std::vector<SolidBlock>& blocks, int world_level, int up, bool one_material)
      : pool_memory(HostMemory::largest()) {
    fail_if(Octree::make(world_level, pool_memory.bytes(), &pool) != Status::kOk, "a world of depth ",
            world_level, " is beyond the limits");
    for (const SolidBlock& block : blocks) {
      const Vec3i corner{block.corner.x << up, block.corner.y << up, block.corner.z << up};
      const Status status =
          pool.insert_block(corner, block.level + up, one_material ? std::uint8_t{0} : block.material);
      fail_if(status != Status::kOk, "the scene does not go into a pool of nodes: ", status_text(status));
    }
    shape = compact_shape(pool);
    const std::size_t size = compact_bytes(shape);
    tree_bytes.resize(size);
    fail_if(size == 0 || CompactTree::make(pool, Bytes(tree_bytes.data(), size), &compact) != Status::kOk,
            "the scene does not go into a compact tree");
    make_shared();
    dense_size = grid_size(compact.bounds().high, world_level);
  }

  std::array<std::uint64_t, kMemoryStructures> bytes() const {
    return {dense_grid_bytes(dense_size), pool.used_bytes(), compact.size_bytes(), shared.size_bytes()};
  }
  // Fills the dense grid from the blocks that this was made from.
  void make_dense(const std::vector<SolidBlock>& blocks) {
    dense_bytes.resize(dense_grid_bytes(dense_size));
    fail_if(DenseGrid::make(dense_size, Bytes(dense_bytes.data(), dense_bytes.size()), &dense) != Status::kOk,
            "the scene does not go into a dense grid");
    for (const SolidBlock& block : blocks) {
      for_voxels(block.corner, block.level, [&](std::int32_t x, std::int32_t y, std::int32_t z) {
        fail_if(dense.set({x, y, z}) != Status::kOk, "internal error: a voxel outside the grid");
      });
    }
    has_dense = true;
  }

  Status render(std::size_t structure, const Camera& camera, const Shading& shading, const Band& band,
                RenderCounts* counts) const {
    const auto render_in = [&](const auto& structure_drawn) {
      return render_band(structure_drawn, camera, shading, band, counts, {UINT32_MAX, Width::k64});
    };
    return structure == kDense     ? render_in(dense)
           : structure == kPool    ? render_in(pool)
           : structure == kCompact ? render_in(compact)
                                   : render_in(shared);
  }

  void make_shared() {
    const HostMemory work(thimble::shared_work_bytes(compact.node_count()));
    Status status = SharedTree::make(compact, {}, work.bytes(), nullptr, &shared_build);
    if (status == Status::kOutOfMemory) {
      shared_bytes.resize(shared_build.bytes);
      status = SharedTree::make(compact, Bytes(shared_bytes.data(), shared_bytes.size()), work.bytes(),
                                &shared, &shared_build);
    }
    fail_if(status != Status::kOk, "the scene does not go into a shared tree");
  }

  HostMemory pool_memory;
  Octree pool;
  CompactShape shape;
  std::vector<std::uint8_t> tree_bytes;
  CompactTree compact;
  SharedBuild shared_build;  // its hash table's bytes are those that building the DAG took at the least
  std::vector<std::uint8_t> shared_bytes;
  SharedTree shared;
  Vec3i dense_size;  // the least grid from 0,0,0 that holds everything solid and whose world is this one
  std::vector<std::uint8_t> dense_bytes;
  DenseGrid dense;
  bool has_dense = false;
};

// What each pixel's ray met: its colour, and the distance in voxels along the unit ray, negative for a miss.
struct TracedPicture {
  std::vector<Rgb8> colors;
  std::vector<double> distances;
};

// Traces every pixel. The camera is one for the tree's level.
TracedPicture trace_picture(const CompactTree& tree, const Camera& camera, const Shading& shading) {
  TracedPicture picture;
  const std::size_t pixels =
      static_cast<std::size_t>(camera.width_px()) * static_cast<std::size_t>(camera.height_px());
  picture.colors.reserve(pixels);
  picture.distances.reserve(pixels);
  for (std::int32_t y = 0; y < camera.height_px(); ++y) {
    for (std::int32_t x = 0; x < camera.width_px(); ++x) {
      const Ray ray = camera.ray(x, y);
      Hit hit;
      fail_if(closest_hit(tree, ray, &hit) != Status::kOk, "the rays of this camera cannot be traced");
      picture.colors.push_back(shade(hit, ray, camera, shading));
      picture.distances.push_back(hit.kind == HitKind::kHit ? hit_distance(ray, hit) : -1);
    }
  }
  return picture;
}

PictureError picture_error(const TracedPicture& picture, const TracedPicture& reference) {
  PictureError error;
  error.compare_distances(picture.distances, reference.distances);
  for (std::size_t i = 0; i < picture.colors.size(); ++i) {
    const bool same_hit = (picture.distances[i] < 0) == (reference.distances[i] < 0);
    error.wrong_px += same_hit && picture.colors[i] == reference.colors[i] ? 0U : 1U;
  }
  return error;
}

// The same view of a world with 2^levels fewer voxels a side.
SceneCamera coarser_view(const SceneCamera& camera, int levels) {
  SceneCamera result = camera;
  for (int axis = 0; axis < 3; ++axis) {
    result.eye[axis] = Q8::from_raw(camera.eye[axis].raw >> levels);
    result.target[axis] = Q8::from_raw(camera.target[axis].raw >> levels);
  }
  result.span = Q14::from_raw(std::max(1, camera.span.raw >> levels));
  return result;
}

// Frames of all structures by turns, so that whatever else the machine does meets all of them.
void draw(const DepthScene& scene, const Camera& camera, const Shading& given, int frames, DepthRow* row) {
  const Shading shading = scene_shading(given.mode, given.palette, camera, scene.compact.bounds());
  std::vector<std::uint8_t> pixels(band_bytes(PixelFormat::kRgb888, camera.width_px(), camera.height_px()));
  Band band;
  band.pixels = Bytes(pixels.data(), pixels.size());
  band.rows = camera.height_px();
  std::array<std::vector<double>, kMemoryStructures> times_ms;
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t i = 0; i < kMemoryStructures; ++i) {
      if (i == kDense && !scene.has_dense) {
        continue;
      }
      RenderCounts counts;
      const FrameWatch watch;
      fail_if(scene.render(i, camera, shading, band, &counts) != Status::kOk,
              "the rays of this camera cannot be traced");
      times_ms[i].push_back(watch.ms());
      row->structures[i].visits_per_ray =
          static_cast<double>(counts.node_visits) / static_cast<double>(counts.rays);
    }
  }
  for (std::size_t i = 0; i < kMemoryStructures; ++i) {
    if (!times_ms[i].empty()) {
      row->structures[i].frame_ms = quantile(times_ms[i], 0.5);
    }
  }
}

// Bytes of all structures; `bits` is the same scene in one material, or null when it is in one already.
void count_bytes(const SceneSource& source, const DepthScene& scene, const DepthScene* bits, DepthRow* row) {
  row->grid = scene.dense_size;
  row->units = static_cast<std::uint64_t>(row->grid.x) * static_cast<std::uint64_t>(row->grid.y) *
               static_cast<std::uint64_t>(row->grid.z);
  row->voxels = scene.pool.voxels();
  row->leaves = std::uint64_t{scene.shape.solid_blocks} + scene.shape.voxel_bits;
  row->pool_nodes = scene.pool.nodes_used();
  row->compact_nodes = scene.compact.node_count();
  row->dag_nodes = scene.shared.node_count();
  row->dag_table_bytes = scene.shared_build.work_bytes;
  for (std::size_t i = 0; i < kMemoryStructures; ++i) {
    StructureFigures& figures = row->structures[i];
    figures.bytes = scene.bytes()[i];
    std::uint64_t colored = figures.bytes;
    std::uint64_t places = row->leaves;
    if (i == kDense) {
      places = row->units;
      colored += places;
    } else if (i == kCompact && bits == nullptr) {
      CompactShape shape = scene.shape;
      shape.many_materials = true;
      colored = compact_bytes(shape);
    } else if (i == kShared) {
      colored = scene.shared.bytes_with_materials();
    }
    figures.stored_bytes[0] = bits == nullptr ? figures.bytes : bits->bytes()[i];
    for (std::size_t stored = 1; stored < kStoredKinds; ++stored) {
      figures.stored_bytes[stored] = colored + places * (kStoredBytes[stored] - kStoredBytes[1]);
    }
  }
  auto& structures = row->structures;
  structures[kDense].build_bytes = structures[kDense].bytes;
  structures[kPool].build_bytes = scene.pool.high_water_bytes();
  // As the command builds: single voxels from a list of keys, all else from a pool.
  const std::uint64_t key_bytes = source.single_material() && row->depth <= 10 ? 4 : 8;
  structures[kCompact].build_bytes =
      structures[kCompact].bytes +
      (source.is_point_set() ? row->voxels * key_bytes : scene.pool.high_water_bytes());
  structures[kShared].build_bytes =
      std::max(structures[kCompact].build_bytes,
               structures[kCompact].bytes + scene.shared_build.work_bytes + structures[kShared].bytes);
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
    for (std::uint64_t budget = 1024; budgets.empty() || budgets.back() < whole; budget *= 2) {
      budgets.push_back(budget);
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
  int last_color = 0;
  {
    const BuiltScene built(source, {}, [&](double done) { progress(0.2 * done); });
    walk_blocks(built.compact(), [&](const Vec3i& corner, int level, std::uint8_t material) {
      blocks.push_back({corner, static_cast<std::uint8_t>(level), material});
      last_color = std::max<int>(last_color, material);
    });
    palette = built.palette();
  }

  // The deepest one is the judge: all pictures are of its rays, so that nothing but the scene differs.
  DepthScene own(blocks, own_depth, 0, false);
  const Framing framing = frame_scene(options.view, source, {own_depth, own.compact.bounds()});
  const Camera& camera = framing.camera;
  study.note = framing.note;
  study.pixels =
      static_cast<std::uint64_t>(camera.width_px()) * static_cast<std::uint64_t>(camera.height_px());
  const Shading shading =
      scene_shading(options.shade, {palette.data(), palette.size()}, camera, own.compact.bounds());
  const TracedPicture reference = trace_picture(own.compact, camera, shading);
  const std::string kept_name = scene_name(name).substr(0, kMaxNameBytes);
  BakedParts parts;
  parts.tree = {own.compact.bytes(), own.compact.size_bytes()};
  parts.palette = {palette.data(), blocks.empty() ? 0 : static_cast<std::size_t>(last_color) + 1};
  parts.camera = &framing.kept;
  parts.name = {reinterpret_cast<const std::uint8_t*>(kept_name.data()), kept_name.size()};
  study.around_tree_bytes = baked_bytes(parts) - own.compact.size_bytes();

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
          scene.compact.many_materials() ? std::make_unique<DepthScene>(coarse, depth, 0, true) : nullptr;
      count_bytes(source, scene, bits.get(), &row);
    }
    part(0.2);
    Camera view;
    if (options.frames > 0) {
      if (set_camera(coarser_view(framing.kept, levels), camera.width_px(), camera.height_px(), depth,
                     &view) == Status::kOk) {
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
      row.error = picture_error(trace_picture(shown.compact, camera, shading), reference);
    }
    part(1);
    study.depths.push_back(row);
  }

  // From the largest budget down: merging is nested, so each begins where the one before ended.
  study.budgets = budgets_of(options, study.depths);
  for (std::size_t i = study.budgets.size(); i-- > 0;) {
    BudgetRow& row = study.budgets[i];
    if (coarsen_to_bytes(&own.pool, row.budget_bytes)) {
      std::vector<std::uint8_t> bytes(compact_bytes(compact_shape(own.pool)));
      std::size_t size = 0;
      CompactTree tree;
      fail_if(CompactTree::make(own.pool, Bytes(bytes.data(), bytes.size()), &tree, &size) != Status::kOk,
              "internal error: a coarsened tree that cannot be written");
      row.coarsened_bytes = size;
      row.solid_added = own.pool.voxels() - study.depths.back().voxels;
      row.coarsened_error = picture_error(trace_picture(tree, camera, shading), reference);
    }
    progress(1 - 0.1 * static_cast<double>(i) / static_cast<double>(study.budgets.size()));
  }
  return study;
}

}  // namespace thimble::tools
