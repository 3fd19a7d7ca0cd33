// Baked scenes whose list of sections says more than a section may hold: told, and where.
#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "support/baked_damage.h"
#include "support/scene_under_test.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/tree/octree.h"

namespace thimble::tests::baked_edges {
namespace {

constexpr std::size_t kEntries = kBakedHeaderBytes;  // 12 bytes each: kind, offset, size
constexpr std::size_t kSizeInEntry = 8;

HeapBytes some_tree() {
  std::vector<std::uint8_t> pool(Octree::octree_bytes(100));
  Octree octree;
  REQUIRE(Octree::make(2, {pool.data(), pool.size()}, &octree) == Status::kOk);
  REQUIRE(octree.insert({1, 2, 3}, 4) == Status::kOk);
  return compact_of(octree);
}

// A scene of a tree and one section of many bytes behind it, whose size is then said to be another.
std::string fault_of(bool palette, std::uint32_t said, std::uint32_t* place) {
  const HeapBytes tree = some_tree();
  const std::vector<Rgb8> colors(256);
  BakedParts parts;
  parts.tree = tree.view();
  parts.palette = {colors.data(), palette ? colors.size() : 0};
  const std::vector<std::uint8_t> name(255, 'x');
  parts.name = {name.data(), palette ? 0 : name.size()};
  HeapBytes bytes(baked_bytes(parts) + 800);  // more may follow, and be said to belong to the last section
  REQUIRE(BakedScene::make(parts, bytes.span(), nullptr) == Status::kOk);
  std::uint8_t* const base = bytes.span().data;
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) {
      base[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  };
  const std::size_t entry = kEntries + kBakedEntryBytes;
  put(entry + kSizeInEntry, said);
  put(4, static_cast<std::uint32_t>(bytes.view().size));
  repair_baked_checksums(bytes.span());
  const char* const text = BakedScene::validate(bytes.view(), place);
  BakedScene scene;
  CHECK(BakedScene::open(bytes.view(), &scene) == (text == nullptr ? Status::kOk : Status::kDamaged));
  if (text == nullptr) {
    CHECK(scene.palette().size == (palette ? said / 3 : 0));
    CHECK(scene.section(SectionKind::kName).size == (palette ? 0 : said));
  }
  return text == nullptr ? "" : text;
}

TEST_CASE("baked scene: a palette of bytes that are no colours, or of more than 256 -> told, at its entry") {
  for (std::uint32_t said = 0; said <= 790; ++said) {
    std::uint32_t place = 0;
    const std::string text = fault_of(true, said, &place);
    CAPTURE(said);
    if (said % 3 == 0 && said <= 768) {
      REQUIRE(text.empty());
    } else {
      REQUIRE(text == "a palette of the wrong size");
      REQUIRE(place == kEntries + kBakedEntryBytes);
    }
  }
}

TEST_CASE("baked scene: a name of more than 255 bytes -> told, at its entry") {
  for (const std::uint32_t said : {0U, 1U, 254U, 255U, 256U, 257U, 700U}) {
    std::uint32_t place = 0;
    const std::string text = fault_of(false, said, &place);
    CAPTURE(said);
    CHECK(text == (said <= 255 ? "" : "a name that is too long"));
    CHECK((text.empty() || place == kEntries + kBakedEntryBytes));
  }
}

TEST_CASE("baked scene: a look, which the core does not read -> its bytes, a sound scene; without one none") {
  const HeapBytes tree = some_tree();
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
    std::uint32_t place = 0;
    CHECK(BakedScene::validate(bytes.view(), &place) == nullptr);
    const ConstBytes written = scene.section(SectionKind::kLook);
    CHECK(std::vector<std::uint8_t>(written.begin(), written.end()) == look);
    CHECK(scene.tree().voxel_count() == 1);
  }
}

}  // namespace
}  // namespace thimble::tests::baked_edges
