// A baked scene's bytes: what they are, what comes back out of them, and what happens when they are too few
// or damaged.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <zlib.h>

#include "support/baked_damage.h"
#include "support/scene_under_test.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/tree/octree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

constexpr Rgb8 kColors[] = {{1, 2, 3}, {200, 100, 50}, {9, 8, 7}};
constexpr char kName[] = "a scene";

SceneCamera perspective() {
  SceneCamera camera;
  camera.eye = {Q8::from_raw(-700), Q8::from_raw(-900), Q8::from_raw(1500)};
  camera.target = {Q8::from_raw(1024), Q8::from_raw(1024), Q8::from_raw(1000)};
  camera.fov_degrees = Q16::saturate(40);
  return camera;
}

SceneCamera orthographic() {
  SceneCamera camera = perspective();
  camera.is_perspective = false;
  camera.direction_bits = 12;
  camera.forward = {3, 5, -2};
  camera.up = {0, 1, 4};
  camera.span = Q14::from_raw(12 << 14);
  return camera;
}

// A tree of level 3 with two materials and a solid block.
HeapBytes small_tree() {
  OwnedPool octree_pool(3, 4096);
  Octree& octree = octree_pool.octree;
  REQUIRE(octree.insert_block({0, 0, 0}, 1, 1) == Status::kOk);
  std::mt19937 random(5);
  for (int i = 0; i < 40; ++i) {
    const auto coordinate = [&] { return static_cast<std::int32_t>(random() % 8); };
    const Vec3i at{coordinate(), coordinate(), coordinate()};
    REQUIRE(octree.insert(at, static_cast<std::uint8_t>(random() % 3)) == Status::kOk);
  }
  return compact_of(octree);
}

// All parts but the brick map, which only has to come back.
struct WholeScene {
  explicit WholeScene(const SceneCamera& with) : tree(small_tree()), camera(with) {
    parts.tree = tree.view();
    parts.palette = Span<const Rgb8>(kColors);
    parts.camera = &camera;
    parts.brick_map = {kBricks, sizeof kBricks};
    parts.name = {reinterpret_cast<const std::uint8_t*>(kName), sizeof kName - 1};
  }
  WholeScene(const WholeScene&) = delete;
  WholeScene& operator=(const WholeScene&) = delete;

  HeapBytes baked() const {
    HeapBytes bytes(baked_bytes(parts));
    REQUIRE(BakedScene::make(parts, bytes.span(), nullptr) == Status::kOk);
    return bytes;
  }

  static constexpr std::uint8_t kBricks[5] = {11, 22, 33, 44, 55};
  HeapBytes tree;
  SceneCamera camera;
  BakedParts parts;
};

std::uint32_t load32(ConstBytes bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data + at, sizeof word);
  return word;
}

void store32(Bytes bytes, std::size_t at, std::uint32_t word) {
  std::memcpy(bytes.data + at, &word, sizeof word);
}

HeapBytes copy_of(ConstBytes bytes, std::size_t size) {
  HeapBytes copy(size);
  std::memset(copy.span().data, 0, size);
  std::memcpy(copy.span().data, bytes.data, std::min(size, bytes.size));
  return copy;
}

// What `validate` says of bytes whose checksums are right.
std::string fault_of(const HeapBytes& bytes) {
  repair_baked_checksums(bytes.span());
  const char* fault = BakedScene::validate(bytes.view());
  BakedScene scene;
  CHECK((BakedScene::open(bytes.view(), &scene) == Status::kOk) == (fault == nullptr));
  return fault == nullptr ? "" : fault;
}

constexpr std::size_t entry(std::size_t index) {
  return kBakedHeaderBytes + kBakedEntryBytes * index;
}

}  // namespace

TEST_CASE("baked scene: the tree lies where the scene is written -> the same bytes") {
  WholeScene whole(perspective());
  const HeapBytes apart = whole.baked();
  const std::size_t place = entry(kMaxSections);
  HeapBytes bytes(place + apart.view().size);
  std::memcpy(bytes.span().data + place, whole.tree.view().data, whole.tree.view().size);
  whole.parts.tree = bytes.view().subspan(place, whole.tree.view().size);
  REQUIRE(BakedScene::make(whole.parts, bytes.span(), nullptr) == Status::kOk);
  CHECK(std::memcmp(bytes.view().data, apart.view().data, apart.view().size) == 0);
}

TEST_CASE(
    "baked scene: bytes behind the tree -> refused; a scene never opened -> damaged, without sections") {
  const HeapBytes tree = small_tree();
  BakedParts parts;
  parts.tree = tree.view();
  CHECK(baked_bytes(parts) == kBakedHeaderBytes + kBakedEntryBytes + tree.view().size);
  // Bytes behind the tree would not be validated.
  const HeapBytes longer = copy_of(tree.view(), tree.view().size + 4);
  parts.tree = longer.view();
  const HeapBytes to(1000);
  CHECK(BakedScene::make(parts, to.span(), nullptr) == Status::kBadArgument);
  CHECK(BakedScene().section(SectionKind::kTree).empty());
  CHECK(BakedScene().validate() == Status::kDamaged);
}

TEST_CASE("baked scene: its bytes -> as FORMAT.md has them, the checksum being zlib's") {
  const WholeScene whole(orthographic());
  const HeapBytes baked = whole.baked();
  const ConstBytes bytes = baked.view();
  CHECK(std::memcmp(bytes.data, "TMS\x01", 4) == 0);
  CHECK(load32(bytes, 4) == bytes.size);
  const uLong front = ::crc32(0, bytes.data, 8);
  CHECK(load32(bytes, 8) == ::crc32(front, bytes.data + 12, static_cast<uInt>(bytes.size - 12)));
  REQUIRE(load32(bytes, 12) == 5);
  std::size_t at = entry(5);
  const std::size_t sizes[] = {whole.parts.tree.size, 9, 60, 5, 7};
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(load32(bytes, entry(i)) == i + 1);
    for (; i == 3 && at % 8 != 0; ++at) {  // the brick map
      CHECK(bytes[at] == 0);
    }
    CHECK(load32(bytes, entry(i) + 4) == at);
    CHECK(load32(bytes, entry(i) + 8) == sizes[i]);
    for (std::size_t padding = at + sizes[i]; padding < (at + sizes[i] + 3) / 4 * 4; ++padding) {
      CHECK(bytes[padding] == 0);
    }
    if (i == 2) {
      const std::uint32_t words[] = {0x0C01,
                                     static_cast<std::uint32_t>(-700),
                                     static_cast<std::uint32_t>(-900),
                                     1500,
                                     1024,
                                     1024,
                                     1000,
                                     3,
                                     5,
                                     static_cast<std::uint32_t>(-2),
                                     0,
                                     1,
                                     4,
                                     40 << 16,
                                     12 << 14};
      CHECK(std::memcmp(bytes.data + at, words, sizeof words) == 0);
    }
    at = (at + sizes[i] + 3) / 4 * 4;
  }
  CHECK(at == bytes.size);
}

TEST_CASE("baked scene: parts too long or a camera without a view -> refused") {
  WholeScene whole(perspective());
  const HeapBytes to(1U << 16);
  const std::vector<std::uint8_t> name(kMaxNameBytes + 1, 'x');
  BakedParts parts = whole.parts;
  parts.name = {name.data(), name.size()};
  CHECK(baked_bytes(parts) == SIZE_MAX);
  CHECK(BakedScene::make(parts, to.span(), nullptr) == Status::kBadArgument);
  parts.name = {name.data(), kMaxNameBytes};
  CHECK(BakedScene::make(parts, to.span(), nullptr) == Status::kOk);
  const std::vector<Rgb8> palette(kMaxPaletteColors + 1);
  parts.palette = {palette.data(), palette.size()};
  CHECK(BakedScene::make(parts, to.span(), nullptr) == Status::kBadArgument);
  parts.palette = {palette.data(), kMaxPaletteColors};
  CHECK(BakedScene::make(parts, to.span(), nullptr) == Status::kOk);

  const auto refused = [&](const SceneCamera& camera) {
    BakedParts with = whole.parts;
    with.camera = &camera;
    return BakedScene::make(with, to.span(), nullptr) == Status::kBadArgument;
  };
  SceneCamera camera = perspective();
  CHECK_FALSE(refused(camera));
  camera.target = camera.eye;
  CHECK(refused(camera));
  camera.forward = {0, 0, 1};
  CHECK_FALSE(refused(camera));
  camera.up = {0, 0, -7};
  CHECK(refused(camera));
  camera.up = {0, 1, 0};
  camera.fov_degrees = Q16::saturate(121);
  CHECK(refused(camera));
  camera.is_perspective = false;
  CHECK(refused(camera));  // no span
  camera.span = Q14::from_raw(1);
  CHECK_FALSE(refused(camera));
  camera.eye.y = Q8::from_raw(5 * 8 * 256 + 1);
  CHECK(refused(camera));
  camera = perspective();
  camera.direction_bits = 7;
  CHECK(refused(camera));
  camera = perspective();
  camera.forward = {0, kMaxViewComponent, kMaxViewComponent + 1};
  CHECK(refused(camera));
}

TEST_CASE("baked scene: sections of unknown kinds that are optional -> passed over, up to sixteen in all") {
  constexpr std::uint32_t kUnknown = kOptionalKind + 77;
  const WholeScene whole(perspective());
  const HeapBytes bytes = whole.baked();
  // The name becomes something unknown, then another of the same unknown kind.
  const HeapBytes unknown = copy_of(bytes.view(), bytes.view().size);
  store32(unknown.span(), entry(4), kUnknown);
  store32(unknown.span(), entry(3), kUnknown);
  CHECK(fault_of(unknown) == "");
  BakedScene scene;
  REQUIRE(BakedScene::open(unknown.view(), &scene) == Status::kOk);
  CHECK(scene.section(SectionKind::kName).empty());
  CHECK(scene.has_camera());
  CHECK(scene.section(static_cast<SectionKind>(kUnknown)).size == sizeof WholeScene::kBricks);

  // The same sections behind a list with empty sections at its end.
  for (const std::uint32_t more : {11U, 12U}) {
    const std::uint32_t shift = static_cast<std::uint32_t>(kBakedEntryBytes) * more;
    const HeapBytes grown(bytes.view().size + shift);
    std::memcpy(grown.span().data, bytes.view().data, entry(5));
    std::memcpy(grown.span().data + entry(5) + shift, bytes.view().data + entry(5),
                bytes.view().size - entry(5));
    store32(grown.span(), 4, static_cast<std::uint32_t>(grown.view().size));
    store32(grown.span(), 12, 5 + more);
    for (std::size_t i = 0; i < 5; ++i) {
      store32(grown.span(), entry(i) + 4, load32(bytes.view(), entry(i) + 4) + shift);
    }
    for (std::uint32_t i = 0; i < more; ++i) {
      store32(grown.span(), entry(5 + i), kOptionalKind + i);
      store32(grown.span(), entry(5 + i) + 4, static_cast<std::uint32_t>(grown.view().size));
      store32(grown.span(), entry(5 + i) + 8, 0);
    }
    CHECK(fault_of(grown) == (more == 11 ? "" : "a list of sections that does not fit"));
  }
}

TEST_CASE("baked scene: a wrong header or list -> the phrase that says so") {
  const WholeScene whole(perspective());
  const HeapBytes good = whole.baked();
  const auto with = [&](std::size_t at, std::uint32_t word) {
    const HeapBytes bytes = copy_of(good.view(), good.view().size);
    store32(bytes.span(), at, word);
    return fault_of(bytes);
  };
  CHECK(with(0, 0x02534D54) == kAnotherVersion);
  CHECK(with(0, 0x00534D54) == kAnotherVersion);
  CHECK(with(0, 0x01424D54) == "not a baked scene");
  CHECK(with(4, static_cast<std::uint32_t>(good.view().size + 1)) == "truncated");
  CHECK(with(4, 12) == "a list of sections that does not fit");
  CHECK(with(12, UINT32_MAX) == "a list of sections that does not fit");
  CHECK(with(12, 0) == "no tree");
  CHECK(with(entry(0), kOptionalKind) == "no tree");
  // A kind that is not known and not optional: what it holds may change the picture.
  for (const std::uint32_t kind : {0U, 7U, 31U, 32U, 33U, 99U, kOptionalKind - 1}) {
    CHECK(with(entry(4), kind) == kAnotherVersion);
  }
  CHECK(with(entry(1), 1) == "two sections of one kind");
  const char* const kOutside = "a section outside the bytes or on top of another";
  CHECK(with(entry(0) + 4, 0) == kOutside);
  CHECK(with(entry(1) + 4, load32(good.view(), entry(0) + 4)) == kOutside);
  CHECK(with(entry(4) + 4, load32(good.view(), entry(4) + 4) + 1) == kOutside);
  CHECK(with(entry(4) + 8, 9) == kOutside);
  CHECK(with(entry(4) + 8, UINT32_MAX) == kOutside);
  CHECK(with(entry(4) + 4, UINT32_MAX - 3) == kOutside);
  CHECK(with(entry(0) + 8, load32(good.view(), entry(0) + 8) - 4) == "a damaged tree");
  CHECK(with(entry(1) + 8, 8) == "a palette of the wrong size");
  CHECK(with(entry(2) + 8, 59) == "a camera of an unknown kind");
  CHECK(with(load32(good.view(), entry(2) + 4), 2) == "a camera of an unknown kind");
  CHECK(with(load32(good.view(), entry(2) + 4) + 4, 1U << 30) == "a camera that makes no view");

  const HeapBytes checksum = copy_of(good.view(), good.view().size);
  checksum.span()[checksum.view().size - 2] ^= 1;
  std::uint32_t place = 0;
  CHECK(std::string(BakedScene::validate(checksum.view(), &place)) == "checksum does not match");
  CHECK(place == 8);
}

TEST_CASE("baked scene: a part that fills the last section -> no byte behind the scene is written") {
  const HeapBytes tree = small_tree();
  const std::uint8_t words[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  for (int last = 0; last < 3; ++last) {
    BakedParts parts;
    parts.tree = tree.view();
    ConstBytes* const filled[] = {&parts.brick_map, &parts.name, &parts.lighting};
    *filled[last] = {words, 8};
    const std::size_t size = baked_bytes(parts);
    std::vector<std::uint8_t> bytes(size + 8, 0xA5);
    REQUIRE(BakedScene::make(parts, {bytes.data(), bytes.size()}, nullptr) == Status::kOk);
    CHECK(bytes[size - 1] == 8);
    for (std::size_t i = size; i < bytes.size(); ++i) {
      CHECK(bytes[i] == 0xA5);
    }
  }
}

// A scene of a tree and one section of many bytes behind it, whose size is then said to be another.
std::string fault_of_size(bool palette, std::uint32_t said, std::uint32_t* place) {
  const HeapBytes tree = small_tree();
  const std::vector<Rgb8> colors(256);
  const std::vector<std::uint8_t> name(255, 'x');
  BakedParts parts;
  parts.tree = tree.view();
  parts.palette = {colors.data(), palette ? colors.size() : 0};
  parts.name = {name.data(), palette ? 0 : name.size()};
  HeapBytes bytes(baked_bytes(parts) + 800);  // more may follow, and be said to belong to the last section
  REQUIRE(BakedScene::make(parts, bytes.span(), nullptr) == Status::kOk);
  store32(bytes.span(), entry(1) + 8, said);
  store32(bytes.span(), 4, static_cast<std::uint32_t>(bytes.view().size));
  const std::string fault = fault_of(bytes);
  (void)BakedScene::validate(bytes.view(), place);
  BakedScene scene;
  if (BakedScene::open(bytes.view(), &scene) == Status::kOk) {
    CHECK(scene.palette().size == (palette ? said / 3 : 0));
    CHECK(scene.section(SectionKind::kName).size == (palette ? 0 : said));
  }
  return fault;
}

TEST_CASE(
    "baked scene: a palette of bytes that are no colours, or too much of it or the name -> told, at its "
    "entry") {
  for (std::uint32_t said = 0; said <= 790; ++said) {
    CAPTURE(said);
    for (const bool palette : {false, true}) {
      const bool is_sound = palette ? said % 3 == 0 && said <= 768 : said <= 255;
      std::uint32_t place = 0;
      const std::string fault = fault_of_size(palette, said, &place);
      REQUIRE(fault == (is_sound ? "" : palette ? "a palette of the wrong size" : "a name that is too long"));
      REQUIRE((is_sound || place == entry(1)));
    }
  }
}

TEST_CASE("baked scene: a look, which the core does not read -> its bytes, a sound scene; without one none") {
  const HeapBytes tree = small_tree();
  std::vector<std::uint8_t> look;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{12}, std::size_t{300}}) {
    CAPTURE(size);
    look.resize(size, static_cast<std::uint8_t>(size + 7));
    BakedParts parts;
    parts.tree = tree.view();
    parts.look = {look.data(), look.size()};
    HeapBytes bytes(baked_bytes(parts));
    BakedScene scene;
    REQUIRE(BakedScene::make(parts, bytes.span(), &scene) == Status::kOk);
    CHECK(BakedScene::validate(bytes.view()) == nullptr);
    const ConstBytes written = scene.section(SectionKind::kLook);
    CHECK(std::vector<std::uint8_t>(written.begin(), written.end()) == look);
  }
}
