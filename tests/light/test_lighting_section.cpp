// The section of a baked scene that says what light does: its bytes, what comes back, what is refused.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "support/baked_damage.h"
#include "support/scene_under_test.h"
#include "thimble/light/scene.h"
#include "thimble/tree/octree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

constexpr int kLevel = 5;

// Everything that a section can say, none of it as it is by default.
struct Whole {
  Whole() {
    surfaces[0] = {{1, 2, 3}, SurfaceKind::kMetal, 4, 5, 4096, 6, 7};
    surfaces[1] = {{9, 8, 7}, SurfaceKind::kMedia, 0, 255, 0x3456, 0x789A, 0xBCDE};
    lights[0].place = {-16384, 5, 16384};
    lights[0].color_q8[1] = 0x1234;
    lights[1] = {true, {-4 * 32 * 256, 77, 5 * 32 * 256}, {1, 2, 65535}, 1};
    LitScene& scene = lighting.scene;
    scene.surfaces = Span<const Surface>(surfaces);
    scene.lights = Span<const Light>(lights);
    scene.ambient_q8[0] = 0x0102;
    scene.ambient_q8[1] = 0x0304;
    scene.ambient_q8[2] = 0x0506;
    scene.has_shadows = scene.has_sky = scene.has_depth_cue = true;
    scene.sky = {{10, 11, 12}, {13, 14, 15}, {16, 17, 18}};
    scene.fog = {{19, 20, 21}, 0xDEADBEEF};
    scene.occlusion = {16, 22, 0x2324};
    scene.has_water = true;
    scene.water = still_water({3, 4, 5}, 20, 21, 26 * 256 + 7);
    scene.water_material = {{25, 26, 27}, SurfaceKind::kGlass, 28, 29, 8192, 30, 31};
    scene.bounces = 7;
    lighting.effects = Effect::kAll & ~Effect::kFog;
  }
  Whole(const Whole&) = delete;
  Whole& operator=(const Whole&) = delete;

  std::vector<std::uint8_t> bytes(int level = kLevel) const {
    std::vector<std::uint8_t> result(lighting_bytes(lighting.scene));
    REQUIRE(BakedLighting::make(lighting, level, {result.data(), result.size()}) == Status::kOk);
    return result;
  }

  Surface surfaces[2];
  Light lights[2];
  BakedLighting lighting;
};

bool same(const LitScene& a, const LitScene& b) {
  return std::equal(a.surfaces.begin(), a.surfaces.end(), b.surfaces.begin(), b.surfaces.end()) &&
         std::equal(a.lights.begin(), a.lights.end(), b.lights.begin(), b.lights.end()) &&
         std::equal(a.ambient_q8, a.ambient_q8 + 3, b.ambient_q8) && a.has_shadows == b.has_shadows &&
         a.has_sky == b.has_sky && a.has_depth_cue == b.has_depth_cue && a.sky == b.sky && a.fog == b.fog &&
         a.occlusion == b.occlusion && a.has_water == b.has_water && a.water.corner == b.water.corner &&
         a.water.width == b.water.width && a.water.depth == b.water.depth &&
         a.water.highest_q8 == b.water.highest_q8 && a.water.lowest_q8 == b.water.lowest_q8 &&
         a.water_material == b.water_material && a.bounces == b.bounces;
}

ConstBytes view(const std::vector<std::uint8_t>& bytes) {
  return {bytes.data(), bytes.size()};
}

}  // namespace

TEST_CASE("lighting section: written and opened at any address -> all as it was, tables where they lie") {
  const Whole whole;
  const auto bytes = whole.bytes();
  CHECK(bytes.size() == 64 + 2 * 12 + 2 * 21);
  for (std::size_t offset = 0; offset < 4; ++offset) {
    CAPTURE(offset);
    std::vector<std::uint8_t> moved(offset);
    moved.insert(moved.end(), bytes.begin(), bytes.end());
    const ConstBytes section{moved.data() + offset, bytes.size()};
    BakedLighting lighting;
    REQUIRE(BakedLighting::open(section, kLevel, &lighting) == Status::kOk);
    CHECK(lighting.effects == whole.lighting.effects);
    CHECK(same(lighting.scene, whole.lighting.scene));
    CHECK(reinterpret_cast<const std::uint8_t*>(lighting.scene.surfaces.data) == section.data + 64);
    CHECK(reinterpret_cast<const std::uint8_t*>(lighting.scene.lights.data) == section.data + 64 + 24);
    CHECK(lighting.scene.water.heights_q16 == nullptr);
    CHECK(use_lighting(lighting, kLevel) == nullptr);
  }
}

TEST_CASE("lighting section: its bytes -> as FORMAT.md has them") {
  const Whole whole;
  const auto bytes = whole.bytes();
  const std::vector<std::uint8_t> head{
      1,    15,   7,    16,   22,                        // version, flags, bounces, occlusion
      0,    0x24, 0x23,                                  // 0, reach
      0xFF, 0x7E, 0,    0,                               // effects: all but fog
      0x02, 0x01, 0x04, 0x03, 0x06, 0x05,                // ambient
      10,   11,   12,   13,   14,   15,   16,   17, 18,  // sky
      19,   20,   21,   0xEF, 0xBE, 0xAD, 0xDE,          // fog
      3,    0,    4,    0,    5,    0,    20,   0,  21, 0, 7,  26, 0, 0,  // water
      25,   26,   27,   2,    28,   29,   0,    32, 30, 0, 31, 0,         // its material
      2,    0,    2,    0};
  REQUIRE(head.size() == 64);
  CHECK(std::equal(head.begin(), head.end(), bytes.begin()));
  const std::vector<std::uint8_t> second{9, 8, 7, 4, 0, 255, 0x56, 0x34, 0x9A, 0x78, 0xDE, 0xBC};
  CHECK(std::equal(second.begin(), second.end(), bytes.begin() + 76));
  const std::vector<std::uint8_t> lamp{1, 0, 128, 255, 255, 77, 0,   0,   0, 0, 160,
                                       0, 0, 1,   0,   2,   0,  255, 255, 1, 0};
  CHECK(std::equal(lamp.begin(), lamp.end(), bytes.begin() + 64 + 24 + 21));
}

TEST_CASE("lighting section: a default scene -> 64 bytes that call for nothing") {
  const BakedLighting plain;
  std::vector<std::uint8_t> bytes(lighting_bytes(plain.scene));
  CHECK(bytes.size() == kLightingHeadBytes);
  REQUIRE(BakedLighting::make(plain, kLevel, {bytes.data(), bytes.size()}) == Status::kOk);
  BakedLighting lighting;
  REQUIRE(BakedLighting::open(view(bytes), kLevel, &lighting) == Status::kOk);
  CHECK(same(lighting.scene, plain.scene));
  CHECK(effects_of(lighting.scene) == Effect::kNone);
}

TEST_CASE(
    "lighting section: each number beyond its limit -> refused, with its place; at the limit -> taken") {
  const Whole whole;
  const auto sound = whole.bytes();
  struct Change {
    std::size_t at;
    std::vector<std::uint8_t> bytes;
    std::uint32_t place;
    bool is_refused = true;
  };
  const std::size_t surface = 64 + 12, sun = 64 + 24, lamp = sun + 21;
  for (const Change& change : {
           Change{0, {0}, 0},
           Change{0, {2}, 0},
           Change{1, {16}, 1},
           Change{2, {8}, 1, false},
           Change{2, {9}, 1},
           Change{3, {1}, 1},
           Change{3, {33}, 1},
           Change{3, {32}, 1, false},
           Change{5, {1}, 1},
           Change{9, {128}, 1},
           Change{11, {128}, 1},
           Change{34, {12, 0}, 34, false},
           Change{34, {13, 0}, 34},
           Change{36, {12, 0}, 34},
           Change{38, {32, 0}, 34},
           Change{40, {0, 0}, 34},
           Change{42, {255, 255}, 34},
           Change{44, {0, 27, 0, 0}, 34, false},
           Change{44, {1, 27, 0, 0}, 34},
           Change{44, {0, 0, 0, 128}, 34},
           Change{51, {5}, 48},
           Change{54, {255, 15}, 48},
           Change{60, {1, 0}, 60},
           Change{60, {1, 1}, 60},
           Change{62, {101, 0}, 60},
           Change{62, {1, 0}, 60},
           Change{surface + 3, {5}, static_cast<std::uint32_t>(surface)},
           Change{surface + 6, {0, 16}, 0, false},
           Change{surface + 6, {255, 15}, static_cast<std::uint32_t>(surface)},
           Change{surface + 6, {0, 64}, 0, false},
           Change{surface + 6, {1, 64}, static_cast<std::uint32_t>(surface)},
           Change{sun, {2}, static_cast<std::uint32_t>(sun)},
           Change{sun, {255}, static_cast<std::uint32_t>(sun)},
           Change{sun + 1, {0xFF, 0xBF, 0xFF, 0xFF}, static_cast<std::uint32_t>(sun)},
           Change{sun + 9, {1, 64, 0, 0}, static_cast<std::uint32_t>(sun)},
           Change{sun + 1, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, static_cast<std::uint32_t>(sun)},
           Change{sun + 19, {0, 0}, static_cast<std::uint32_t>(sun)},
           Change{lamp + 1, {0xFF, 0x7F, 0xFF, 0xFF}, static_cast<std::uint32_t>(lamp)},
           Change{lamp + 9, {1, 160, 0, 0}, static_cast<std::uint32_t>(lamp)},
           Change{lamp + 9, {0, 0, 0, 128}, static_cast<std::uint32_t>(lamp)},
       }) {
    CAPTURE(change.at);
    auto bytes = sound;
    std::copy(change.bytes.begin(), change.bytes.end(),
              bytes.begin() + static_cast<std::ptrdiff_t>(change.at));
    std::uint32_t place = UINT32_MAX;
    const char* fault = BakedLighting::validate(view(bytes), kLevel, &place);
    BakedLighting lighting;
    lighting.effects = 12345;
    const Status status = BakedLighting::open(view(bytes), kLevel, &lighting);
    if (change.is_refused) {
      REQUIRE(fault != nullptr);
      CHECK(place == change.place);
      CHECK(status == Status::kDamaged);
      CHECK(lighting.effects == 12345);
    } else {
      CHECK(fault == nullptr);
      CHECK(status == Status::kOk);
    }
  }
  CHECK(BakedLighting::validate(view(sound), kLevel - 1) !=
        nullptr);  // a smaller world does not hold its water
}

TEST_CASE("lighting section: every truncation, bytes behind it, none at all -> refused") {
  const Whole whole;
  auto bytes = whole.bytes();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const HeapBytes cut(size);
    std::copy_n(bytes.begin(), size, cut.span().data);
    BakedLighting lighting;
    REQUIRE(BakedLighting::open(cut.view(), kLevel, &lighting) == Status::kDamaged);
  }
  bytes.push_back(0);
  CHECK(BakedLighting::validate(view(bytes), kLevel) != nullptr);
  CHECK(BakedLighting::validate({}, kLevel) != nullptr);
}

TEST_CASE(
    "lighting section: outputs that are too small -> refused and untouched; beyond limits -> bad argument") {
  Whole whole;
  const std::size_t needed = lighting_bytes(whole.lighting.scene);
  for (std::size_t size = 0; size < needed; ++size) {
    const HeapBytes to(size);
    std::memset(to.span().data, 0x5A, size);
    REQUIRE(BakedLighting::make(whole.lighting, kLevel, to.span()) == Status::kOutOfMemory);
    REQUIRE(std::all_of(to.view().begin(), to.view().end(), [](std::uint8_t byte) { return byte == 0x5A; }));
  }
  std::vector<std::uint8_t> to(10000);
  const Bytes room{to.data(), to.size()};
  const std::vector<Light> lights(kMaxLights + 1);
  whole.lighting.scene.lights = {lights.data(), kMaxLights};
  CHECK(BakedLighting::make(whole.lighting, kLevel, room) == Status::kOk);
  whole.lighting.scene.lights = {lights.data(), lights.size()};
  CHECK(lighting_bytes(whole.lighting.scene) == 0);
  CHECK(BakedLighting::make(whole.lighting, kLevel, room) == Status::kBadArgument);
  whole.lighting.scene.lights = {};
  whole.lighting.scene.water.corner.x = -1;
  CHECK(BakedLighting::make(whole.lighting, kLevel, room) == Status::kBadArgument);
  whole.lighting.scene.water.corner.x = 1;
  whole.lighting.scene.occlusion.rays = 5;
  CHECK(BakedLighting::make(whole.lighting, kLevel, room) == Status::kBadArgument);
}

TEST_CASE("baked scene: with lighting -> comes back; without -> opens as ever") {
  OwnedPool octree_pool(kLevel, 64);
  Octree& octree = octree_pool.octree;
  REQUIRE(octree.insert({1, 2, 3}, 1) == Status::kOk);
  const HeapBytes tree = compact_of(octree);
  const Whole whole;
  const auto lighting = whole.bytes();
  BakedParts parts;
  parts.tree = tree.view();
  const HeapBytes without(baked_bytes(parts));
  REQUIRE(BakedScene::make(parts, without.span(), nullptr) == Status::kOk);
  parts.lighting = view(lighting);
  const HeapBytes with(baked_bytes(parts));
  CHECK(with.view().size == without.view().size + kBakedEntryBytes + (lighting.size() + 3) / 4 * 4);
  REQUIRE(BakedScene::make(parts, with.span(), nullptr) == Status::kOk);

  BakedScene scene;
  REQUIRE(BakedScene::open(with.view(), &scene) == Status::kOk);
  CHECK(scene.validate() == Status::kOk);
  BakedLighting opened;
  REQUIRE(BakedLighting::open(scene.section(SectionKind::kLighting), kLevel, &opened) == Status::kOk);
  CHECK(same(opened.scene, whole.lighting.scene));
  CHECK(use_damaged(with.view(), {3, -5, 7}) == nullptr);

  REQUIRE(BakedScene::open(without.view(), &scene) == Status::kOk);
  CHECK(scene.section(SectionKind::kLighting).empty());
  CHECK(BakedLighting::open(scene.section(SectionKind::kLighting), kLevel, &opened) == Status::kDamaged);
}
