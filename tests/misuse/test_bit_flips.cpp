// Every bit of baked scenes and of a shared tree, one at a time, with the checksums as they were and put right:
// refused, or read, traced and drawn by every renderer inside the bytes and to an end.
//
// `make test-all` takes every flip through the core and each fifth through the host's renderers and light, its sanitized run
// each third of those, `make test` each eleventh; with THIMBLE_FLIPS=all each takes every one.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "misuse/odd_values.h"
#include "support/baked_damage.h"
#include "support/counts.h"
#include "support/run_command.h"
#include "support/scene_under_test.h"
#include "support/small_scene.h"
#include "thimble/light/render.h"
#include "thimble/picture/anytime.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/octree.h"
#include "thimble/tree/shared_tree.h"
#include "wide/lit/lit_renderer.h"
#include "wide/raster/renderer.h"

namespace thimble::tests {
namespace {

// Odd, so that neither half of the flips, repaired or not, is left out.
constexpr std::size_t kFewLit = 5;
// A sanitized run, which sees what is read outside, takes each third.
#ifdef __SANITIZE_ADDRESS__
constexpr std::size_t kFewFlips = 3;
#else
constexpr std::size_t kFewFlips = 11;
#endif
constexpr std::size_t kFewCommands = 211;

bool all_flips() {
  const char* const given = std::getenv("THIMBLE_FLIPS");
  return given != nullptr && std::string(given) == "all";
}

// small_scene.h's scene of that level, in as many bytes as it has, and its tree, shared.
struct FlippedWorld {
  HeapBytes scene;
  HeapBytes shared;

  explicit FlippedWorld(int level) {
    const std::vector<std::uint8_t> bytes = small_scene(level);
    scene = HeapBytes(ConstBytes{bytes.data(), bytes.size()});
    BakedScene sound;
    REQUIRE(BakedScene::open(scene.view(), &sound) == Status::kOk);
    REQUIRE(BakedScene::validate(scene.view()) == nullptr);
    REQUIRE(sound.tree().merged());
    shared = shared_of(sound.tree());
  }
};

// A picture of any renderer, in as many bytes as it has.
struct SmallPicture {
  Camera camera;
  Shading shading;
  HeapBytes pixels;
  Band band;

  SmallPicture(const Camera& from, Span<const Rgb8> palette)
      : camera(from), pixels(band_bytes(PixelFormat::kRgb888, from.width_px(), from.height_px())) {
    shading.mode = ShadeMode::kColor;
    shading.palette = palette;
    band.pixels = pixels.span();
    band.rows = camera.height_px();
  }
};

bool is_told(Status status) {
  return status == Status::kOk || status == Status::kDamaged || status == Status::kBadArgument ||
         status == Status::kOutOfRange || status == Status::kOutOfMemory || status == Status::kTooFine;
}

constexpr std::int32_t kWidthPx = 9;
constexpr std::int32_t kHeightPx = 7;

Camera outside(int level) {
  const Q8 half = Q8::saturate(-(std::int32_t{1} << level) / 2);
  Camera camera;
  REQUIRE(camera.set(PerspectiveView{{half, half, Q8::saturate(std::int32_t{1} << level)},
                                     {3, 3, -2},
                                     {},
                                     PerspectiveView{}.fov_degrees,
                                     kWidthPx,
                                     kHeightPx,
                                     0},
                     level) == Status::kOk);
  return camera;
}

Camera camera_of(const BakedScene& scene) {
  const int level = scene.tree().level();
  Camera camera;
  if (scene.has_camera() && set_camera(scene.camera(), kWidthPx, kHeightPx, level, &camera) == Status::kOk) {
    return camera;
  }
  return outside(level);
}

void draw_by_core(const BakedScene& scene) {
  SmallPicture picture(camera_of(scene), scene.palette());
  const CompactTree& tree = scene.tree();
  const auto drawn = [&](Status status) { REQUIRE(is_told(status)); };
  for (const Width width : {Width::k32, Width::k64}) {
    drawn(render_band(tree, picture.camera, picture.shading, picture.band, nullptr, {UINT32_MAX, width}));
  }
  picture.shading.mode = ShadeMode::kDepth;
  drawn(render_band_32(tree, picture.camera, picture.shading, picture.band));
  picture.shading.mode = ShadeMode::kColor;

  HeapBytes aligned(scene.section(SectionKind::kBrickMap));
  BrickMap map;
  if (BrickMap::open(aligned.span(), &map) == Status::kOk) {
    drawn(render_band(tree, map, picture.camera, picture.shading, picture.band));
    drawn(render_band_32(tree, map, picture.camera, picture.shading, picture.band));
  }
  HeapBytes table(node_colors_bytes(tree));
  NodeColors colors;
  Cutoff cutoff;
  drawn(NodeColors::make(tree, scene.palette(), {}, table.span(), &colors));
  REQUIRE(cutoff.set(picture.camera, Q16::saturate(2)) == Status::kOk);
  drawn(render_band_cut(tree, picture.camera, picture.shading, cutoff, colors, picture.band));

  HeapBytes memory(
      anytime_bytes(picture.camera.width_px(), picture.camera.height_px(), PixelFormat::kRgb888));
  AnytimeFrame frame;
  drawn(
      AnytimeFrame::make(tree, picture.camera, picture.shading, PixelFormat::kRgb888, memory.span(), &frame));
  for (int turn = 0; turn < 3 && !frame.done(); ++turn) {
    drawn(frame.refine(tree, 400));
  }

  if (tree.node_count() < 1000) {
    HeapBytes work(shared_work_bytes(tree.node_count()));
    HeapBytes room(std::size_t{1} << 13);
    SharedTree shared;
    if (SharedTree::make(tree, room.span(), work.span(), &shared) == Status::kOk) {
      drawn(render_band(shared, picture.camera, picture.shading, picture.band));
    }
  }
}

void draw_wide_and_lit(const BakedScene& scene) {
  constexpr std::size_t kMost = std::size_t{1} << 20;  // a damaged level asks for more
  SmallPicture picture(camera_of(scene), scene.palette());
  const CompactTree& tree = scene.tree();
  const std::size_t list_size = wide::VoxelLists::bytes(tree);
  if (list_size <= kMost) {
    HeapBytes memory(list_size);
    Arena arena(memory.span());
    wide::VoxelLists lists;
    if (wide::VoxelLists::make(tree, &arena, &lists) == Status::kOk) {
      HeapBytes work(wide::workspace_bytes(picture.camera.width_px(), picture.camera.height_px()));
      REQUIRE(
          is_told(wide::render(lists, picture.camera, picture.shading, picture.band, work.span(), nullptr)));
    }
  }
  BakedLighting lighting;
  if (BakedLighting::open(scene.section(SectionKind::kLighting), tree.level(), &lighting) != Status::kOk) {
    return;
  }
  const LitOptions options{3000, true};
  REQUIRE(is_told(render_lit_band(lighting.effects, tree, picture.camera, picture.shading, lighting.scene,
                                  picture.band, nullptr, options)));
  wide::RayMap map(tree);
  const std::size_t map_size = wide::RayMap::bytes(tree);
  HeapBytes memory(std::min(map_size, kMost));
  Arena arena(memory.span());
  if (map_size <= kMost) {
    (void)wide::RayMap::make(tree, &arena, &map);
  }
  HeapBytes work(wide::least_lit_workspace_bytes(lighting.effects, lighting.scene));
  REQUIRE(is_told(wide::render_lit(lighting.effects, map, picture.camera, picture.shading, lighting.scene,
                                   picture.band, work.span(), nullptr, nullptr, options)));
}

// Calls `use(bytes, is_repaired, number)` with each flip of `sound` that this run takes.
template <class Use>
void flip_each(ConstBytes sound, std::size_t step, void (*repair)(Bytes), const Use& use) {
  for (std::size_t number = 0; number < 2 * 8 * sound.size; number += all_flips() ? 1 : step) {
    const std::size_t bit = number / 2;
    CAPTURE(bit);
    HeapBytes flipped(sound);
    std::uint8_t& byte = flipped.span()[bit / 8];
    byte = static_cast<std::uint8_t>(byte ^ 1U << bit % 8);
    const bool is_repaired = number % 2 == 1;
    if (is_repaired) {
      repair(flipped.span());
    }
    use(flipped.span(), is_repaired, number);
  }
}

void flip_scene(ConstBytes sound) {
  int drawn = 0;
  int told = 0;
  flip_each(sound, many_or_few<std::size_t>(1, kFewFlips), repair_baked_checksums,
            [&](ConstBytes bytes, bool is_repaired, std::size_t number) {
              std::uint32_t place = 0;
              const char* const fault = BakedScene::validate(bytes, &place);
              if (!is_repaired) {
                REQUIRE(fault != nullptr);
              }
              told += fault != nullptr ? 1 : 0;
              const char* const broken = use_damaged(bytes, {3, -5, 7});
              REQUIRE(std::string(broken == nullptr ? "" : broken) == "");
              BakedScene scene;
              if (BakedScene::open(bytes, &scene) != Status::kOk) {
                return;
              }
              (void)BakedLighting::validate(scene.section(SectionKind::kLighting), scene.tree().level());
              draw_by_core(scene);
              if (all_flips() || number % kFewLit == 0) {
                draw_wide_and_lit(scene);
              }
              ++drawn;
            });
  CHECK(drawn > told / 2);
}

}  // namespace

TEST_CASE(
    "bit flips: a baked scene with light, water and bricks, one of level 9 -> refused, or read and drawn "
    "inside it") {
  for (const int level : {5, 9}) {
    CAPTURE(level);
    flip_scene(FlippedWorld(level).scene.view());
  }
}

TEST_CASE("bit flips: a shared tree -> refused, or traced and drawn inside it") {
  const FlippedWorld world(5);
  const ConstBytes sound = world.shared.span();
  HeapBytes work(shared_check_bytes(sound.size));
  const auto repair = [](Bytes bytes) { repair_checksum(bytes); };
  int drawn = 0;
  flip_each(sound, 1, repair, [&](ConstBytes bytes, bool is_repaired, std::size_t) {
    const char* const fault = SharedTree::validate(bytes, work.span());
    if (!is_repaired) {
      REQUIRE(fault != nullptr);
    }
    SharedTree tree;
    if (SharedTree::open(bytes, &tree) != Status::kOk) {
      REQUIRE(fault != nullptr);
      return;
    }
    SmallPicture picture(outside(tree.level()), {});
    for (const Width width : {Width::k32, Width::k64}) {
      RenderCounts counts;
      REQUIRE(is_told(
          render_band(tree, picture.camera, picture.shading, picture.band, &counts, {UINT32_MAX, width})));
      REQUIRE(counts.node_visits <= counts.rays * most_visits(tree.level()));
    }
    (void)tree.bytes_with_materials();
    ++drawn;
  });
  CHECK(drawn > 1000);
}

TEST_CASE("bit flips: thimble info -> a description, or a sentence and status 1") {
  const TemporaryFolder folder;
  const std::string path = folder.path("flipped.oct");
  int described = 0;
  int refused = 0;
  const auto describe = [&](ConstBytes bytes, bool, std::size_t) {
    folder.write("flipped.oct", {reinterpret_cast<const char*>(bytes.data), bytes.size});
    const CommandResult result = run_command({"info", path});
    CAPTURE(result.describe());
    REQUIRE((result.status == 0 || result.status == 1));
    REQUIRE((result.status == 0 || is_one_sentence(result.err)));
    described += result.status == 0 ? 1 : 0;
    refused += result.status == 1 ? 1 : 0;
  };
  for (const int level : {5, 9}) {
    flip_each(FlippedWorld(level).scene.view(), kFewCommands, repair_baked_checksums, describe);
  }
  CHECK(described > 0);
  CHECK(refused > 0);
}

}  // namespace thimble::tests
