// What becomes of baked scenes of other versions (src/FORMAT.md, "Versions"): a file of each earlier version
// that is read draws as it did; what this version does not know is refused with a sentence.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "support/baked_damage.h"
#include "support/check_command.h"
#include "support/json.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/scene.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/shared_tree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

constexpr std::size_t kVersionOffset = 3;
constexpr std::size_t kMostBytes = 8192;

// A file of the folder beside this one. The compiler may name this file from the build's folder, where the
// command lies.
std::string kept(const std::string& name) {
  const std::filesystem::path build = std::filesystem::path(THIMBLE_COMMAND_PATH).parent_path();
  return (build / std::filesystem::path(__FILE__).parent_path() / "versions" / name).lexically_normal();
}

ConstBytes bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// The same with one byte changed, under checksums that agree.
std::string with(std::string text, std::size_t at, int byte) {
  REQUIRE(at < text.size());
  text[at] = static_cast<char>(byte);
  repair_baked_checksums({reinterpret_cast<std::uint8_t*>(text.data()), text.size()});
  return text;
}

std::string fault_of(const std::string& text) {
  const char* fault = BakedScene::validate(bytes_of(text));
  BakedScene scene;
  CHECK((BakedScene::open(bytes_of(text), &scene) == Status::kOk) == (fault == nullptr));
  return fault == nullptr ? "" : fault;
}

std::size_t place_of(const std::string& text, SectionKind kind) {
  BakedScene scene;
  REQUIRE(BakedScene::open(bytes_of(text), &scene) == Status::kOk);
  REQUIRE_FALSE(scene.section(kind).empty());
  return static_cast<std::size_t>(scene.section(kind).data - bytes_of(text).data);
}

std::string frame_crc32(const TemporaryFolder& folder, const std::string& scene, const Words& options) {
  Words words{"render", scene,  "-o", folder.path("picture.ppm"), "--quiet", "--stats", folder.path("s.json"),
              "--size", "96x64"};
  words.insert(words.end(), options.begin(), options.end());
  const auto is_how = [](const std::string& word) { return word == "--effects" || word == "--shade"; };
  if (std::none_of(words.begin(), words.end(), is_how)) {
    words.insert(words.end(), {"--effects", "auto"});  // as it was baked, not the default picture
  }
  check_done(words);
  return read_json(folder.path("s.json"))["frame_crc32"];
}

// Every command that takes a scene says the same, names the file and writes nothing.
void check_refused(const TemporaryFolder& folder, const std::string& path, const std::string& sentence) {
  const std::string line = "thimble: " + path + ": " + sentence + "\n";
  const std::string out = folder.path("out.oct");
  for (const Words& words :
       {Words{"info", path}, {"render", path, "-o", folder.path("p.ppm")}, {"bake", path, "-o", out}}) {
    tests::check_refused(words, 1, {line});
  }
  CHECK(folder.names() == Words{std::filesystem::path(path).filename().string()});
  std::filesystem::remove(path);
}

struct KeptFrame {
  const char* file;
  Words options;
  const char* crc32;
};

}  // namespace

// Drawn by the first release that wrote version 1.
TEST_CASE("versions: files of version 1 -> valid, and the frames that they had") {
  const std::vector<KeptFrame> frames{
      {"version1-plain.oct", {"--shade", "color"}, "d201e40f"},
      {"version1-plain.oct", {"--shade", "depth"}, "9890f353"},
      {"version1-lit.oct", {"--shade", "color"}, "84ab2920"},
      {"version1-lit.oct", {"--shade", "depth"}, "42f57436"},
      {"version1-lit.oct",
       {"--effects", "direct-light,shadows,ambient-occlusion,emission,mirror,glass,water,fog,sky"},
       "d32b2f37"},
  };
  const TemporaryFolder folder;
  for (const KeptFrame& frame : frames) {
    CAPTURE(frame.file);
    CHECK(frame_crc32(folder, kept(frame.file), frame.options) == frame.crc32);
  }
  for (const char* file : {"version1-plain.oct", "version1-lit.oct"}) {
    CAPTURE(file);
    const std::string text = read_text(kept(file));
    CHECK(text.size() < kMostBytes);
    CHECK(text[kVersionOffset] == 1);
    CHECK(fault_of(text) == "");
    BakedScene scene;
    REQUIRE(BakedScene::open(bytes_of(text), &scene) == Status::kOk);
    CHECK(scene.has_camera());
    CHECK_FALSE(scene.palette().empty());
    const std::string aligned = text.substr(place_of(text, SectionKind::kBrickMap));
    CHECK(BrickMap::validate(bytes_of(aligned)) == nullptr);
  }
}

TEST_CASE(
    "versions: the scenes of those files, baked today -> the same bytes, so no new section is in them") {
  const TemporaryFolder folder;
  for (const char* name : {"plain", "lit"}) {
    check_done({"bake", kept(std::string(name) + ".scene"), "-o", folder.path("s.oct"), "--board",
                "lm3s6965evb", "--effects", "auto", "--quiet"});
    CHECK(read_text(folder.path("s.oct")) == read_text(kept("version1-" + std::string(name) + ".oct")));
  }
}

TEST_CASE("versions: another version of the scene -> damaged on a board, a sentence of the command") {
  const TemporaryFolder folder;
  const std::string good = read_text(kept("version1-plain.oct"));
  for (const int version : {0, 2, 255}) {
    CAPTURE(version);
    const std::string text = with(good, kVersionOffset, version);
    CHECK(fault_of(text) == kAnotherVersion);
    check_refused(folder, folder.write("other.oct", text),
                  "made by another version of thimble (" + std::to_string(version) +
                      "; this one reads 1): bake it again");
  }
}

TEST_CASE("versions: another version of the lighting -> refused by what draws light and by the command") {
  const TemporaryFolder folder;
  const std::string good = read_text(kept("version1-lit.oct"));
  const std::size_t at = place_of(good, SectionKind::kLighting);
  for (const int version : {0, 2}) {
    CAPTURE(version);
    const std::string text = with(good, at, version);
    CHECK(fault_of(text) == "");  // whoever draws without light needs nothing of it
    BakedScene scene;
    REQUIRE(BakedScene::open(bytes_of(text), &scene) == Status::kOk);
    const ConstBytes section = scene.section(SectionKind::kLighting);
    BakedLighting lighting;
    CHECK(BakedLighting::open(section, scene.tree().level(), &lighting) == Status::kDamaged);
    CHECK(std::string(BakedLighting::validate(section, scene.tree().level())) == kAnotherVersion);
    check_refused(folder, folder.write("other.oct", text),
                  "made by another version of thimble (lighting of version " + std::to_string(version) +
                      "; this one reads 1): bake it again");
  }
}

TEST_CASE("versions: a section that is not known -> refused, unless it is marked as optional") {
  const TemporaryFolder folder;
  const std::string good = read_text(kept("version1-plain.oct"));
  // The last section is the name.
  const std::size_t entry = kBakedHeaderBytes + 4 * kBakedEntryBytes;
  REQUIRE(good[entry] == static_cast<char>(SectionKind::kName));
  const std::string needed = with(good, entry, 7);
  CHECK(fault_of(needed) == kAnotherVersion);
  check_refused(
      folder, folder.write("other.oct", needed),
      "made by another version of thimble (with a section of kind 7, which this one does not know): "
      "bake it again");
  const std::string optional = with(with(good, entry, 7), entry + 3, 0x80);
  CHECK(fault_of(optional) == "");
  CHECK(frame_crc32(folder, folder.write("optional.oct", optional), {"--shade", "color"}) == "d201e40f");
}

TEST_CASE("versions: a brick map of another version -> drawn from the tree, the same frame") {
  const TemporaryFolder folder;
  const std::string good = read_text(kept("version1-plain.oct"));
  const std::string text = with(good, place_of(good, SectionKind::kBrickMap) + kVersionOffset, 2);
  CHECK(fault_of(text) == "");
  CHECK(frame_crc32(folder, folder.write("map.oct", text), {"--shade", "color"}) == "d201e40f");
}

TEST_CASE("versions: trees and brick maps by themselves -> another version and other bytes are two errors") {
  const std::string good = read_text(kept("version1-plain.oct"));
  BakedScene scene;
  REQUIRE(BakedScene::open(bytes_of(good), &scene) == Status::kOk);
  const auto section = [&](SectionKind kind, int version) {
    const ConstBytes bytes = scene.section(kind);
    std::string text(bytes.begin(), bytes.end());
    text[kVersionOffset] = static_cast<char>(version);
    return text;
  };
  const std::string tree = section(SectionKind::kTree, 2);
  CHECK(std::string(CompactTree::validate(bytes_of(tree))) == kAnotherVersion);
  CHECK(std::string(CompactTree::validate(bytes_of(good))) == "not a compact tree");
  const std::string map = section(SectionKind::kBrickMap, 3);
  CHECK(std::string(BrickMap::validate(bytes_of(map))) == kAnotherVersion);
  CHECK(std::string(BrickMap::validate(bytes_of(tree))) == "not a brick map");
  BrickMap opened;
  CHECK(BrickMap::open(bytes_of(map), &opened) == Status::kDamaged);
  std::string shared(kSharedHeaderBytes, '\0');
  shared.replace(0, 4, "TMG\2");
  CHECK(std::string(SharedTree::validate(bytes_of(shared), {})) == kAnotherVersion);
  shared[0] = 'X';
  CHECK(std::string(SharedTree::validate(bytes_of(shared), {})) == "not a shared tree");
}
