// Other shapes of a world: one that is edited, the map of bricks, the tree whose equal parts are stored once; and the
// section that says what light does.
#include "portable/groups.h"
#include "portable/scene.h"
#include "thimble/base/memory.h"
#include "thimble/light/scene.h"
#include "thimble/trace/secondary_ray.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/edited_world.h"
#include "thimble/tree/shared_tree.h"

namespace thimble::portable {
namespace {

constexpr int kLevel = 4;
constexpr int32_t kSide = 16;
constexpr uint32_t kPoolNodes = 165;
constexpr uint32_t kTreeBytes = 480;
constexpr uint32_t kPoolBytes = (static_cast<uint32_t>(Octree::octree_bytes(kPoolNodes)) + 7) & ~7U;

constexpr SolidBox kBoxes[] = {
    {{{0, 0, 0}, {16, 16, 4}}, 1}, {{{4, 4, 4}, {8, 8, 8}}, 2},   {{{8, 8, 4}, {12, 10, 7}}, 3},
    {{{5, 5, 8}, {6, 6, 13}}, 4},  {{{12, 0, 4}, {16, 3, 6}}, 2}, {{{0, 12, 4}, {2, 16, 9}}, 5},
};

bool make_world(Check& check) {
  return make_pool(check, kPoolNodes, kLevel, kBoxes) && make_compact(check);
}
Vec3i nth_voxel(int32_t n) {
  return {n & 15, n >> 4 & 15, n >> 8};
}

// --- A world that is edited is the world built anew.

constexpr EditRoom kRoom{150, 200, 30};
constexpr uint32_t kEditBytes = static_cast<uint32_t>(edited_world_bytes(kLevel, kRoom));
constexpr uint32_t kEditArena = kPoolBytes + kTreeBytes + kEditBytes + sizeof(EditedWorld) + 64;
static_assert(kEditArena + kTreeBytes <= kCommonArenaBytes);

// The pool's voxels as they should be, packed both ways.
bool same_packed(Check& check, const EditedWorld& world) {
  size_t size = 0;
  const size_t mark = check.arena.used_bytes();
  const Status asked = world.pack({}, &size);
  const Bytes packed = check.arena.take(size, 8);
  uint32_t crc = 0;
  bool same = check.equal(asked, Status::kOutOfMemory, THIMBLE_WHAT("pack into nothing")) &&
              check.equal(world.pack(packed), Status::kOk, THIMBLE_WHAT("pack"));
  if (same) {
    crc = crc32(packed);
    size_t built = 0;
    for (uint8_t& byte : packed) {
      byte = 0;
    }
    same = check.equal(CompactTree::make(check.world.pool, packed, nullptr, &built), Status::kOk,
                       THIMBLE_WHAT("built anew")) &&
           check.equal(built, size, THIMBLE_WHAT("bytes of the tree built anew")) &&
           check.equal(crc32(packed), crc, THIMBLE_WHAT("bytes as built anew"));
  }
  check.arena.rewind(mark);
  return same;
}

bool same_materials(Check& check, const EditedWorld& world) {
  const BrickMap& map = world.map();
  const VoxelBox& box = map.box();
  bool same = map.belongs_to(world.tree());
  for (int32_t n = 0; n < kSide * kSide * kSide; ++n) {
    const Vec3i voxel = nth_voxel(n);
    uint8_t in_tree = 0;
    const bool solid = material_at(world.tree(), voxel, &in_tree);
    // The cell of the directory, its brick and its bit.
    const Vec3i cell{(voxel.x >> 2) - box.low.x, (voxel.y >> 2) - box.low.y, (voxel.z >> 2) - box.low.z};
    const Vec3i size{box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z};
    bool in_map =
        cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < size.x && cell.y < size.y && cell.z < size.z;
    if (in_map) {
      const uint8_t* entry = map.directory() + 2 * ((cell.z * size.y + cell.y) * size.x + cell.x);
      const uint32_t number = entry[0] | static_cast<uint32_t>(entry[1]) << 8;
      const unsigned bit = static_cast<unsigned>((voxel.x & 3) | (voxel.y & 3) << 2 | (voxel.z & 3) << 4);
      in_map = number != 0 && (map.bricks()[8 * number + bit / 8] >> (bit & 7) & 1) != 0;
      same = same && (!in_map || map.material(world.tree(), number, bit) == in_tree);
    }
    same = same && in_map == solid;
  }
  return check.that(same, THIMBLE_WHAT("the map holds what the tree holds"));
}

void edits(Check& check, int index) {
  THIMBLE_REQUIRE(make_world(check));
  const Span<EditedWorld> place = check.take<EditedWorld>(1);
  const Bytes bytes = check.arena.take(kEditBytes);
  THIMBLE_REQUIRE(place.size == 1 && bytes.size == kEditBytes);
  EditedWorld& world = place[0];
  world = EditedWorld();
  const EditRoom least = EditedWorld::room_of(check.world.compact);
  check.note(least.nodes);
  check.note(least.leaves);
  check.note(least.bricks);
  const EditRoom most = EditedWorld::room_in(check.world.compact, kEditBytes);
  check.note(most.nodes);
  check.note(most.leaves);
  check.note(most.bricks);
  EditRoom short_of = least;
  (index == 0 ? short_of.nodes : index == 1 ? short_of.leaves : short_of.bricks) -= 1;
  THIMBLE_EQUAL(EditedWorld::make(check.world.compact, short_of, bytes, &world), Status::kOutOfMemory);
  THIMBLE_EQUAL(EditedWorld::make(check.world.compact, kRoom, bytes.subspan(8), &world),
                Status::kOutOfMemory);
  THIMBLE_REQUIRE_OK(EditedWorld::make(check.world.compact, kRoom, bytes, &world));
  THIMBLE_REQUIRE(same_packed(check, world) && same_materials(check, world));
  Random random{static_cast<uint32_t>(0x1234567 + 77 * index)};
  Octree& pool = check.world.pool;
  for (int i = 0; i < (index == 0 ? 36 : 60); ++i) {
    Vec3i voxel = random.vector(kSide);
    if (index == 1) {
      // Close together, so that blocks become solid and open again.
      voxel = {voxel.x & 3, voxel.y & 1, 4 + (voxel.z & 1)};
    } else if (index == 2) {
      voxel = {4 + (voxel.x & 3), 4 + (voxel.y & 3), 4 + (voxel.z & 3)};
    }
    const bool put = index == 1 ? i % 8 != 7 : random.below(3) == 0;
    const uint8_t material = static_cast<uint8_t>(index == 1 ? 2 : 1 + random.below(5));
    const size_t voxels_before = static_cast<size_t>(world.tree().voxel_count());
    const Status status = put ? world.set(voxel, material) : world.clear(voxel);
    check.note(static_cast<int64_t>(status));
    if (status == Status::kOk) {
      const Status in_pool = put ? pool.insert(voxel, material) : pool.remove(voxel);
      check.note(static_cast<int64_t>(in_pool));
      if (in_pool != Status::kOk) {
        // Nodes of the pool take more than those of the tree.
        THIMBLE_EQUAL(in_pool, Status::kOutOfMemory);
        THIMBLE_CHECK(i >= 20);
        break;
      }
    } else {
      THIMBLE_EQUAL(status, Status::kOutOfMemory);
      THIMBLE_EQUAL(static_cast<size_t>(world.tree().voxel_count()), voxels_before);
    }
    check.note(static_cast<int64_t>(world.tree().voxel_count()));
    check.note(world.free_room().nodes);
    check.note(world.free_room().leaves);
    check.note(world.free_room().bricks);
    if (i % 6 == 5) {
      THIMBLE_REQUIRE(same_materials(check, world));
      check.note(world.bounds().low.x + 100 * world.bounds().high.z);
      // Bounds only grow, in the tree and in the pool.
      THIMBLE_REQUIRE(same_packed(check, world));
    }
  }
  THIMBLE_EQUAL(world.set({kSide, 0, 0}, 1), Status::kOutOfRange);
  THIMBLE_EQUAL(world.clear({0, -1, 0}), Status::kOutOfRange);
}

// --- Tables as bytes: what is written is read back, and any byte that changes is seen.

// Every byte of `bytes` in turn, changed: how many of the changes `fault` tells.
template <class Fault>
void damage(Check& check, Bytes bytes, const Fault& fault) {
  uint32_t told = 0;
  for (size_t i = 0; i < bytes.size; ++i) {
    bytes[i] = static_cast<uint8_t>(bytes[i] ^ 0x41);
    told += fault() ? 1U : 0U;
    bytes[i] = static_cast<uint8_t>(bytes[i] ^ 0x41);
  }
  THIMBLE_EQUAL(told, static_cast<uint32_t>(bytes.size));
  THIMBLE_CHECK(!fault());
}

constexpr uint32_t kMapBytes = static_cast<uint32_t>(most_brick_map_bytes(kLevel));
constexpr uint32_t kMapArena = kPoolBytes + kTreeBytes + kMapBytes + sizeof(BrickMap) + 64;

void brick_map(Check& check, int /*index*/) {
  THIMBLE_REQUIRE(make_world(check));
  const Span<BrickMap> map = check.take<BrickMap>(1);
  size_t size = 0;
  THIMBLE_EQUAL(BrickMap::make(check.world.compact, {}, nullptr, &size), Status::kOutOfMemory);
  check.note(static_cast<int64_t>(size));
  const Bytes bytes = check.arena.take(kMapBytes);
  THIMBLE_REQUIRE(map.size == 1 && bytes.size == kMapBytes);
  map[0] = BrickMap();
  size_t written = 0;
  THIMBLE_REQUIRE_OK(BrickMap::make(check.world.compact, bytes, &map[0], &written));
  const Bytes whole = bytes.subspan(0, written);
  check.note_bytes(whole);
  THIMBLE_CHECK(map[0].belongs_to(check.world.compact));
  THIMBLE_EQUAL(map[0].size_bytes(), written);
  check.note(map[0].brick_count());
  check.note(map[0].mixed_count());
  THIMBLE_REQUIRE_OK(BrickMap::open(whole, &map[0]));
  damage(check, whole, [&] {
    // What is opened without a look at all of it must at least stay inside.
    static_cast<void>(BrickMap::open(whole, &map[0]));
    return BrickMap::validate(whole) != nullptr;
  });
  for (size_t short_by = 1; short_by < written; short_by += 17) {
    THIMBLE_CHECK(BrickMap::validate(whole.subspan(0, written - short_by)) != nullptr);
    THIMBLE_CHECK(BrickMap::open(whole.subspan(0, written - short_by), &map[0]) != Status::kOk);
  }
}

constexpr uint32_t kSharedBytes = 1100;

void shared_tree(Check& check, int /*index*/) {
  THIMBLE_REQUIRE(make_world(check));
  const Span<SharedTree> tree = check.take<SharedTree>(1);
  const Bytes bytes = check.arena.take(kSharedBytes);
  const Bytes work = check.arena.take(check.arena.free_bytes() & ~size_t{7});
  THIMBLE_REQUIRE(tree.size == 1 && bytes.size == kSharedBytes);
  tree[0] = SharedTree();
  SharedBuild build;
  THIMBLE_REQUIRE_OK(SharedTree::make(check.world.compact, bytes, work, &tree[0], &build));
  check.note(static_cast<int64_t>(build.bytes));
  check.note(tree[0].node_count());
  check.note(tree[0].leaf_count());
  check.note(tree[0].link_bytes());
  check.note(static_cast<int64_t>(tree[0].bytes_with_materials()));
  THIMBLE_EQUAL(tree[0].voxel_count(), check.world.compact.voxel_count());
  const Bytes whole = bytes.subspan(0, build.bytes);
  check.note_bytes(whole);
  THIMBLE_EQUAL(SharedTree::make(check.world.compact, bytes.subspan(0, build.bytes - 1), work, &tree[0]),
                Status::kOutOfMemory);
  THIMBLE_EQUAL(SharedTree::make(check.world.compact, bytes, work.subspan(0, 64), &tree[0]),
                Status::kOutOfMemory);
  THIMBLE_REQUIRE_OK(SharedTree::make(check.world.compact, bytes, work, &tree[0], &build));
  THIMBLE_REQUIRE_OK(SharedTree::open(whole, &tree[0]));
  for (int32_t n = 0; n < kSide * kSide * kSide; ++n) {
    uint8_t wanted = 0;
    if (material_at(check.world.compact, nth_voxel(n), &wanted)) {
      THIMBLE_REQUIRE(tree[0].material(nth_voxel(n)) == wanted);
    }
  }
  damage(check, whole, [&] {
    static_cast<void>(SharedTree::open(whole, &tree[0]));
    return SharedTree::validate(whole, work) != nullptr;
  });
  for (size_t short_by = 1; short_by < whole.size; short_by += 11) {
    THIMBLE_CHECK(SharedTree::validate(whole.subspan(0, whole.size - short_by), work) != nullptr);
  }
}

// --- What light does.

constexpr Surface kSurfaces[] = {
    {{1, 2, 3}, SurfaceKind::kMetal, 4, 5, 4096, 6, 7},
    {{9, 8, 7}, SurfaceKind::kMedia, 0, 255, 0x3456, 0x789A, 0xBCDE},
};
constexpr Light kLights[] = {
    {false, PackedVec3i{-5, 9, 16}, {230, 220, 200}, 32},
    {true, PackedVec3i{12 * 256, 10 * 256, 9 * 256}, {1, 2, 65535}, 6},
};
constexpr uint32_t kLightingBytes = 400;
constexpr uint32_t kLightingArena = kLightingBytes + 2 * sizeof(BakedLighting) + 64;

void lighting(Check& check, int /*index*/) {
  const Span<BakedLighting> both = check.take<BakedLighting>(2);
  THIMBLE_REQUIRE(both.size == 2);
  both[0] = BakedLighting();
  both[1] = BakedLighting();
  LitScene& scene = both[0].scene;
  scene.surfaces = {kSurfaces, 2};
  scene.lights = {kLights, 2};
  scene.has_shadows = true;
  scene.has_sky = true;
  scene.fog.density_q16 = 0xBEEF;
  scene.occlusion = {16, 22, 0x2324};
  scene.has_water = true;
  scene.water = still_water({3, 4, 5}, 8, 7, 6 * 256 + 7);
  scene.bounces = 7;
  both[0].effects = Effect::kAll & ~Effect::kFog;
  check.note(effects_of(scene));
  const size_t size = lighting_bytes(scene);
  check.note(static_cast<int64_t>(size));
  const Bytes bytes = check.arena.take(size, 8);
  THIMBLE_REQUIRE(bytes.size == size);
  THIMBLE_EQUAL(BakedLighting::make(both[0], kLevel, bytes.subspan(0, size - 1)), Status::kOutOfMemory);
  THIMBLE_REQUIRE_OK(BakedLighting::make(both[0], kLevel, bytes));
  check.note_bytes(bytes);
  THIMBLE_CHECK(BakedLighting::validate(bytes, kLevel) == nullptr);
  THIMBLE_REQUIRE_OK(BakedLighting::open(bytes, kLevel, &both[1]));
  const LitScene& back = both[1].scene;
  THIMBLE_EQUAL(both[1].effects, both[0].effects);
  THIMBLE_EQUAL(back.surfaces.size, size_t{2});
  THIMBLE_EQUAL(back.lights.size, size_t{2});
  THIMBLE_REQUIRE(back.surfaces.size == 2 && back.lights.size == 2);
  THIMBLE_CHECK(back.surfaces[1] == kSurfaces[1] && back.lights[1] == kLights[1]);
  THIMBLE_CHECK(back.sky == scene.sky && back.fog == scene.fog && back.occlusion == scene.occlusion);
  THIMBLE_EQUAL(back.bounces, scene.bounces);
  // Any byte that changes is refused, or says something else that is allowed: the same everywhere.
  for (size_t i = 0; i < size; ++i) {
    for (int flip = 0x01; flip <= 0x80; flip += 0x7F) {
      bytes[i] = static_cast<uint8_t>(bytes[i] ^ flip);
      uint32_t place = 0;
      const bool fault = BakedLighting::validate(bytes, kLevel, &place) != nullptr;
      check.note(fault ? 1 + static_cast<int64_t>(place) : 0);
      THIMBLE_CHECK((BakedLighting::open(bytes, kLevel, &both[1]) == Status::kOk) == !fault);
      bytes[i] = static_cast<uint8_t>(bytes[i] ^ flip);
    }
  }
  for (EffectSet effect = 1; effect < Effect::kAll; effect <<= 1) {
    for (const char* c = effect_name(effect); *c != 0; ++c) {
      check.note(*c);
    }
  }
}

constexpr Case kCases[] = {
    {"voxels put and dug anywhere -> the world built anew", kCommonArenaBytes, edits, 0},
    {"voxels put together -> blocks become solid, as built anew", kCommonArenaBytes, edits, 1},
    {"a solid block dug out and filled -> as built anew", kCommonArenaBytes, edits, 2},
    {"a map of bricks -> the same bytes; a byte changed is seen", kMapArena, brick_map},
    {"a tree whose equal parts are stored once -> the same bytes and materials; a byte changed is seen",
     kCommonArenaBytes, shared_tree},
    {"what light does, as bytes -> read back; a byte changed is seen or allowed everywhere", kLightingArena,
     lighting},
};

}  // namespace

const Group kWorldGroup = group_of<kCases>("worlds", "cases_worlds.cpp");

}  // namespace thimble::portable
