#include "scene/built_scene.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <new>

#include "output/units.h"
#include "readers/file_bytes.h"
#include "readers/oct.h"
#include "scene/point_tree.h"
#include "scene/scene_source.h"

namespace thimble::tools {
namespace {

// Bytes of an arena that a renderer with such a band takes first.
std::uint64_t used_before_structure(std::uint64_t state_bytes, std::uint64_t band_bytes) {
  constexpr std::uint64_t kAlign = alignof(std::uint64_t);
  const auto up = [](std::uint64_t bytes) { return (bytes + kAlign - 1) / kAlign * kAlign; };
  return band_bytes == 0 ? 0 : up(up(state_bytes) + band_bytes);
}

Vec3i extent_of(const SceneSource& source) {
  const auto extent = source.extent();
  return {extent[0], extent[1], extent[2]};
}

Bytes aligned(Bytes bytes, std::size_t alignment) {
  const std::size_t past = reinterpret_cast<std::size_t>(bytes.data) & (alignment - 1);
  return bytes.subspan(past == 0 ? 0 : alignment - past);
}

// How many keys a full list may keep after its repeats are gone: one that stays nearly full would be sorted
// for ever. Never falls as `capacity` grows.
constexpr std::size_t most_after_tidying(std::size_t capacity) {
  return capacity - capacity / 16 - (capacity >= 1 && capacity < 16 ? 1 : 0);
}

// The least bytes of `rest` in which sorted keys would do: all that came, or room enough for the different ones when
// tidied; or those and the tree.
std::size_t least_key_bytes(std::uint64_t streamed, std::uint64_t voxels, std::size_t key_bytes,
                            std::size_t tree_bytes, Bytes rest) {
  const auto count = static_cast<std::size_t>(voxels);
  std::size_t fewest = count + count / 15;
  while (most_after_tidying(fewest) < count) {
    ++fewest;
  }
  while (fewest > 0 && most_after_tidying(fewest - 1) >= count) {
    --fewest;
  }
  fewest = static_cast<std::size_t>(std::min<std::uint64_t>(fewest, streamed));
  const Bytes keys = aligned(rest, alignof(std::uint64_t));
  const Bytes tree = aligned(keys.subspan(count * key_bytes), alignof(std::uint64_t));
  return std::max(static_cast<std::size_t>(keys.data - rest.data) + fewest * key_bytes,
                  static_cast<std::size_t>(tree.data - rest.data) + tree_bytes);
}

// Where memory is the machine's own, many points are built in parts; else, or without room for that, nothing.
PointTree parted_tree(const SceneSource& source, Bytes rest, const BuildOptions& options,
                      const Progress& progress) {
  constexpr std::uint64_t kManyPoints = std::uint64_t{1} << 24;
  const bool takes = !options.memory_bytes && source.points() >= kManyPoints && source.level() > kPartLevel;
  return takes ? build_point_tree(source, rest, options.threads, progress) : PointTree();
}

// Builds behind what the arena holds; its layout, front to back:
//
//   what is there | pool of nodes, or list of keys, while building | compact tree
//
// At the end the compact tree moves down over the workspace. A baked scene's tree is just taken up, without
// any workspace; the other structures are filled from it.
class StructureBuilder {
 public:
  // Thrown where the arena is too small.
  struct Shortage {
    static void throw_if(bool is_short) {
      if (is_short) {
        throw Shortage{};
      }
    }
  };

  // All that is given outlives the builder.
  StructureBuilder(const SceneSource& source, Arena* arena, const BuildOptions& options,
                   const Progress& progress)
      : source_(source), arena_(*arena), options_(options), progress_(progress) {}

  // `coarsen`: merges blocks until the arena is large enough. Throws Shortage, InputError and what the
  // source throws; what the arena then holds behind what was there is lost.
  Structure build(bool coarsen) {
    const StructureKind kind = options_.structure;
    const Bytes rest = aligned(arena_.rest(), alignof(std::uint64_t));
    built_ = {};
    built_.kind = kind;
    if (source_.tree() != nullptr && !coarsen && kind == StructureKind::kCompact) {
      take_baked(*source_.tree());
      return built_;
    }
    if (coarsen && kind == StructureKind::kCompact) {
      try {
        build_parts();
        return built_;
      } catch (const Shortage&) {
        // Too little for parts: one pool that coarsens as it fills.
      }
    }
    if (kind == StructureKind::kDense) {
      build_dense();
    } else if (kind == StructureKind::kPool || coarsen || !source_.is_point_set()) {
      build_pool(coarsen);
    } else if (const PointTree parted = parted_tree(source_, rest, options_, progress_);
               !parted.tree.empty()) {
      arena_.note_scratch(static_cast<std::size_t>(rest.data - arena_.rest().data) +
                          static_cast<std::size_t>(parted.most_bytes));
      const std::size_t key_bytes = source_.single_material() && source_.level() <= 10 ? 4 : 8;
      least_bytes_ = arena_.used_bytes() + least_key_bytes(source_.points(), parted.voxels, key_bytes,
                                                           parted.tree.size, arena_.rest());
      keep_compact(parted.tree);
    } else if (source_.single_material() && source_.level() <= 10) {
      build_keys<std::uint32_t>();
    } else {
      build_keys<std::uint64_t>();
    }
    return built_;
  }

  // The least bytes of an arena in which the same comes out without coarsening, where that is less than the
  // most that was in use; else 0. After `build`.
  std::uint64_t least_bytes() const { return least_bytes_; }

 private:
  void build_dense() {
    const Vec3i size = grid_size(extent_of(source_), source_.level());
    const Bytes bytes = arena_.take(dense_grid_bytes(size));
    Shortage::throw_if(bytes.empty() || DenseGrid::make(size, bytes, &built_.dense) != Status::kOk);
    source_.stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t) {
          fail_if(built_.dense.set({x, y, z}) != Status::kOk, "a voxel lies outside the dense grid");
        },
        progress_);
  }

  void build_pool(bool coarsen) {
    const bool compact = built_.kind == StructureKind::kCompact;
    const Bytes rest = aligned(arena_.rest(), alignof(std::uint64_t));
    // Without coarsening the pool may take all and the compact tree what it leaves. A pool that coarsens fills
    // what it gets, so something is kept back for the compact tree: a node of it takes about an eighth of the
    // bytes, more where there are materials.
    const std::size_t pool_bytes =
        compact && coarsen ? (source_.single_material() ? rest.size / 8 * 7 : rest.size / 4 * 3) : rest.size;
    Shortage::throw_if(Octree::make(source_.level(), rest.subspan(0, pool_bytes), &built_.pool) !=
                       Status::kOk);
    built_.pool.set_coarsen(coarsen);
    source_.stream_blocks(
        [&](const Vec3i& at, int block_level, std::uint8_t material) { insert(at, block_level, material); },
        progress_);

    // `rest` is aligned, so the pool needs none of the slack that octree_bytes allows for.
    const std::size_t pool_used =
        Octree::octree_bytes(built_.pool.nodes_high_water()) - Octree::octree_bytes(0);
    if (!compact) {
      arena_.take(static_cast<std::size_t>(rest.data - arena_.rest().data) + std::min(pool_used, pool_bytes),
                  1);
      return;
    }
    const Bytes target = aligned(rest.subspan(coarsen ? pool_bytes : pool_used), alignof(std::uint64_t));
    std::size_t size = 0;
    Status status = CompactTree::make(built_.pool, target, nullptr, &size);
    while (status == Status::kOutOfMemory && coarsen && built_.pool.nodes_used() > 1) {
      const std::uint64_t nodes = built_.pool.nodes_used();
      const std::uint64_t fewer = std::min(nodes - 1, std::max<std::uint64_t>(1, nodes * target.size / size));
      if (built_.pool.coarsen_to(static_cast<std::size_t>(fewer)) != Status::kOk) {
        break;
      }
      status = CompactTree::make(built_.pool, target, nullptr, &size);
    }
    Shortage::throw_if(status != Status::kOk);
    arena_.note_scratch(static_cast<std::size_t>(target.data - arena_.rest().data) + size);
    keep_compact(target.subspan(0, size));
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
  void build_parts() {
    // A stream for each part, twice: 64 parts only where a stream is short.
    constexpr std::uint64_t kShortStream = 4'000'000;
    constexpr std::size_t kRoomFor64 = std::size_t{256} << 10;
    const bool short_stream = source_.points() != 0 && source_.points() <= kShortStream && !source_.is_mesh();
    const int split = short_stream && arena_.free_bytes() >= kRoomFor64 ? 2 : 1;
    const int part_level = source_.level() - split;
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
      fill_part(pool, part_level, part);
      all_nodes += built_.pool.nodes_used();
      for (int step = kFirstStep; step < kEndStep; ++step) {
        nodes[static_cast<std::size_t>(step)] += built_.pool.nodes_at(step);
      }
    }
    // Bytes of so many nodes: mask, directory and merged bit, and for several materials what is usual.
    const std::uint64_t sixteenths = source_.single_material() ? 19 : 40;
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
        fill_part(pool, part_level, part);
        if (step >= 0) {
          built_.pool.coarsen_at(step);
        }
        pool_used = std::max(pool_used, built_.pool.high_water_bytes());
        const Bytes target = aligned(home.subspan(used), alignof(std::uint64_t));
        std::size_t size = 0;
        if (CompactTree::make(built_.pool, target, &parts[part], &size) != Status::kOk) {
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

  // Fills the pool with part `part` (by its Morton number) of the world, `part_level` of its levels.
  void fill_part(Bytes pool, int part_level, std::size_t part) {
    Shortage::throw_if(Octree::make(part_level, pool, &built_.pool) != Status::kOk ||
                       built_.pool.capacity() == 0);
    built_.pool.set_coarsen(true);
    const std::int32_t inside = (std::int32_t{1} << part_level) - 1;
    const auto number = [&](std::int32_t x) { return static_cast<std::uint32_t>(x >> part_level); };
    const VisitBlock take = [&](const Vec3i& at, int block_level, std::uint8_t material) {
      const std::size_t code = morton_code(number(at.x), number(at.y), number(at.z));
      if (block_level <= part_level) {
        if (code == part) {
          insert({at.x & inside, at.y & inside, at.z & inside}, block_level, material);
        }
        return;
      }
      const int above = 3 * (block_level - part_level);
      if (code >> above == part >> above) {
        insert({}, part_level, material);  // the block holds the whole part
      }
    };
    source_.stream_blocks(take, progress_);
  }

  void insert(const Vec3i& voxel, int block_level, std::uint8_t material) {
    // In a point set the greatest material wins, in whatever order and structure it is built.
    if (source_.is_point_set() && !source_.single_material() && built_.pool.material(voxel) >= material) {
      return;
    }
    const Status status = built_.pool.insert_block(voxel, block_level, material);
    Shortage::throw_if(status == Status::kOutOfMemory);
    fail_if(status != Status::kOk, "voxel ", voxel.x, ",", voxel.y, ",", voxel.z, " lies outside the world");
  }

  void take_baked(const CompactTree& tree) {
    // A large file is not held, either, unless all is to be within a budget.
    if (options_.baked_in_flash || (!options_.memory_bytes && tree.size_bytes() >= kMappedBytes)) {
      built_.compact = tree;
      return;
    }
    keep_compact({tree.bytes(), tree.size_bytes()});
  }

  template <class Key>
  void build_keys() {
    constexpr bool kBare = sizeof(Key) == 4;
    const int key_bits = 3 * source_.level() + (kBare ? 0 : 8);
    const Bytes rest = aligned(arena_.rest(), alignof(std::uint64_t));
    const std::size_t capacity = std::min<std::size_t>(rest.size / sizeof(Key), UINT32_MAX);
    Key* keys = reinterpret_cast<Key*>(rest.data);
    std::size_t count = 0;
    std::size_t most = 0;  // bytes
    // A list as long as the world has places, or very long, is looked through for repeats before it grows on:
    // so places that repeat take no more memory than they would once, twice over.
    constexpr std::uint64_t kShortList = std::uint64_t{1} << 24;
    constexpr std::uint64_t kLongList = std::uint64_t{1} << 26;
    std::size_t wanted = static_cast<std::size_t>(
        std::clamp(std::uint64_t{1} << (3 * source_.level()), kShortList, kLongList));
    const auto tidy = [&] {
      const Bytes free = aligned(rest.subspan(count * sizeof(Key)), alignof(std::uint64_t));
      const Bytes scratch = free.subspan(0, key_sort_scratch_bytes(count, options_.threads));
      most = std::max(most, static_cast<std::size_t>(free.data - rest.data) + scratch.size);
      sort_keys_fast(Span<Key>(keys, count), key_bits, scratch, options_.threads);
      count = unique_keys(Span<Key>(keys, count));
    };
    std::uint64_t streamed = 0;
    source_.stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
          ++streamed;
          if (count == std::min(capacity, wanted)) {
            // Repeats may have filled it.
            tidy();
            Shortage::throw_if(streamed > capacity &&
                               (count > most_after_tidying(capacity) || capacity == 0));
            wanted = std::max(wanted, 2 * count);
          }
          const std::uint64_t code = morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                                 static_cast<std::uint32_t>(z));
          keys[count++] = static_cast<Key>(kBare ? code : code << 8 | material);
        },
        progress_);
    tidy();
    // The same demand at the end, so that whether a scene fits is a matter of its counts and not of their
    // order.
    Shortage::throw_if(streamed > capacity && count > most_after_tidying(capacity));

    const Bytes target = aligned(rest.subspan(count * sizeof(Key)), alignof(std::uint64_t));
    std::size_t size = 0;
    const Span<const Key> sorted(keys, count);
    Status status = Status::kOk;
    if constexpr (kBare) {
      status = CompactTree::make(sorted, source_.level(), 0, target, nullptr, &size);
    } else {
      status = CompactTree::make(sorted, source_.level(), target, nullptr, &size);
    }
    Shortage::throw_if(status != Status::kOk);
    const std::size_t offset = static_cast<std::size_t>(rest.data - arena_.rest().data);
    arena_.note_scratch(
        std::max(offset + most, static_cast<std::size_t>(target.data - arena_.rest().data) + size));
    least_bytes_ = arena_.used_bytes() + least_key_bytes(streamed, count, sizeof(Key), size, arena_.rest());
    keep_compact(target.subspan(0, size));
  }

  // Takes bytes for the tree at the front of what is free, and moves or copies it there.
  void keep_compact(ConstBytes tree) {
    const Bytes home = arena_.take(tree.size);
    Shortage::throw_if(home.empty());
    if (home.data != tree.data) {
      std::memmove(home.data, tree.data, tree.size);
    }
    fail_if(CompactTree::open(home, &built_.compact) != Status::kOk,
            "internal error: the compact tree is damaged");
  }

  const SceneSource& source_;
  Arena& arena_;
  const BuildOptions& options_;
  const Progress& progress_;
  Structure built_;
  std::uint64_t least_bytes_ = 0;
};

// What the scene would need, where it does not fit the budget.
std::string shortage_text(const SceneSource& source, const BuildOptions& options, const Progress& progress) {
  const bool dense = options.structure == StructureKind::kDense;
  std::uint64_t needed = 0;
  std::string part;
  if (dense) {
    // Known without building it.
    const Vec3i size = grid_size(extent_of(source), source.level());
    needed =
        used_before_structure(options.render_state_bytes, options.least_band_bytes) + dense_grid_bytes(size);
    part = concat(" (", grouped(dense_grid_bytes(size)), " of them the grid of ", size.x, " x ", size.y,
                  " x ", size.z, " voxels)");
  } else {
    BuildOptions unlimited = options;
    unlimited.memory_bytes.reset();
    unlimited.coarsen = false;
    unlimited.band_bytes = options.least_band_bytes;
    needed = BuiltScene(source, unlimited, progress).least_budget_bytes();
  }
  return (options.coarsen && !dense ? "too little even for a coarse tree: in full it needs " : "needs ") +
         grouped(needed) + " bytes" + part + ", the budget is " + grouped(*options.memory_bytes) + " (" +
         options.budget_name + "); give it more" +
         (dense                  ? " or another --structure"
          : options.coarsen      ? ""
          : source.is_scalable() ? ", a smaller --depth or --coarsen"
                                 : " or --coarsen");
}

}  // namespace

BuiltScene::BuiltScene(const SceneSource& source, const BuildOptions& options, const Progress& progress)
    : options_(options), palette_(colors_of(source.palette())) {
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
    throw InputError(options.memory_bytes ? shortage_text(source, options, progress)
                                          : "the scene does not fit into this machine's memory");
  }
  least_budget_bytes_ = least_budget_bytes_ == 0 ? high_water_bytes() : least_budget_bytes_;
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // The tree knows what each merge added when it was made; voxels that came later and were already covered
  // are taken off by counting what the source really has.
  const bool coarsened =
      structure() == StructureKind::kPool ? traced_.pool.solid_added() != 0 : compact().merged();
  const BakedScene* baked = source.baked();
  if (coarsened) {
    BuildOptions whole;  // for reporting only, in memory beside the arena
    whole.threads = options.threads;
    solid_added_ = voxels() - (baked != nullptr ? baked->tree().voxel_count()
                                                : BuiltScene(source, whole, progress).voxels());
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
    } catch (const StructureBuilder::Shortage&) {
      // The next attempt makes do with less.
    }
  }
  return false;
}

void BuiltScene::build(const SceneSource& source, std::uint64_t band_bytes, bool coarsen,
                       const Progress& progress) {
  arena_ = Arena(memory_.bytes().subspan(options_.front_bytes));
  band_ = {};
  if (band_bytes != 0) {
    const bool has_state = !arena_.take(static_cast<std::size_t>(options_.render_state_bytes)).empty();
    band_ = has_state ? arena_.take(static_cast<std::size_t>(band_bytes)) : Bytes();
    StructureBuilder::Shortage::throw_if(band_.empty());
  }
  StructureBuilder builder(source, &arena_, options_, progress);
  traced_ = builder.build(coarsen);
  least_budget_bytes_ = builder.least_bytes();
}

Vec3i grid_size(Vec3i size, int level) {
  int longest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = std::max(size[axis], 1);
    longest = size[axis] > size[longest] ? axis : longest;
  }
  size[longest] = std::max(size[longest], (std::int32_t{1} << (level - 1)) + 1);
  return size;
}

std::uint64_t BuiltScene::voxels() const {
  return structure() == StructureKind::kDense  ? traced_.dense.voxel_count()
         : structure() == StructureKind::kPool ? traced_.pool.voxels()
                                               : compact().voxel_count();
}

bool BuiltScene::draws_from_file() const {
  constexpr std::size_t kLargeBytes = std::size_t{1} << 30;
  const Bytes own = memory_.bytes();
  const std::uint8_t* const bytes = compact().bytes();
  return structure() == StructureKind::kCompact && compact().size_bytes() >= kLargeBytes &&
         (bytes < own.data || bytes >= own.data + own.size);
}

std::uint64_t BuiltScene::tree_bytes() const {
  return structure() == StructureKind::kDense  ? traced_.dense.used_bytes()
         : structure() == StructureKind::kPool ? traced_.pool.used_bytes()
                                               : compact().size_bytes();
}

}  // namespace thimble::tools
