#include "scene/built_scene.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <new>

#include "output/units.h"
#include "readers/oct.h"
#include "scene/key_sort.h"
#include "thimble/tree/morton.h"

namespace thimble::tools {
namespace {

Bytes aligned(Bytes bytes, std::size_t alignment) {
  const std::size_t past = reinterpret_cast<std::size_t>(bytes.data) & (alignment - 1);
  return bytes.subspan(past == 0 ? 0 : alignment - past);
}

// What a dense grid of the scene must hold. A grid's world is the least that holds the grid, and the world
// decides how rays are quantised: where --depth asks for a larger one, the longest side grows until it is
// that.
Vec3i dense_size(const SceneSource& source) {
  const auto extent = source.extent();
  Vec3i size{std::max(extent[0], 1), std::max(extent[1], 1), std::max(extent[2], 1)};
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    longest = size[axis] > size[longest] ? axis : longest;
  }
  size[longest] = std::max(size[longest], (std::int32_t{1} << (source.level() - 1)) + 1);
  return size;
}

// Bytes of an arena that a renderer with such a band takes first.
std::uint64_t used_before_structure(std::uint64_t state_bytes, std::uint64_t band_bytes) {
  constexpr std::uint64_t kAlign = alignof(std::uint64_t);
  const auto up = [](std::uint64_t bytes) { return (bytes + kAlign - 1) / kAlign * kAlign; };
  return band_bytes == 0 ? 0 : up(up(state_bytes) + band_bytes);
}

// How many keys a full list may keep after its repeats are gone: one that stays nearly full would be sorted
// for ever. Never falls as `capacity` grows.
constexpr std::size_t most_after_tidying(std::size_t capacity) {
  return capacity - capacity / 16 - (capacity >= 1 && capacity < 16 ? 1 : 0);
}

// How many different voxels `source` streams. For reporting only, in memory beside the arena: the voxels are
// counted in as many turns as keep a list of them below 256 MiB, each turn a part of the world.
std::uint64_t count_distinct(const SceneSource& source, const Progress& progress) {
  constexpr std::uint64_t kMostKeys = std::uint64_t{1} << 25;
  std::uint64_t streamed = 0;
  source.stream([&](auto, auto, auto, auto) { ++streamed; }, progress);
  const std::uint64_t turns = streamed / kMostKeys + 1;
  std::uint64_t distinct = 0;
  for (std::uint64_t turn = 0; turn < turns; ++turn) {
    std::vector<std::uint64_t> codes;
    source.stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t) {
          const std::uint64_t code = morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                                 static_cast<std::uint32_t>(z));
          if (code % turns == turn) {
            codes.push_back(code);
          }
        },
        progress);
    std::sort(codes.begin(), codes.end());
    distinct += static_cast<std::uint64_t>(std::unique(codes.begin(), codes.end()) - codes.begin());
  }
  return distinct;
}

// Everything solid: blocks where the source has them, else voxels, which are blocks of level 0.
template <class Take>
void for_each_solid(const SceneSource& source, const Progress& progress, const Take& take) {
  if (const BakedScene* baked = source.baked()) {
    for_each_block(baked->tree(), take);
    return;
  }
  source.stream(
      [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
        take(Vec3i{x, y, z}, 0, material);
      },
      progress);
}

}  // namespace

BuiltScene::BuiltScene(const SceneSource& source, const BuildOptions& options, const Progress& progress)
    : options_(options) {
  for (const Material& material : source.palette()) {
    palette_.push_back({material.color.r, material.color.g, material.color.b});
  }
  const auto start = std::chrono::steady_clock::now();
  try {
    memory_ = options.memory_bytes ? HostMemory(static_cast<std::size_t>(*options.memory_bytes))
                                   : HostMemory::largest();
  } catch (const std::bad_alloc&) {
    throw InputError(options.memory_bytes ? "this machine does not give " + grouped(*options.memory_bytes) +
                                                " bytes (" + options.budget_name + ")"
                                          : "this machine has no memory left for the scene");
  }
  if (!try_to_build(source, progress)) {
    if (!options.memory_bytes) {
      throw InputError("the scene does not fit into this machine's memory");
    }
    std::uint64_t needed = 0;
    std::string part;
    if (options.structure == StructureKind::kDense) {
      // Known without building it.
      const Vec3i size = dense_size(source);
      needed = used_before_structure(options.render_state_bytes, options.least_band_bytes) +
               dense_grid_bytes(size);
      part = " (" + grouped(dense_grid_bytes(size)) + " of them the grid of " + std::to_string(size.x) +
             " x " + std::to_string(size.y) + " x " + std::to_string(size.z) + " voxels)";
    } else {
      BuildOptions unlimited = options;
      unlimited.memory_bytes.reset();
      unlimited.coarsen = false;
      unlimited.band_bytes = options.least_band_bytes;
      needed = BuiltScene(source, unlimited, progress).least_budget_bytes();
    }
    const bool dense = options.structure == StructureKind::kDense;
    throw InputError(
        (options.coarsen && !dense ? "too little even for a coarse tree: in full it needs " : "needs ") +
        grouped(needed) + " bytes" + part + ", the budget is " + grouped(*options.memory_bytes) + " (" +
        options.budget_name + "); give it more" +
        (dense             ? " or another --structure"
         : options.coarsen ? ""
                           : ", a smaller --depth or --coarsen"));
  }
  least_budget_bytes_ = least_budget_bytes_ == 0 ? high_water_bytes() : least_budget_bytes_;
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // The tree knows what each merge added when it was made; voxels that came later and were already covered
  // are taken off by counting what the source really has.
  const bool coarsened = structure() == StructureKind::kPool ? octree_.solid_added() != 0 : compact_.merged();
  const BakedScene* baked = source.baked();
  if (coarsened) {
    solid_added_ =
        voxels() - (baked != nullptr ? baked->tree().voxel_count() : count_distinct(source, progress));
  }
  solid_added_ += baked != nullptr ? baked->tree().solid_added() : 0;
}

// A band of the least size leaves more room for the scene; merging blocks is the last resort.
bool BuiltScene::try_to_build(const SceneSource& source, const Progress& progress) {
  const bool may_coarsen = options_.coarsen && options_.structure != StructureKind::kDense;
  for (int attempt = 0; attempt < (may_coarsen ? 4 : 2); ++attempt) {
    const bool least = attempt % 2 == 1;
    if (least && options_.least_band_bytes == options_.band_bytes) {
      continue;
    }
    try {
      build(source, least ? options_.least_band_bytes : options_.band_bytes, attempt >= 2, progress);
      return true;
    } catch (const Shortage&) {
      // The next attempt makes do with less.
    }
  }
  return false;
}

void BuiltScene::build(const SceneSource& source, std::uint64_t band_bytes, bool coarsen,
                       const Progress& progress) {
  arena_ = Arena(memory_.bytes());
  band_ = {};
  if (band_bytes != 0) {
    if (arena_.take(static_cast<std::size_t>(options_.render_state_bytes)).empty()) {
      throw Shortage{};
    }
    band_ = arena_.take(static_cast<std::size_t>(band_bytes));
    if (band_.empty()) {
      throw Shortage{};
    }
  }
  if (source.baked() != nullptr && !coarsen && options_.structure == StructureKind::kCompact) {
    take_baked(source.baked()->tree());
    return;
  }
  if (coarsen && options_.structure == StructureKind::kCompact) {
    try {
      build_parts(source, progress);
      return;
    } catch (const Shortage&) {
      // Too little for parts: one pool that coarsens as it fills.
    }
  }
  if (options_.structure == StructureKind::kDense) {
    build_dense(source, progress);
  } else if (options_.structure == StructureKind::kPool || coarsen || !source.is_point_set()) {
    build_pool(source, coarsen, progress);
  } else if (source.single_material() && source.level() <= 10) {
    build_keys<std::uint32_t>(source, progress);
  } else {
    build_keys<std::uint64_t>(source, progress);
  }
}

void BuiltScene::build_dense(const SceneSource& source, const Progress& progress) {
  const Vec3i size = dense_size(source);
  const Bytes bytes = arena_.take(dense_grid_bytes(size));
  if (bytes.empty() || DenseGrid::make(size, bytes, &dense_) != Status::kOk) {
    throw Shortage{};
  }
  source.stream(
      [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t) {
        if (dense_.set({x, y, z}) != Status::kOk) {
          throw InputError("a voxel lies outside the dense grid");
        }
      },
      progress);
}

void BuiltScene::take_baked(const CompactTree& tree) {
  if (options_.baked_in_flash) {
    compact_ = tree;
    return;
  }
  const Bytes home = arena_.take(tree.size_bytes());
  if (home.empty()) {
    throw Shortage{};
  }
  std::memcpy(home.data, tree.bytes(), home.size);
  if (CompactTree::open(home, &compact_) != Status::kOk) {
    throw InputError("internal error: the baked tree does not open");
  }
}

void BuiltScene::insert(const SceneSource& source, const Vec3i& voxel, int block_level,
                        std::uint8_t material) {
  // In a point set the greatest material wins, in whatever order and structure it is built.
  if (source.is_point_set() && !source.single_material() && octree_.material(voxel) >= material) {
    return;
  }
  const Status status = octree_.insert_block(voxel, block_level, material);
  if (status == Status::kOutOfMemory) {
    throw Shortage{};
  }
  if (status != Status::kOk) {
    throw InputError("voxel " + std::to_string(voxel.x) + "," + std::to_string(voxel.y) + "," +
                     std::to_string(voxel.z) + " lies outside the world");
  }
}

// Fills the pool with part `part` (by its Morton number) of the world, `part_level` of its levels.
void BuiltScene::fill_part(const SceneSource& source, Bytes pool, int part_level, std::size_t part,
                           const Progress& progress) {
  if (Octree::make(part_level, pool, &octree_) != Status::kOk || octree_.capacity() == 0) {
    throw Shortage{};
  }
  octree_.set_coarsen(true);
  const std::int32_t inside = (std::int32_t{1} << part_level) - 1;
  const auto number = [&](std::int32_t x) { return static_cast<std::uint32_t>(x >> part_level); };
  for_each_solid(source, progress, [&](const Vec3i& at, int block_level, std::uint8_t material) {
    const std::size_t code = morton_code(number(at.x), number(at.y), number(at.z));
    if (block_level <= part_level) {
      if (code == part) {
        insert(source, {at.x & inside, at.y & inside, at.z & inside}, block_level, material);
      }
      return;
    }
    const int above = 3 * (block_level - part_level);
    if (code >> above == part >> above) {
      insert(source, {}, part_level, material);  // the block holds the whole part
    }
  });
}

// The world in parts: each is built in the pool, coarsened and made compact at once; in the end the parts are
// joined. So the pool's eight bytes a node are paid for one part at a time, and the tree may take near half
// of the arena:
//
//   table of parts | compact parts            | pool, at the end the joined tree
//                  | half of what is left     | the other half
//
// All parts are coarsened at one price of a node, the least at which they fit, so that of all blocks those go
// first that add the least volume for what they save. The price is found from how many nodes each part has at
// each price.
void BuiltScene::build_parts(const SceneSource& source, const Progress& progress) {
  // A stream for each part, twice: 64 parts only where a stream is short.
  constexpr std::uint64_t kShortStream = 4'000'000;
  constexpr std::size_t kRoomFor64 = std::size_t{256} << 10;
  const bool short_stream = source.points() != 0 && source.points() <= kShortStream && !source.is_mesh();
  const int split = short_stream && arena_.free_bytes() >= kRoomFor64 ? 2 : 1;
  const int part_level = source.level() - split;
  const std::size_t count = std::size_t{1} << (3 * split);
  const std::size_t mark = arena_.used_bytes();
  const Bytes table = arena_.take(count * sizeof(CompactTree), alignof(CompactTree));
  const Bytes rest = aligned(arena_.rest(), alignof(std::uint64_t));
  // Where headers would take more than an eighth of the parts' half, one pool for all does better.
  if (part_level < kMinLevel || table.empty() || count * kCompactHeaderBytes > rest.size / 16) {
    arena_.rewind(mark);
    throw Shortage{};
  }
  CompactTree* parts = new (table.data) CompactTree[count];
  const Bytes home = rest.subspan(0, rest.size / 16 * 8);
  const Bytes pool = rest.subspan(home.size);

  // Prices from 1/16 voxel a node, below which little is to be had, to 2^27, beyond which nothing is left.
  constexpr int kOctave = 4;
  constexpr int kFirstStep = (27 - 4) * kOctave;
  constexpr int kEndStep = (27 + 27) * kOctave;
  std::array<std::uint64_t, kEndStep> nodes{};
  std::uint64_t all_nodes = 0;
  for (std::size_t part = 0; part < count; ++part) {
    fill_part(source, pool, part_level, part, progress);
    all_nodes += octree_.nodes_used();
    for (int step = kFirstStep; step < kEndStep; ++step) {
      nodes[static_cast<std::size_t>(step)] += octree_.nodes_at(step);
    }
  }
  // Bytes of so many nodes: mask, directory and merged bit, and for several materials what is usual.
  const std::uint64_t sixteenths = source.single_material() ? 19 : 40;
  const auto fits = [&](std::uint64_t number) {
    return number * sixteenths / 16 + count * (kCompactHeaderBytes + 16) <= home.size;
  };
  int step = fits(all_nodes) ? -1 : kFirstStep;  // -1: as they are
  while (step >= 0 && step + 1 < kEndStep && !fits(nodes[static_cast<std::size_t>(step)])) {
    ++step;
  }
  // The estimate may be short for materials; the price then rises an octave at a time.
  for (; step < kEndStep; step = step < 0 ? kFirstStep : step + kOctave) {
    std::size_t used = 0;
    std::size_t pool_used = 0;
    std::size_t part = 0;
    for (; part < count; ++part) {
      fill_part(source, pool, part_level, part, progress);
      if (step >= 0) {
        octree_.coarsen_at(step);
      }
      pool_used = std::max(pool_used, octree_.high_water_bytes());
      const Bytes target = aligned(home.subspan(used), alignof(std::uint64_t));
      std::size_t size = 0;
      if (CompactTree::make(octree_, target, nullptr, &size) != Status::kOk ||
          CompactTree::open(target.subspan(0, size), &parts[part]) != Status::kOk) {
        break;
      }
      used = static_cast<std::size_t>(target.data - home.data) + size;
    }
    std::size_t size = 0;
    if (part == count && CompactTree::make({parts, count}, pool, nullptr, &size) == Status::kOk) {
      arena_.note_scratch(static_cast<std::size_t>(pool.data - arena_.rest().data) +
                          std::max(pool_used, size));
      arena_.rewind(mark);
      keep_compact(pool.subspan(0, size));
      return;
    }
  }
  arena_.rewind(mark);
  throw Shortage{};
}

void BuiltScene::build_pool(const SceneSource& source, bool coarsen, const Progress& progress) {
  const bool compact = options_.structure == StructureKind::kCompact;
  const Bytes rest = aligned(arena_.rest(), alignof(std::uint64_t));
  // Without coarsening the pool may take all and the compact tree what it leaves. A pool that coarsens fills
  // what it gets, so something is kept back for the compact tree: a node of it takes about an eighth of the
  // bytes, more where there are materials.
  const std::size_t pool_bytes =
      compact && coarsen ? (source.single_material() ? rest.size / 8 * 7 : rest.size / 4 * 3) : rest.size;
  if (Octree::make(source.level(), rest.subspan(0, pool_bytes), &octree_) != Status::kOk) {
    throw Shortage{};
  }
  octree_.set_coarsen(coarsen);
  for_each_solid(source, progress, [&](const Vec3i& at, int block_level, std::uint8_t material) {
    insert(source, at, block_level, material);
  });

  // `rest` is aligned, so the pool needs none of the slack that octree_bytes allows for.
  const std::size_t pool_used = Octree::octree_bytes(octree_.nodes_high_water()) - Octree::octree_bytes(0);
  if (!compact) {
    arena_.take(static_cast<std::size_t>(rest.data - arena_.rest().data) + std::min(pool_used, pool_bytes),
                1);
    return;
  }
  const Bytes target = aligned(rest.subspan(coarsen ? pool_bytes : pool_used), alignof(std::uint64_t));
  std::size_t size = 0;
  Status status = CompactTree::make(octree_, target, nullptr, &size);
  while (status == Status::kOutOfMemory && coarsen && octree_.nodes_used() > 1) {
    const std::uint64_t nodes = octree_.nodes_used();
    const std::uint64_t fewer = std::min(nodes - 1, std::max<std::uint64_t>(1, nodes * target.size / size));
    if (octree_.coarsen_to(static_cast<std::size_t>(fewer)) != Status::kOk) {
      break;
    }
    status = CompactTree::make(octree_, target, nullptr, &size);
  }
  if (status != Status::kOk) {
    throw Shortage{};
  }
  arena_.note_scratch(static_cast<std::size_t>(target.data - arena_.rest().data) + size);
  keep_compact(target.subspan(0, size));
}

template <class Key>
void BuiltScene::build_keys(const SceneSource& source, const Progress& progress) {
  constexpr bool kBare = sizeof(Key) == 4;
  const int key_bits = 3 * source.level() + (kBare ? 0 : 8);
  const Bytes rest = aligned(arena_.rest(), alignof(std::uint64_t));
  const std::size_t capacity = std::min<std::size_t>(rest.size / sizeof(Key), UINT32_MAX);
  Key* keys = reinterpret_cast<Key*>(rest.data);
  std::size_t count = 0;
  std::size_t most = 0;  // bytes
  bool tidied = false;
  const auto tidy = [&] {
    const Bytes free = aligned(rest.subspan(count * sizeof(Key)), alignof(std::uint64_t));
    const Bytes scratch = free.subspan(0, key_sort_scratch_bytes(count, options_.threads));
    most = std::max(most, static_cast<std::size_t>(free.data - rest.data) + scratch.size);
    sort_keys_fast(Span<Key>(keys, count), key_bits, scratch, options_.threads);
    count = unique_keys(Span<Key>(keys, count));
  };
  std::uint64_t streamed = 0;
  source.stream(
      [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
        ++streamed;
        if (count == capacity) {
          // Repeats may have filled it.
          tidy();
          tidied = true;
          if (count > most_after_tidying(capacity) || capacity == 0) {
            throw Shortage{};
          }
        }
        const std::uint64_t code = morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                               static_cast<std::uint32_t>(z));
        keys[count++] = static_cast<Key>(kBare ? code : code << 8 | material);
      },
      progress);
  tidy();
  // The same demand at the end, so that whether a scene fits is a matter of its counts and not of their
  // order.
  if (tidied && count > most_after_tidying(capacity)) {
    throw Shortage{};
  }

  const Bytes target = aligned(rest.subspan(count * sizeof(Key)), alignof(std::uint64_t));
  std::size_t size = 0;
  const Span<const Key> sorted(keys, count);
  Status status = Status::kOk;
  if constexpr (kBare) {
    status = CompactTree::make(sorted, source.level(), 0, target, nullptr, &size);
  } else {
    status = CompactTree::make(sorted, source.level(), target, nullptr, &size);
  }
  if (status != Status::kOk) {
    throw Shortage{};
  }
  const std::size_t offset = static_cast<std::size_t>(rest.data - arena_.rest().data);
  arena_.note_scratch(
      std::max(offset + most, static_cast<std::size_t>(target.data - arena_.rest().data) + size));
  // The fewest keys that would have done: all that came, or room enough for the different ones when tidied.
  std::size_t fewest = count + count / 15;
  while (most_after_tidying(fewest) < count) {
    ++fewest;
  }
  while (fewest > 0 && most_after_tidying(fewest - 1) >= count) {
    --fewest;
  }
  fewest = static_cast<std::size_t>(std::min<std::uint64_t>(fewest, streamed));
  least_budget_bytes_ =
      arena_.used_bytes() + std::max(offset + fewest * sizeof(Key),
                                     static_cast<std::size_t>(target.data - arena_.rest().data) + size);
  keep_compact(target.subspan(0, size));
}

// Moves the tree to the front of what is free and takes its bytes.
void BuiltScene::keep_compact(Bytes tree) {
  const Bytes home = arena_.take(tree.size);
  std::memmove(home.data, tree.data, tree.size);
  if (CompactTree::open(home, &compact_) != Status::kOk) {
    throw InputError("internal error: the compact tree just built is damaged");
  }
}

int BuiltScene::level() const {
  return with_structure([](const auto& structure) { return structure.level(); });
}

VoxelBox BuiltScene::bounds() const {
  return with_structure([](const auto& structure) { return structure.bounds(); });
}

std::uint64_t BuiltScene::voxels() const {
  switch (options_.structure) {
    case StructureKind::kDense:
      return dense_.voxel_count();
    case StructureKind::kPool:
      return octree_.voxels();
    case StructureKind::kCompact:
      return compact_.voxel_count();
  }
  return 0;
}

std::uint64_t BuiltScene::nodes() const {
  return options_.structure == StructureKind::kPool ? octree_.nodes_used() : compact_.node_count();
}

std::uint64_t BuiltScene::tree_bytes() const {
  switch (options_.structure) {
    case StructureKind::kDense:
      return dense_.used_bytes();
    case StructureKind::kPool:
      return octree_.used_bytes();
    case StructureKind::kCompact:
      return compact_.size_bytes();
  }
  return 0;
}

bool BuiltScene::prepare_wide(std::int32_t width_px, std::int32_t height_px, int threads) {
  if (options_.structure != StructureKind::kCompact) {
    return false;
  }
  const auto start = std::chrono::steady_clock::now();
  const std::size_t mark = arena_.used_bytes();
  // Asked before the lists are made: what does not fit costs no time.
  const std::size_t list_bytes = wide::VoxelLists::bytes(compact_);
  const std::int32_t least_rows = std::min(height_px, kLeastWideRows);
  const auto workspace = [&](std::int32_t rows) { return wide::workspace_bytes(width_px, rows, threads); };
  if (list_bytes > arena_.free_bytes() || arena_.free_bytes() - list_bytes < workspace(least_rows) ||
      wide::VoxelLists::make(compact_, &arena_, &lists_) != Status::kOk) {
    return false;
  }
  std::int32_t rows = height_px;
  while (rows > least_rows && workspace(rows) > arena_.free_bytes()) {
    rows = std::max(least_rows, rows / 2);
  }
  wide_workspace_ = arena_.take(workspace(rows), 64);
  if (wide_workspace_.empty()) {
    arena_.rewind(mark);
    return false;
  }
  wide_rows_ = rows;
  wide_threads_ = std::make_unique<wide::Threads>(threads);
  build_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return true;
}

Status BuiltScene::render_wide(const Camera& camera, const Shading& shading, const Band& band,
                               RenderCounts* counts, wide::Counts* work) const {
  wide::Options options;
  options.threads = wide_threads_.get();
  wide::Stats stats;
  const Status status = wide::render(lists_, camera, shading, band, wide_workspace_, counts, options, &stats);
  work->add(stats.counts);
  return status;
}

Status BuiltScene::closest_hit(const Ray& ray, Hit* hit, const TraceOptions& options) const {
  return with_structure(
      [&](const auto& structure) { return thimble::closest_hit(structure, ray, hit, options); });
}

Status BuiltScene::render_band(const Camera& camera, const Shading& shading, const Band& band,
                               RenderCounts* counts, const TraceOptions& options) const {
  return with_structure([&](const auto& structure) {
    return thimble::render_band(structure, camera, shading, band, counts, options);
  });
}

}  // namespace thimble::tools
