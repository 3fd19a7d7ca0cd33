// The calls of ray_map.h, and what they need for single rays: the core's answers, and a voxel's face, t and material.
#include "wide/rays/ray_map.h"

#include <algorithm>

#include "thimble/trace/ray.h"
#include "wide/rays/job.h"
#include "wide/rays/leaf_tag.h"

namespace thimble::wide {
namespace {

constexpr int kCubeLevel = 4;  // of MapCells

unsigned octant_of(const Vec3i& voxel, int level) {
  return (static_cast<unsigned>(voxel.x) >> level & 1U) |
         (static_cast<unsigned>(voxel.y) >> level & 1U) << 1 |
         (static_cast<unsigned>(voxel.z) >> level & 1U) << 2;
}
// The child of `level` that a voxel of the node is in. The tree's masks add up, else there would be no map.
uint32_t child_of(const CompactTree& tree, uint32_t node, const Vec3i& voxel, int level) {
  const unsigned before = tree.mask(node) & ((1U << octant_of(voxel, level)) - 1);
  return tree.first_child(node) + static_cast<uint32_t>(__builtin_popcount(before));
}

Status run(const RayMap& map, Span<const Ray> rays, Job job) {
  job.map = &map;
  job.rays = rays.data;
  job.count = rays.size;
  if (job.any != nullptr) {
    std::fill_n(job.any, job.count, uint8_t{0});
  } else if (job.entries != nullptr) {
    std::fill_n(job.entries, job.count, RayPoint{0, 0});
  } else {
    std::fill_n(job.hits, job.count, Hit{});
  }
  if (map.cells() != nullptr && job.count != 0) {
    trace_job(&job);
    return job.status;
  }
  for (size_t i = 0; i < job.count; ++i) {
    trace_by_core(&job, i);
  }
  return job.status;
}

// What the map says about a voxel's leaf.
struct Leaf {
  uint64_t voxels = 0;
  const uint64_t* tag = nullptr;  // only with tags; null in a chunk that is solid through
  uint64_t second = 0;            // the chunk's second word
  unsigned voxel = 0;             // the voxel's bit

  bool holds() const { return (voxels >> voxel & 1U) != 0; }
};
// The word of a voxel's cube.
uint32_t cube_at(const MapCells& cells, const Vec3i& voxel) {
  const auto cube = [&](int axis) { return static_cast<uint64_t>(voxel[axis]) >> kCubeLevel; };
  const int bits = cells.level - kCubeLevel;
  return cells.top[(cube(2) << bits | cube(1)) << bits | cube(0)];
}
Leaf leaf_at(const MapCells& cells, const Vec3i& voxel) {
  const auto bit = [&](int level) {
    const auto part = [&](int axis) { return static_cast<uint64_t>(voxel[axis]) >> level & 3; };
    return part(0) | part(1) << 2 | part(2) << 4;
  };
  const uint32_t cube = cube_at(cells, voxel);
  Leaf leaf;
  if ((cube & 15U) != 0) {
    return leaf;
  }
  const uint64_t* const chunk = cells.chunks + (cube >> 4);
  const uint64_t of_leaf = uint64_t{1} << bit(2);
  if ((*chunk & of_leaf) == 0) {
    return leaf;
  }
  const uint64_t* const at =
      chunk + cells.header() + static_cast<unsigned>(__builtin_popcountll(*chunk & (of_leaf - 1)));
  leaf.voxels = *at;
  leaf.voxel = static_cast<unsigned>(bit(0));
  leaf.second = chunk[1];
  if (cells.has_tags && leaf.second < kSolidChunk) {
    leaf.tag = at + static_cast<unsigned>(__builtin_popcountll(*chunk));
  }
  return leaf;
}

// By axis and a bit for each coordinate 0 .. 3: the cells of 4^3 that have one of them.
struct SheetTable {
  uint64_t of[3][16];
  constexpr SheetTable() : of{} {
    for (unsigned axis = 0; axis < 3; ++axis) {
      for (unsigned bits = 0; bits < 16; ++bits) {
        for (unsigned cell = 0; cell < 64; ++cell) {
          of[axis][bits] |= uint64_t{bits >> (cell >> (2 * axis) & 3U) & 1U} << cell;
        }
      }
    }
  }
};
constexpr SheetTable kSheets;

// Of 4^3 cells of 2^level voxels, from `corner` on, those that reach into a box.
uint64_t cells_in(const VoxelBox& box, const Vec3i& corner, int level) {
  uint64_t cells = UINT64_MAX;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t first = std::clamp((box.low[axis] - corner[axis]) >> level, 0, 4);
    const int32_t last = std::clamp((box.high[axis] - corner[axis] - 1) >> level, -1, 3);
    cells &= kSheets.of[axis][15U << first & 15U >> (3 - last)];
  }
  return cells;
}

// Whether a chunk has a voxel in a box.
bool reaches_into(const VoxelBox& box, const Vec3i& corner, const uint64_t* chunk, uint64_t header) {
  for (uint64_t leaves = *chunk & cells_in(box, corner, 2); leaves != 0; leaves &= leaves - 1) {
    const auto leaf = static_cast<unsigned>(__builtin_ctzll(leaves));
    const auto before = static_cast<unsigned>(__builtin_popcountll(*chunk & ((uint64_t{1} << leaf) - 1)));
    const Vec3i at{corner.x + static_cast<int32_t>(4 * (leaf & 3U)),
                   corner.y + static_cast<int32_t>(leaf & 12U),
                   corner.z + static_cast<int32_t>(leaf >> 4 << 2)};
    if ((chunk[header + before] & cells_in(box, at, 0)) != 0) {
      return true;
    }
  }
  return false;
}

// Looks up the material of a solid voxel where chunks have tags. Returns false where only the tree knows it.
bool look_up(const CompactTree& tree, const Leaf& leaf, uint8_t* material) {
  if (leaf.tag == nullptr) {
    *material = static_cast<uint8_t>(leaf.second);
    return is_solid_chunk(leaf.second);
  }
  const LeafTag tag = LeafTag::of(*leaf.tag);
  const unsigned cell = LeafOrder::cell_of(leaf.voxel);
  if ((tag.plain >> cell & 1U) != 0) {
    *material = tag.material;
    return true;
  }
  const uint64_t before = leaf.voxels & kLeafOrder.before[leaf.voxel] &
                          ~kLeafOrder.cells[static_cast<unsigned>(tag.plain | tag.other)];
  *material = tree.voxel_material(tag.first_voxel + static_cast<uint32_t>(__builtin_popcountll(before)));
  return (tag.other >> cell & 1U) == 0;
}

// The node of 2^3 voxels that a voxel is in, or the larger node that is solid through.
struct Parent {
  uint32_t node;
  int level;
};
Parent parent_of(const RayMap& map, const Vec3i& voxel) {
  const CompactTree& tree = map.tree();
  const MapCells& cells = *map.cells();
  const uint64_t known = cells.chunks[(cube_at(cells, voxel) >> 4) + 1];
  const bool is_known = known < kSolidChunk && tree.level() > kCubeLevel;
  Parent parent{is_known ? static_cast<uint32_t>(known) : 0, is_known ? kCubeLevel : tree.level()};
  while (parent.level > 1 && tree.mask(parent.node) != 0) {
    --parent.level;
    parent.node = child_of(tree, parent.node, voxel, parent.level);
  }
  return parent;
}

// The solid block that holds a voxel: the voxel itself, or a block that coarsening made.
struct Block {
  Vec3i corner;
  int level;
  uint8_t material;
};

Block block_at(const RayMap& map, const Vec3i& voxel, const Leaf& leaf) {
  const CompactTree& tree = map.tree();
  Block block{voxel, 0, tree.uniform_material()};
  if (!map.cells()->has_nodes) {
    return block;
  }
  if (map.cells()->has_tags && look_up(tree, leaf, &block.material)) {
    return block;
  }
  const Parent parent = parent_of(map, voxel);
  if (tree.mask(parent.node) != 0) {
    block.material = tree.voxel_material(child_of(tree, parent.node, voxel, 0));
    return block;
  }
  block.material = tree.block_material(parent.node);
  if (tree.is_merged(parent.node)) {
    const int32_t within = (int32_t{1} << parent.level) - 1;
    block.corner = {voxel.x & ~within, voxel.y & ~within, voxel.z & ~within};
    block.level = parent.level;
  }
  return block;
}

Block block_at(const RayMap& map, const Vec3i& voxel) {
  return block_at(map, voxel, map.cells()->has_tags ? leaf_at(*map.cells(), voxel) : Leaf());
}

// Finds the face by which a ray enters a block, and its t: that of the lower plane that the ray crosses last, on a tie
// that of the lowest axis. Compares products of 23 and 20 bits.
void find_face(const Ray& ray, const Vec3i& corner, int32_t side, Hit* hit) {
  int64_t last = 0;
  int64_t speed = 1;
  int axis = -1;
  for (int a = 0; a < 3; ++a) {
    const int64_t direction = ray.direction[a];
    const int64_t origin = ray.origin[a].raw;
    const int64_t low = int64_t{corner[a]} * Q8::kOne;
    const int64_t way = direction < 0 ? origin - (low + int64_t{side} * Q8::kOne) : low - origin;
    const int64_t size = direction < 0 ? -direction : direction;
    if (way > 0 && (axis < 0 || way * speed > last * size)) {
      axis = a;
      last = way;
      speed = size;
    }
  }
  hit->axis = static_cast<int8_t>(axis);
  hit->t_numerator = axis < 0 ? 0 : static_cast<int32_t>(last);
  hit->t_denominator = axis < 0 ? 1 : static_cast<int32_t>(speed * Q8::kOne);
}

// Makes a hit that does not lie before the ray's point a miss.
void drop_late(const Job& job, size_t ray, Hit* hit) {
  if (hit->kind != HitKind::kHit || job.bound != Bound::kBefore) {
    return;
  }
  const RayPoint& before = job.points[ray * job.point_step];
  // 23 + 31 and 31 + 28 bits.
  if (int64_t{hit->t_numerator} * before.t_denominator >= int64_t{before.t_numerator} * hit->t_denominator) {
    const uint32_t visits = hit->visits;
    *hit = Hit{};
    hit->visits = visits;
  }
}

// Stores what a job wants of a hit without its voxel.
void put_class(Job* job, size_t ray, const Hit& hit) {
  if (hit.kind != HitKind::kHit) {
    return;
  }
  const uint8_t found = job->classes == nullptr ? uint8_t{1} : job->classes[hit.material];
  if (job->any != nullptr) {
    job->any[ray] = found;
  } else if (found != 0) {
    job->entries[ray] = {hit.t_numerator, hit.t_denominator};
  }
}

}  // namespace

void trace_by_core(Job* job, size_t ray) {
  const CompactTree& tree = job->map->tree();
  Hit hit;
  const Status status = job->bound == Bound::kFrom
                            ? closest_hit_from(tree, job->rays[ray], job->points[ray], &hit)
                            : closest_hit(tree, job->rays[ray], &hit);
  if (job->status == Status::kOk) {
    job->status = status;
  }
  drop_late(*job, ray, &hit);
  if (job->hits != nullptr) {
    job->hits[ray] = hit;
  } else {
    put_class(job, ray, hit);
  }
}

void put_hit(Job* job, size_t number, const Vec3i& cell, uint32_t visits) {
  const Ray& ray = job->rays[number];
  const int32_t last = (int32_t{1} << job->map->cells()->level) - 1;
  Vec3i voxel = cell;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] < 0) {
      voxel[axis] = last - cell[axis];
    }
  }
  // Written where it stays: a copy would be read just after it was written in pieces, and wait.
  Hit own;
  Hit& hit = job->hits != nullptr ? job->hits[number] : own;
  hit.visits = visits;
  hit.kind = HitKind::kHit;
  const auto enter = [&](const Block& block) {
    hit.voxel = block.corner;
    hit.block_level = static_cast<uint8_t>(block.level);
    hit.material = block.material;
    find_face(ray, block.corner, int32_t{1} << block.level, &hit);
  };
  if (job->hits == nullptr) {
    find_face(ray, voxel, 1, &hit);  // a merged block is entered at the same t
  } else if (!job->names && !job->map->tree().merged()) {
    enter({voxel, 0, job->map->tree().uniform_material()});
  } else {
    enter(block_at(*job->map, voxel));
  }
  drop_late(*job, number, &hit);
  if (job->hits != nullptr) {
    return;
  }
  if (job->classes != nullptr && hit.kind == HitKind::kHit) {
    hit.material = block_at(*job->map, voxel).material;
  }
  put_class(job, number, hit);
}

Status any_hit(const RayMap& map, Span<const Ray> rays, Span<uint8_t> hit, const uint8_t* classes) {
  return run(map, rays, {.any = hit.data, .classes = classes});
}

Status any_hit_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before, Span<uint8_t> hit,
                      const uint8_t* classes) {
  return run(map, rays,
             {.points = before.data, .bound = Bound::kBefore, .any = hit.data, .classes = classes});
}

Status first_hit(const RayMap& map, Span<const Ray> rays, Span<Hit> hits) {
  return run(map, rays, {.hits = hits.data});
}

Status first_hit_from(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> from, Span<Hit> hits) {
  return run(map, rays, {.points = from.data, .bound = Bound::kFrom, .hits = hits.data});
}

Status first_hit_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before,
                        Span<Hit> hits) {
  return run(map, rays, {.points = before.data, .bound = Bound::kBefore, .hits = hits.data});
}

Status first_hit_within(const RayMap& map, Span<const Ray> rays, const RayPoint& before, Span<Hit> hits,
                        bool with_materials) {
  return run(map, rays,
             {.points = &before,
              .bound = Bound::kBefore,
              .point_step = 0,
              .hits = hits.data,
              .names = with_materials});
}

Status first_entry_before(const RayMap& map, Span<const Ray> rays, RayPoint before, Span<RayPoint> entries,
                          const uint8_t* classes) {
  return run(map, rays,
             {.points = &before,
              .bound = Bound::kBefore,
              .point_step = 0,
              .entries = entries.data,
              .names = false,
              .classes = classes});
}

bool RayMap::material_at(const Vec3i& voxel, uint8_t* material) const {
  const int32_t side = int32_t{1} << tree_.level();
  for (int axis = 0; axis < 3; ++axis) {
    if (voxel[axis] < 0 || voxel[axis] >= side) {
      return false;
    }
  }
  if (cells() == nullptr) {
    return thimble::material_at(tree_, voxel, material);
  }
  const Leaf leaf = leaf_at(cells_, voxel);
  if (!leaf.holds()) {
    return false;
  }
  *material = block_at(*this, voxel, leaf).material;
  return true;
}

bool RayMap::is_empty(const VoxelBox& box) const {
  if (cells() == nullptr) {
    return false;
  }
  const int bits = cells_.level - kCubeLevel;
  Vec3i low;  // in cubes
  Vec3i end;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(box.low[axis], 0) >> kCubeLevel;
    end[axis] = (std::min(box.high[axis], int32_t{1} << cells_.level) + 15) >> kCubeLevel;
  }
  for (int32_t z = low.z; z < end.z; ++z) {
    for (int32_t y = low.y; y < end.y; ++y) {
      const uint32_t* const row =
          cells_.top + ((static_cast<size_t>(z) << bits | static_cast<size_t>(y)) << bits);
      for (int32_t x = low.x; x < end.x; ++x) {
        if ((row[x] & 15U) == 0 &&
            reaches_into(box, {16 * x, 16 * y, 16 * z}, cells_.chunks + (row[x] >> 4), cells_.header())) {
          return false;
        }
      }
    }
  }
  return true;
}

}  // namespace thimble::wide
