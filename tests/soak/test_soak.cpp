// Every renderer, over random and real worlds, by cameras that stand on lattice points, look along diagonals and from
// inside: each pixel of each is the core's, and the core's hits are the judge's.
//
// A run takes four million pixels.
// THIMBLE_SOAK_MINUTES=60 runs for that long, with a seed of its own for each frame and a summary at the end (`make
// soak MINUTES=60 SEED=2`); with THIMBLE_DATA the scene files of that folder are among its worlds.
#include <doctest/doctest.h>

#include <chrono>
#include <cstdio>
#include <filesystem>

#include "readers/source.h"
#include "reference/reference.h"
#include "support/counts.h"
#include "support/frames.h"
#include "support/lit_cases.h"
#include "support/trial_worlds.h"
#include "thimble/light/map_render.h"
#include "thimble/tree/edited_world.h"

namespace thimble::tests {
namespace {

double number_from(const char* name, double otherwise) {
  const char* const given = std::getenv(name);
  return given == nullptr ? otherwise : std::atof(given);
}

std::uint64_t pixels_of(const FrameCase& frame) {
  return static_cast<std::uint64_t>(frame.camera.width_px()) * static_cast<std::uint64_t>(frame.band.rows);
}

// The scene files of THIMBLE_DATA that are small enough to be read at once: as they are, or of 128 or 256 voxels a side.
void add_files(std::vector<Subject>* made) {
  const char* const folder = std::getenv("THIMBLE_DATA");
  if (folder == nullptr || number_from("THIMBLE_SOAK_MINUTES", 0) <= 0) {
    return;
  }
  constexpr std::uintmax_t kMostBytes = 3000000;
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.file_size() <= kMostBytes) {
      names.push_back(entry.path().string());
    }
  }
  std::sort(names.begin(), names.end());
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (const char* const depth : {i % 2 == 0 ? "@7" : "@8", ""}) {
      try {
        const TrialWorld world(names[i] + depth);
        if (world.tree().node_count() < 400000) {
          made->emplace_back(scene_of({world.tree().bytes(), world.tree().size_bytes()}, "file"));
        }
        break;
      } catch (const tools::InputError&) {
        // No scene, or one that has its own size.
      }
    }
  }
  std::printf("%zu files of %s\n", made->size(), folder);
}

// The real ones among all worlds: houses and hills, a thick ball, and the command's own scenes.
std::vector<Subject>& real_worlds() {
  static std::vector<Subject> worlds = [] {
    std::vector<Subject> made;
    add_files(&made);
    for (const char* const name : {"city:8", "terrain:9", "globe:7", "spheres,depth=7",
                                   "cluster:20000,depth=8,seed=3", "water,depth=6"}) {
      const TrialWorld world(name);
      made.emplace_back(scene_of({world.tree().bytes(), world.tree().size_bytes()}, name));
    }
    return made;
  }();
  return worlds;
}

void draw_lit(std::mt19937_64& random, std::uint64_t seed, const WideScene& scene, const FrameCase& frame,
              Tallies* tallies) {
  if (wide::RayMap::bytes(scene.tree) > std::size_t{1} << (pick(random, 0, 9) == 0 ? 28 : 24)) {
    return;  // a second a map, of all worlds of level 12
  }
  const LitCase lit = random_light(random, scene.level);
  const LitDrawn expected = draw_lit_core(scene, frame, lit);
  FrameCase half = frame;
  half.band.rows = frame.band.rows / 2;
  half.band.rows -= half.band.rows % band_row_multiple(frame.band.format);
  const LitDrawn again = draw_lit_core(scene, half, lit);
  tallies->add("lit core, half of it", pixels_of(half),
               std::equal(again.pixels.begin(), again.pixels.end(), expected.pixels.begin()), seed);
  const HeapBytes memory(wide::RayMap::bytes(scene.tree));
  Arena arena(memory.span());
  wide::RayMap map;
  REQUIRE(wide::RayMap::make(scene.tree, &arena, &map) == Status::kOk);
  use_random_instruction_set(random);
  const int threads = pick_int(random, 1, 3);
  const std::size_t workspace =
      wide::lit_workspace_bytes(lit.effects, lit.scene) * static_cast<std::size_t>(threads);
  const LitDrawn ours = draw_lit_streams(scene, map, frame, lit, workspace, threads);
  const char* const of_level = scene.level > 10 ? ", level 11 and 12" : "";
  tallies->add(std::string(threads > 1 ? "lit streams, threads" : "lit streams") + of_level, pixels_of(frame),
               ours.pixels == expected.pixels, seed);
}

// Suns and little else, for which light by a brick map has a way of its own; or any light.
LitCase light_for_maps(std::mt19937_64& random, int level) {
  LitCase lit = random_light(random, level);
  if (pick(random, 0, 3) != 0) {
    lit.effects &= Effect::kAmbientOcclusion | Effect::kEmission | Effect::kMirror | Effect::kSky;
    lit.effects |= Effect::kDirectLight | Effect::kShadows;
    lit.lights.resize(std::min<std::size_t>(lit.lights.size(), kMaxFlatSuns));
    lit.scene.lights = {lit.lights.data(), lit.lights.size()};
  }
  return lit;
}

// A world that is edited, in light by its map and by what is proven of its suns, beside a tree of it that is made anew.
void draw_edited(std::mt19937_64& random, std::uint64_t seed, const WideScene& scene, const FrameCase& frame,
                 Tallies* tallies) {
  const std::size_t least = EditedWorld::least_bytes(scene.tree);
  const HeapBytes bytes(least + (std::size_t{1} << 20));
  EditedWorld world;
  if (least == 0 || EditedWorld::make(scene.tree, EditedWorld::room_in(scene.tree, bytes.view().size),
                                      bytes.span(), &world) != Status::kOk) {
    return;
  }
  const LitCase lit = light_for_maps(random, scene.level);
  std::vector<HeapBytes> proven;
  std::vector<SunBricks> suns;
  for (const Light& light : lit.lights) {
    if (!light.is_point) {
      proven.emplace_back(SunBricks::bytes(world.map()));
      REQUIRE(SunBricks::make(world.map(), light.place, proven.back().span(), &suns.emplace_back()) ==
              Status::kOk);
      suns.back().prove(pick(random, 0, 1) == 0 ? UINT32_MAX : 20000);
    }
  }
  const HeapBytes journal_bytes(std::size_t{1} << 18);
  EditJournal journal(journal_bytes.span());
  for (int edits = pick_int(random, 0, 3); edits > 0; --edits) {
    VoxelBox box;
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = pick_int(random, world.bounds().low[axis] - 9, world.bounds().high[axis] + 9);
      box.high[axis] = box.low[axis] + pick_int(random, 1, 12);
    }
    (void)world.edit(box, pick(random, 0, 1) == 0 ? EditShape::kBox : EditShape::kBall,
                     pick_int(random, -1, 9), &journal);
    for (SunBricks& sun : suns) {
      (void)sun.follow(world, static_cast<std::uint32_t>(pick(random, 0, 2000)));
    }
    if (pick(random, 0, 3) != 0) {
      world.forget_changes();
    }
  }
  std::size_t size = 0;
  (void)world.pack({}, &size);
  const HeapBytes packed(size);
  REQUIRE(world.pack(packed.span()) == Status::kOk);
  const LitDrawn expected = draw_lit_core(scene_of(packed.view(), "edited"), frame, lit);
  std::vector<std::uint8_t> pixels(expected.pixels.size(), 0xA5);
  Band band = frame.band;
  band.pixels = Bytes(pixels.data(), pixels.size());
  const Status status = render_lit_band(lit.effects, world.tree(), world.map(), frame.camera, frame.shading,
                                        lit.scene, {suns.data(), suns.size()}, band, nullptr, lit.options);
  tallies->add(scene.level > kMaxBrickMapLevel ? "lit bricks of edited worlds, level 9 and 10"
                                               : "lit bricks of edited worlds",
               pixels_of(frame), status == Status::kOk && pixels == expected.pixels, seed);
}

// Some of the frame's rays by the exact judge, where a grid holds the world.
void judge(std::mt19937_64& random, std::uint64_t seed, const WideScene& scene, const FrameCase& frame,
           Tallies* tallies) {
  if (scene.level > 6 || scene.tree.merged()) {
    return;
  }
  const int side = 1 << scene.level;
  reference::BitGrid grid({side, side, side});
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        if (material_at(scene.tree, Vec3i{x, y, z}, nullptr)) {
          grid.set({x, y, z});
        }
      }
    }
  }
  constexpr int kJudged = 64;
  bool is_right = true;
  for (int i = 0; i < kJudged; ++i) {
    const auto x = pick_int(random, 0, frame.camera.width_px() - 1);
    const auto y = pick_int(random, 0, frame.camera.height_px() - 1);
    const Ray ray = frame.camera.ray(x, y);
    Hit hit;
    REQUIRE(closest_hit(scene.tree, ray, &hit) == Status::kOk);
    is_right = is_right && same_answer(hit, reference::walk(grid, to_reference(ray)));
  }
  tallies->add("rays of the core, by the judge", kJudged, is_right, seed);
}

// Four frames of one world by every engine, in light and by the judge.
void draw_frames(std::uint64_t seed, const std::vector<Engine>& engines, Tallies* tallies) {
  std::mt19937_64 random(seed);
  const WorldRow kWorlds[] = {worlds::kAny,   worlds::kCabinet, worlds::kDeep,
                              worlds::kSolid, worlds::kSolid,   worlds::kStars};
  std::vector<Subject>& real = real_worlds();
  std::optional<Subject> own;
  if (pick(random, 0, 3) != 0) {
    own.emplace(kWorlds[pick(random, 0, 5)].make(random));
  }
  Subject& subject =
      own ? *own
          : real[static_cast<std::size_t>(pick(random, 0, static_cast<std::int64_t>(real.size()) - 1))];
  for (int view = 0; view < 4; ++view) {
    // Most of a deep world is empty: a camera that finds what is solid.
    const bool is_deep = subject.map().level() > kMaxBrickMapLevel && view % 2 == 1;
    const bool is_large = subject.tree().level() > wide::kCubeLevel && view % 2 == 1;
    FrameCase frame;
    if (!make_frame(random, subject.scene(),
                    is_large  ? cameras::kFine
                    : is_deep ? cameras::kDeep
                              : cameras::kHard,
                    &frame)) {
      continue;
    }
    (void)draw_by_all(engines, subject, frame, random, seed, tallies);
    frame.band.stride_bytes = 0;
    if (view < 2) {
      draw_edited(random, seed, subject.scene(), frame, tallies);
    }
    if (view == 0) {
      draw_lit(random, seed, subject.scene(), frame, tallies);
      judge(random, seed, subject.scene(), frame, tallies);
    }
  }
}

void publish(const Tallies& drawn, std::uint64_t first_seed, std::uint64_t end_seed, double seconds) {
  std::printf(
      "| renderer | frames | pixels | wrong frames | first seed that shows it |\n"
      "| --- | ---: | ---: | ---: | ---: |\n");
  std::vector<Tally> tallies = drawn.rows();
  std::sort(tallies.begin(), tallies.end(),
            [](const Tally& one, const Tally& other) { return one.name < other.name; });
  for (const Tally& tally : tallies) {
    std::printf("| %s | %llu | %llu | %llu | %s |\n", tally.name.c_str(),
                static_cast<unsigned long long>(tally.frames), static_cast<unsigned long long>(tally.pixels),
                static_cast<unsigned long long>(tally.wrong),
                tally.wrong == 0 ? "" : std::to_string(tally.first_wrong_seed).c_str());
  }
  std::printf("\n%llu pixels, seeds %llu to %llu, %.0f s, %llu frames wrong\n",
              static_cast<unsigned long long>(drawn.pixels()), static_cast<unsigned long long>(first_seed),
              static_cast<unsigned long long>(end_seed - 1), seconds,
              static_cast<unsigned long long>(drawn.wrong()));
}

}  // namespace

TEST_CASE("soak: every renderer, hard cameras, random and real worlds -> every pixel is the core's") {
  const BestInstructionSet after;
  const std::uint64_t kPixels = many_or_few<std::uint64_t>(4000000, 100000);
  const auto first_seed = static_cast<std::uint64_t>(number_from("THIMBLE_SOAK_SEED", 1));
  const double minutes = number_from("THIMBLE_SOAK_MINUTES", 0);
  const auto begin = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  std::vector<Engine> engines = core_engines();
  for (Engine& engine : wide_engines()) {
    engines.push_back(std::move(engine));
  }
  Tallies drawn;
  std::uint64_t seed = first_seed;
  while (drawn.pixels() < kPixels || seconds() < 60 * minutes) {
    draw_frames(seed++, engines, &drawn);
  }
  if (minutes > 0 || drawn.wrong() != 0) {
    publish(drawn, first_seed, seed, seconds());
  }
  CHECK(drawn.wrong() == 0);
  // None was left out.
  CHECK(drawn.rows().size() >= 11);
}

}  // namespace thimble::tests
