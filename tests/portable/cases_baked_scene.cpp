// A baked scene: what comes back out of its bytes, and what is refused.
#include "portable/groups.h"
#include "portable/scene.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/base/memory.h"

namespace thimble::portable {
namespace {

constexpr Rgb8 kColors[] = {{1, 2, 3}, {200, 100, 50}, {9, 8, 7}};
constexpr uint8_t kName[] = {'a', ' ', 's', 'c', 'e', 'n', 'e'};
constexpr uint32_t kBytes = 2048;
constexpr size_t kChecksumOffset = 8;

SceneCamera view_of(bool perspective) {
  SceneCamera camera;
  camera.eye = point_q8(-700, -900, 1500);
  camera.target = point_q8(1024, 1024, 1000);
  camera.fov_degrees = Q16::saturate(40);
  if (!perspective) {
    camera.is_perspective = false;
    camera.direction_bits = 12;
    camera.forward = {3, 5, -2};
    camera.up = {0, 1, 4};
    camera.span = Q14::saturate(12);
  }
  return camera;
}

// A tree of level 3 with two materials and a solid block, in `check.world.compact`.
bool make_tree(Check& check) {
  return make_pool(check, 60, 3) &&
         check.equal(check.world.pool.insert_block({0, 0, 0}, 1, 1), Status::kOk,
                     THIMBLE_WHAT("insert_block")) &&
         check.equal(check.world.pool.insert({4, 4, 3}, 2), Status::kOk, THIMBLE_WHAT("insert")) &&
         check.equal(check.world.pool.insert({6, 1, 7}, 0), Status::kOk, THIMBLE_WHAT("insert")) &&
         make_compact(check);
}
BakedParts parts_of(const Check& check, const SceneCamera* camera) {
  BakedParts parts;
  parts.tree = {check.world.compact.bytes(), check.world.compact.size_bytes()};
  parts.palette = Span<const Rgb8>(kColors);
  parts.camera = camera;
  parts.name = kName;
  return parts;
}
// The whole scene; an empty span when anything failed.
Bytes make_scene(Check& check, bool perspective = true) {
  if (!make_tree(check)) {
    return {};
  }
  const SceneCamera camera = view_of(perspective);
  const BakedParts parts = parts_of(check, &camera);
  const Bytes bytes = check.arena.take(baked_bytes(parts), 4);
  return check.equal(BakedScene::make(parts, bytes, nullptr), Status::kOk, THIMBLE_WHAT("bake")) ? bytes
                                                                                                 : Bytes();
}

uint32_t word_at(ConstBytes bytes, size_t at) {
  return static_cast<uint32_t>(bytes[at]) | static_cast<uint32_t>(bytes[at + 1]) << 8 |
         static_cast<uint32_t>(bytes[at + 2]) << 16 | static_cast<uint32_t>(bytes[at + 3]) << 24;
}
void set_word(Bytes bytes, size_t at, uint32_t word) {
  for (size_t i = 0; i < 4; ++i) {
    bytes[at + i] = static_cast<uint8_t>(word >> (8 * i));
  }
}
void repair_checksum(Bytes bytes) {
  const uint32_t front = crc32(bytes.subspan(0, kChecksumOffset));
  set_word(bytes, kChecksumOffset, crc32(bytes.subspan(kChecksumOffset + 4), front));
}

void same_parts(Check& check, int perspective) {
  const Bytes bytes = make_scene(check, perspective != 0);
  THIMBLE_REQUIRE(!bytes.empty());
  BakedScene scene;
  THIMBLE_REQUIRE_OK(BakedScene::open(bytes, &scene));
  THIMBLE_EQUAL(scene.validate(), Status::kOk);
  const ConstBytes tree(check.world.compact.bytes(), check.world.compact.size_bytes());
  THIMBLE_CHECK(check.equal(scene.section(SectionKind::kTree), tree, THIMBLE_WHAT("bytes of the tree")));
  THIMBLE_CHECK(check.equal(scene.section(SectionKind::kName), ConstBytes(kName), THIMBLE_WHAT("name")));
  THIMBLE_EQUAL(scene.palette().size, 3U);
  THIMBLE_EQUAL(scene.palette()[1], kColors[1]);
  THIMBLE_CHECK(scene.has_camera());
  const SceneCamera wanted = view_of(perspective != 0);
  const SceneCamera& camera = scene.camera();
  THIMBLE_EQUAL(camera.is_perspective, wanted.is_perspective);
  THIMBLE_EQUAL(camera.direction_bits, wanted.direction_bits);
  THIMBLE_EQUAL(camera.forward, wanted.forward);
  THIMBLE_EQUAL(camera.up, wanted.up);
  THIMBLE_EQUAL(camera.eye.z.raw, 1500);
  THIMBLE_EQUAL(camera.target.y.raw, 1024);
  THIMBLE_EQUAL(camera.fov_degrees.raw, wanted.fov_degrees.raw);
  THIMBLE_EQUAL(camera.span.raw, wanted.span.raw);
  THIMBLE_CHECK(scene.section(SectionKind::kBrickMap).empty());
  check.note_bytes(bytes);
}

void its_camera(Check& check, int perspective) {
  const SceneCamera baked = view_of(perspective != 0);
  THIMBLE_REQUIRE_OK(set_camera(baked, 20, 10, 3, &check.camera));
  const Ray corner = check.camera.ray(0, 0);
  const Ray middle = check.camera.ray(10, 5);
  if (perspective != 0) {
    const PerspectiveView view{baked.eye, look_at(baked.eye, baked.target), {}, baked.fov_degrees, 20, 10, 0};
    THIMBLE_REQUIRE_OK(check.camera.set(view, 3));
  } else {
    const OrthographicView view{baked.eye, baked.forward, baked.up, baked.span, 20, 10, 12};
    THIMBLE_REQUIRE_OK(check.camera.set(view, 3));
  }
  THIMBLE_EQUAL(corner.direction, check.camera.ray(0, 0).direction);
  THIMBLE_EQUAL(corner.origin.x, check.camera.ray(0, 0).origin.x);
  THIMBLE_EQUAL(middle.direction, check.camera.ray(10, 5).direction);
  check.note(corner);
  check.note(middle);
}

// Bytes changed here and there, with or without a checksum that hides it: refused, or safe to trace.
void damaged(Check& check, int repaired) {
  const Bytes bytes = make_scene(check);
  THIMBLE_REQUIRE(!bytes.empty());
  Random random{static_cast<uint32_t>(9 + repaired)};
  int refused = 0;
  for (int round = 0; round < 60; ++round) {
    const size_t at = static_cast<size_t>(random.below(static_cast<int32_t>(bytes.size)));
    const uint8_t before = bytes[at];
    const uint32_t checksum = word_at(bytes, kChecksumOffset);
    bytes[at] = static_cast<uint8_t>(before ^ (1 + random.below(255)));
    if (repaired != 0) {
      repair_checksum(bytes);
    }
    BakedScene scene;
    const Status status = BakedScene::open(bytes, &scene);
    refused += status == Status::kOk ? 0 : 1;
    if (repaired == 0) {
      THIMBLE_CHECK(BakedScene::validate(bytes) != nullptr);
    }
    check.note(static_cast<int64_t>(status));
    bytes[at] = before;
    set_word(bytes, kChecksumOffset, checksum);
  }
  THIMBLE_CHECK(refused > 0);
  THIMBLE_CHECK(BakedScene::validate(bytes) == nullptr);
}

constexpr Case kCases[] = {
    {"baked and opened -> tree, palette, camera and name as they were", kBytes, same_parts, 1, "perspective"},
    {"baked and opened -> tree, palette, camera and name as they were", kBytes, same_parts, 0, "parallel"},
    {"its bytes -> magic, size, checksum and list where the format says", kBytes,
     [](Check& check, int) {
       const Bytes bytes = make_scene(check);
       THIMBLE_REQUIRE(!bytes.empty());
       THIMBLE_EQUAL(word_at(bytes, 0), 0x01534D54U);
       THIMBLE_EQUAL(word_at(bytes, 4), bytes.size);
       const uint32_t front = crc32(bytes.subspan(0, kChecksumOffset));
       THIMBLE_EQUAL(word_at(bytes, 8), crc32(bytes.subspan(12), front));
       THIMBLE_EQUAL(word_at(bytes, 12), 4U);
       THIMBLE_EQUAL(word_at(bytes, 16), 1U);
       THIMBLE_EQUAL(word_at(bytes, 20), kBakedHeaderBytes + 4 * kBakedEntryBytes);
       THIMBLE_EQUAL(word_at(bytes, 24), check.world.compact.size_bytes());
     }},
    {"its camera -> the rays of the view that it was made from", 0, its_camera, 1, "perspective"},
    {"its camera -> the rays of the view that it was made from", 0, its_camera, 0, "parallel"},
    {"the tree alone -> no palette, no camera, no name", kBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_tree(check));
       BakedParts parts;
       parts.tree = {check.world.compact.bytes(), check.world.compact.size_bytes()};
       const Bytes bytes = check.arena.take(baked_bytes(parts), 4);
       THIMBLE_REQUIRE_OK(BakedScene::make(parts, bytes, nullptr));
       BakedScene scene;
       THIMBLE_REQUIRE_OK(BakedScene::open(bytes, &scene));
       THIMBLE_CHECK(scene.palette().empty());
       THIMBLE_CHECK(!scene.has_camera());
       THIMBLE_CHECK(scene.section(SectionKind::kName).empty());
     }},
    {"no tree -> bad argument", kBytes,
     [](Check& check, int) {
       THIMBLE_EQUAL(BakedScene::make({}, check.arena.take(kBytes), nullptr), Status::kBadArgument);
     }},
    {"a tree cut short -> bad argument", kBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_tree(check));
       BakedParts parts;
       parts.tree = {check.world.compact.bytes(), check.world.compact.size_bytes() - 1};
       THIMBLE_EQUAL(BakedScene::make(parts, check.arena.take(512), nullptr), Status::kBadArgument);
     }},
    {"an output that is too small -> out of memory, not a byte written", kBytes,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_tree(check));
       const SceneCamera camera = view_of(true);
       const BakedParts parts = parts_of(check, &camera);
       const Bytes bytes = check.arena.take(baked_bytes(parts), 4);
       for (uint8_t& byte : bytes) {
         byte = 0x5A;
       }
       for (size_t size = 0; size < bytes.size; size += 7) {
         THIMBLE_EQUAL(BakedScene::make(parts, bytes.subspan(0, size), nullptr), Status::kOutOfMemory);
       }
       bool untouched = true;
       for (const uint8_t byte : bytes) {
         untouched = untouched && byte == 0x5A;
       }
       THIMBLE_CHECK(untouched);
     }},
    {"every truncation -> refused", kBytes,
     [](Check& check, int) {
       const Bytes bytes = make_scene(check);
       THIMBLE_REQUIRE(!bytes.empty());
       BakedScene scene;
       for (size_t size = 0; size < bytes.size; size += 5) {
         THIMBLE_EQUAL(BakedScene::open(bytes.subspan(0, size), &scene), Status::kDamaged);
       }
       THIMBLE_CHECK(scene.bytes().empty());
     }},
    {"more bytes behind it -> not looked at", kBytes,
     [](Check& check, int) {
       const Bytes bytes = make_scene(check);
       THIMBLE_REQUIRE(!bytes.empty());
       const ConstBytes longer(bytes.data, bytes.size + 8);
       BakedScene scene;
       THIMBLE_REQUIRE_OK(BakedScene::open(longer, &scene));
       THIMBLE_EQUAL(scene.bytes().size, bytes.size);
     }},
    {"bytes changed -> never valid", kBytes, damaged, 0},
    {"bytes changed under a right checksum -> opened or refused, the same everywhere", kBytes, damaged, 1},
    {"traced where it lies -> the hit of the tree that it was made from", kBytes,
     [](Check& check, int) {
       const Bytes bytes = make_scene(check);
       THIMBLE_REQUIRE(!bytes.empty());
       const Span<BakedScene> scene = check.take<BakedScene>(1);
       THIMBLE_REQUIRE_OK(BakedScene::open(bytes, scene.data));
       check.world.compact = scene[0].tree();
       THIMBLE_REQUIRE_OK(closest(check, 2, ray_q8({-500, 1100, 900}, {9, 0, 0}), check.options));
       THIMBLE_EQUAL(check.hit.voxel, (Vec3i{4, 4, 3}));
       THIMBLE_EQUAL(check.hit.material, 2);
     }},
};

}  // namespace

const Group kBakedSceneGroup = group_of<kCases>("baked scene", "cases_baked_scene.cpp");

}  // namespace thimble::portable
