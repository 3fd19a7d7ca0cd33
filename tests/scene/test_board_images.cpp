// Programs that are there before their scene: renderers for all sets of effects within one draw each set exactly, a program
// is opened or refused, and files of it hold program and scene.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "boards/board_table.h"
#include "readers/input_error.h"
#include "scene/baking.h"
#include "scene/board_images.h"
#include "scene/scene_arguments.h"
#include "support/run_command.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/map_render.h"
#include "thimble/picture/camera.h"

namespace {

using namespace thimble;
using namespace thimble::tests;
using namespace thimble::tools;

constexpr EffectSet kSun = 0x3f0b;  // platform/images.sh
constexpr EffectSet kAll = 0x7fff;

// Something of every material, water and lamp; without metals where they are not to be mirrors.
std::string scene_text(bool has_metal) {
  return std::string(R"(depth 5
camera eye 40 -14 26 target 15 16 6 fov 40
sun toward 6 -5 9
lamp at 20 10 14 color 255 206 140 brightness 1.5 reach 26
occlusion rays 4 reach 6
fog color 200 205 210 density 0.02
material floor color 190 180 160
material steel )") +
         (has_metal ? "metal color 120 160 226 mirror 0.6" : "color 120 160 226") + R"(
material bottle glass color 180 220 200 index 1.5 density 0.05
material glow emit color 255 200 120 emission 1.4
material mist media color 220 225 230 density 0.2
box floor from 0 0 0 to 32 32 2
box floor from 0 30 2 to 32 32 20
box floor from 0 0 2 to 2 32 9
ball steel at 18 14 9 radius 6
ball bottle at 8 12 9 radius 4
ball glow at 26 22 6 radius 3
box mist from 12 22 6 to 18 28 14
water level 5 floor 2 color 84 176 190 index 1.333 density 0.05
)";
}

struct Shown {
  Baked baked;
  BakedLighting lighting;
  Camera camera;
  Shading shading;
  BrickMap map;

  std::vector<std::uint8_t> picture(const auto& draw) const {
    std::vector<std::uint8_t> pixels(band_bytes(PixelFormat::kRgb888, camera.width_px(), camera.height_px()));
    REQUIRE(draw(Band{{pixels.data(), pixels.size()}, PixelFormat::kRgb888, 0, 0, camera.height_px()}) ==
            Status::kOk);
    return pixels;
  }
};

void bake(const SceneSource& source, EffectSet effects, Shown* shown) {
  BakingOptions options;
  options.effects = {false, effects, false, {}, true};
  options.brick_map = true;
  shown->baked = bake_scene(source, options);
  const BakedScene& scene = shown->baked.scene;
  REQUIRE(BakedLighting::open(scene.section(SectionKind::kLighting), scene.tree().level(),
                              &shown->lighting) == Status::kOk);
  REQUIRE(BrickMap::open(scene.section(SectionKind::kBrickMap), &shown->map) == Status::kOk);
  const Vec3Q8 eye{Q8::from_raw(40 * 256), Q8::from_raw(-14 * 256), Q8::from_raw(26 * 256)};
  const Vec3Q8 target{Q8::from_raw(15 * 256), Q8::from_raw(16 * 256), Q8::from_raw(6 * 256)};
  REQUIRE(shown->camera.set(PerspectiveView{eye, look_at(eye, target), {}, Q16::saturate(40), 40, 32, 0},
                            scene.tree().level()) == Status::kOk);
  shown->shading.palette = scene.palette();
}

// The set, by its own renderer and by that for all within kMost.
template <EffectSet kMost>
void check_exact(const Shown& shown) {
  const EffectSet set = shown.lighting.effects;
  const CompactTree& tree = shown.baked.scene.tree();
  const auto right = shown.picture([&](const Band& band) {
    return render_lit_band(set, tree, shown.camera, shown.shading, shown.lighting.scene, band);
  });
  CAPTURE(set);
  CHECK(right == shown.picture([&](const Band& band) {
    return render_lit_band_within<kMost>(set, tree, shown.camera, shown.shading, shown.lighting.scene, band);
  }));
  CHECK(right == shown.picture([&](const Band& band) {
    return render_lit_band_within<kMost, (kMost & Effect::kWater) != 0>(
        set, tree, shown.map, shown.camera, shown.shading, shown.lighting.scene, {}, band);
  }));
}

// A program of two segments for the board, with the mark at an odd place.
std::string program_of(const char* board, std::uint32_t effects, std::uint32_t origin,
                       std::uint32_t room = 4096) {
  platform::SceneMark mark{};
  std::memcpy(mark.magic, platform::kSceneMarkMagic, sizeof mark.magic);
  mark.baked_version = kBakedVersion;
  mark.effects = effects;
  mark.place = origin + 4096;
  mark.end = mark.place + room;
  std::strncpy(mark.board, board, sizeof mark.board - 1);
  std::string bytes(777, '\x5A');
  bytes.append(reinterpret_cast<const char*>(&mark), sizeof mark);
  platform::Program program;
  program.machine = 40;
  program.entry = origin + 65;
  program.segments = {{origin, origin, 0, bytes}, {origin + 1024, 0x20000000, 0, "data"}};
  return platform::elf_of(program);
}

std::string wrong_with(const std::string& elf, const char* board = "pico") {
  try {
    open_image(elf, *platform::find_board(board));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE(
    "board images: every set of effects within a renderer's -> its own renderer's picture, by tree and map") {
  for (const bool has_metal : {false, true}) {
    const TemporaryFolder folder;
    SceneArguments arguments;
    arguments.scene = folder.write("all.scene", scene_text(has_metal));
    const auto source = open_scene(arguments);
    std::uint32_t random = 1;
    for (int i = 0; i < 160; ++i) {
      random = random * 1664525 + 1013904223;
      // Half of them are those that frames by the map take.
      const EffectSet wanted = i % 2 == 0 ? random >> 17 : (random >> 17 & 0x521C) | 3;
      Shown shown;
      bake(*source, wanted == 0 ? 1 : wanted & kAll, &shown);
      const EffectSet set = shown.lighting.effects;
      if (lies_within(set, kSun)) {
        check_exact<kSun>(shown);
      }
      if (lies_within(set, kAll) && (!has_metal || (set & Effect::kMirror) != 0)) {
        check_exact<kAll>(shown);
      }
    }
  }
}

TEST_CASE(
    "board images: direct light without shadows, or more than there is -> not within, and nothing is drawn") {
  CHECK(lies_within(0, kSun));
  CHECK(lies_within(0, 0));
  CHECK_FALSE(lies_within(Effect::kDirectLight, kSun));
  CHECK(lies_within(Effect::kDirectLight, Effect::kDirectLight));
  CHECK_FALSE(lies_within(kSun | Effect::kGlass, kSun));
}

TEST_CASE("board images: a program -> its mark and room; files of it hold program and scene") {
  const platform::BoardFacts& pico = *platform::find_board("pico");
  const std::string elf = program_of("pico", kSun, 0x10000000);
  const BoardImage image = open_image(elf, pico);
  CHECK(image.room() == 4096);
  CHECK(image.draws(3));
  CHECK_FALSE(image.draws(Effect::kGlass));
  std::vector<std::uint8_t> scene(300);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    scene[i] = static_cast<std::uint8_t>(i * 7);
  }
  const std::string text(scene.begin(), scene.end());

  const platform::Program again = platform::read_elf(image_file(image, scene, pico, "a.elf"));
  REQUIRE(again.segments.size() == 3);
  CHECK(again.entry == 0x10000041);
  CHECK(again.machine == 40);
  CHECK(again.segments[1].virtual_address == 0x20000000);
  CHECK(again.segments[2].address == 0x10001000);
  CHECK(again.segments[2].bytes == text);

  const std::string bin = image_file(image, scene, pico, "a.bin");
  REQUIRE(bin.size() == 4096 + 300);
  CHECK(bin.substr(0, 825) == image.program.segments[0].bytes);
  CHECK(bin.substr(825, 199) == std::string(199, '\0'));
  CHECK(bin.substr(1024, 4) == "data");
  CHECK(bin.substr(4096) == text);

  // UF2: whole sectors, numbered, with the family; their bytes are the .bin's.
  const std::string uf2 = image_file(image, scene, pico, "a.uf2");
  REQUIRE(uf2.size() == 512 * 32);
  for (std::size_t block = 0; block < 32; ++block) {
    const std::string_view one = std::string_view(uf2).substr(512 * block, 512);
    CHECK(platform::get_number(one, 0, 4) == 0x0A324655);
    CHECK(platform::get_number(one, 12, 4) == 0x10000000 + 256 * block);
    CHECK(platform::get_number(one, 20, 4) == block);
    CHECK(platform::get_number(one, 24, 4) == 32);
    CHECK(platform::get_number(one, 28, 4) == 0xE48BFF56);
    std::string page = 256 * block < bin.size() ? bin.substr(256 * block, 256) : std::string();
    page.resize(256);
    CHECK(one.substr(32, 256) == page);
  }

  // Intel HEX: every line's sum is 0, and its bytes are the .bin's.
  const std::string hex = image_file(image, scene, pico, "a.hex");
  std::string read(bin.size(), '\0');
  std::uint32_t high = 0;
  std::string kinds;
  for (std::size_t at = 0; at < hex.size();) {
    const std::size_t end = hex.find("\r\n", at);
    REQUIRE(end != std::string::npos);
    REQUIRE(hex[at] == ':');
    std::vector<std::uint32_t> record;
    std::uint32_t sum = 0;
    for (std::size_t i = at + 1; i < end; i += 2) {
      record.push_back(static_cast<std::uint32_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
      sum += record.back();
    }
    CHECK(sum % 256 == 0);
    REQUIRE(record.size() == record[0] + 5);
    kinds += std::to_string(record[3]);
    if (record[3] == 4) {
      high = record[4] << 24 | record[5] << 16;
    }
    for (std::uint32_t i = 0; record[3] == 0 && i < record[0]; ++i) {
      read[high + (record[1] << 8 | record[2]) + i - 0x10000000] = static_cast<char>(record[4 + i]);
    }
    at = end + 2;
  }
  CHECK(read == bin);
  CHECK(kinds.substr(0, 2) == "40");
  CHECK(kinds.substr(kinds.size() - 2) == "51");

  CHECK(takes_ending(pico, "x.uf2"));
  CHECK_FALSE(takes_ending(pico, "x.gba"));
  CHECK_FALSE(takes_ending(pico, "x.oct"));
  CHECK(takes_ending(*platform::find_board("gba"), "x.gba"));
  CHECK_FALSE(takes_ending(*platform::find_board("microbit"), "x.uf2"));
}

TEST_CASE(
    "board images: what is no program, cut off, of another board or version, or without room -> a sentence") {
  const std::string good = program_of("pico", kSun, 0x10000000);
  REQUIRE(wrong_with(good).empty());
  CHECK(wrong_with(good, "gba").find("another board") != std::string::npos);
  CHECK(wrong_with("text").find("no ELF file") != std::string::npos);
  for (std::size_t size = 0; size < good.size(); ++size) {
    if (!wrong_with(good.substr(0, size)).empty()) {
      continue;
    }
    CHECK(size >= good.size() - 3);  // what fills the last word up
  }
  const std::size_t mark = good.find(platform::kSceneMarkMagic);
  const auto with = [&](std::size_t at, std::uint32_t number) {
    std::string other = good;
    platform::put_number(other, at, number);
    return wrong_with(other);
  };
  CHECK(with(mark, 0).find("takes a scene") != std::string::npos);
  CHECK(with(mark + 8, kBakedVersion + 1).find("another version") != std::string::npos);
  CHECK(with(mark + 16, 0x10000400).find("no place") != std::string::npos);  // within the program
  CHECK(with(mark + 16, 0x10001004).find("no place") != std::string::npos);
  CHECK(with(mark + 20, 0x10000FFF).find("no place") != std::string::npos);
  // Two marks, two segments at one address, a segment and a table outside the file.
  std::string two = good;
  two.replace(mark - 100, 8, platform::kSceneMarkMagic);
  CHECK(wrong_with(two).find("takes a scene") != std::string::npos);
  CHECK(with(52 + 32 + 12, 0x10000100).find("at one address") != std::string::npos);
  CHECK(with(52 + 4, 0xFFFFFF00).find("outside the file") != std::string::npos);
  CHECK(with(28, 0xFFFFFFF0).find("outside the file") != std::string::npos);
  CHECK(with(52 + 32 + 12, 0xFFFFFFFE).find("beyond 4 GiB") != std::string::npos);
  // Segments too far apart for one run of bytes.
  std::string far = good;
  platform::put_number(far, 52 + 32 + 12, 0x20000000);
  CHECK_THROWS_AS(platform::bin_of(platform::read_elf(far)), platform::ImageError);
}
