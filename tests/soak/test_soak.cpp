// Every renderer, over random and real worlds, by cameras that stand on lattice points, look along diagonals and from
// inside: each pixel of each is the core's, and the core's hits are the judge's.
//
// A run takes four million pixels, a hundred thousand of them by maps of worlds of level 9 and 10.
// THIMBLE_SOAK_MINUTES=60 goes on for that long, with a seed of its own for each frame and a summary at the end (`make
// soak MINUTES=60 SEED=2`); with THIMBLE_DATA the scene files of that folder are among its worlds.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "readers/source.h"
#include "reference/reference.h"
#include "support/counts.h"
#include "support/deep_worlds.h"
#include "support/hard_frames.h"
#include "support/lit_cases.h"
#include "support/solid_worlds.h"
#include "support/trial_worlds.h"
#include "thimble/picture/anytime.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/shared_tree.h"

namespace thimble::tests {
namespace {

double number_from(const char* name, double otherwise) {
  const char* const given = std::getenv(name);
  return given == nullptr ? otherwise : std::atof(given);
}

constexpr const char* kDeepBricks = "bricks, worlds of level 9 and 10";

// What a renderer drew so far, and how much of it was not the core's.
struct Tally {
  std::string name;
  std::uint64_t frames = 0;
  std::uint64_t pixels = 0;
  std::uint64_t wrong_frames = 0;
  std::uint64_t first_wrong_seed = 0;
};

class Soak {
 public:
  explicit Soak(std::uint64_t first_seed) : seed_(first_seed) {}

  void frame() {
    std::mt19937_64 random(seed_);
    draw_frame(random);
    ++seed_;
  }
  std::uint64_t next_seed() const { return seed_; }
  std::uint64_t pixels() const {
    std::uint64_t sum = 0;
    for (const Tally& tally : tallies_) {
      sum += tally.pixels;
    }
    return sum;
  }
  std::uint64_t pixels_of_deep_worlds() const {
    const auto at = std::find_if(tallies_.begin(), tallies_.end(),
                                 [](const Tally& tally) { return tally.name == kDeepBricks; });
    return at == tallies_.end() ? 0 : at->pixels;
  }
  std::uint64_t wrong() const {
    std::uint64_t sum = 0;
    for (const Tally& tally : tallies_) {
      sum += tally.wrong_frames;
    }
    return sum;
  }
  const std::vector<Tally>& tallies() const { return tallies_; }

 private:
  void count(const std::string& name, std::uint64_t pixels, bool is_right) {
    auto at = std::find_if(tallies_.begin(), tallies_.end(),
                           [&](const Tally& tally) { return tally.name == name; });
    if (at == tallies_.end()) {
      at = tallies_.insert(tallies_.end(), Tally{name, 0, 0, 0, 0});
    }
    ++at->frames;
    at->pixels += pixels;
    if (!is_right && at->wrong_frames++ == 0) {
      at->first_wrong_seed = seed_;
    }
  }
  void draw_frame(std::mt19937_64& random);
  void draw_by_core(const WideScene& scene, const FrameCase& frame,
                    const std::vector<std::uint8_t>& expected);
  void draw_bricks(const WideScene& scene, const BrickMap& map, const FrameCase& frame,
                   const std::vector<std::uint8_t>& expected);
  void draw_anytime(const WideScene& scene, const FrameCase& frame,
                    const std::vector<std::uint8_t>& expected);
  void draw_wide_all(std::mt19937_64& random, const WideScene& scene, const FrameCase& frame,
                     const std::vector<std::uint8_t>& expected);
  void draw_lit(std::mt19937_64& random, const WideScene& scene, const FrameCase& frame);
  void judge(std::mt19937_64& random, const WideScene& scene, const FrameCase& frame);

  std::uint64_t seed_;
  std::vector<Tally> tallies_;
};

std::uint64_t pixels_of(const FrameCase& frame) {
  return static_cast<std::uint64_t>(frame.camera.width_px()) * static_cast<std::uint64_t>(frame.band.rows);
}

// The frame's band by `draw(band)`, which returns its status.
template <class Draw>
bool same_as(const FrameCase& frame, const std::vector<std::uint8_t>& expected, Status* status,
             const Draw& draw) {
  const HeapBytes pixels(band_size(frame));
  std::memset(pixels.span().data, 0xA5, pixels.span().size);
  Band band = frame.band;
  band.pixels = pixels.span();
  *status = draw(band);
  return *status == Status::kOk && std::equal(expected.begin(), expected.end(), pixels.view().begin());
}

// The scene files of THIMBLE_DATA that are small enough to be read at once: as they are, or of 128 or 256 voxels a side.
void add_files(std::vector<WideScene>* made) {
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
          made->push_back(scene_of({world.tree().bytes(), world.tree().size_bytes()}, "file"));
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
const std::vector<WideScene>& real_worlds() {
  static const std::vector<WideScene> worlds = [] {
    std::vector<WideScene> made;
    add_files(&made);
    for (const auto& bytes : {city(8), thick_terrain(9), full_ball(7)}) {
      made.push_back(scene_of({bytes.data(), bytes.size()}, "solid"));
    }
    for (const char* const name : {"spheres,depth=7", "cluster:20000,depth=8,seed=3", "water,depth=6"}) {
      const TrialWorld world(name);
      made.push_back(scene_of({world.tree().bytes(), world.tree().size_bytes()}, name));
    }
    return made;
  }();
  return worlds;
}

WideScene any_world(std::mt19937_64& random) {
  switch (pick(random, 0, 4)) {
    case 0:
      return random_scene(random);
    case 1:
      return cabinet(random);
    case 2: {
      const auto kind = static_cast<DeepWorld>(pick(random, 0, kDeepWorldKinds - 1));
      return scene_of(make_deep_tree(random, kind, pick_int(random, 9, 10)).view(), "deep");
    }
    default:
      // Up to level 8 brick maps have one directory.
      return solid_scene(random, static_cast<int>(pick(random, 2, pick(random, 0, 2) == 0 ? 12 : 8)));
  }
}

void Soak::draw_by_core(const WideScene& scene, const FrameCase& frame,
                        const std::vector<std::uint8_t>& expected) {
  Status status = Status::kOk;
  const CompactTree& tree = scene.tree;
  bool same = same_as(frame, expected, &status, [&](const Band& band) {
    return render_band(tree, frame.camera, frame.shading, band, nullptr, {UINT32_MAX, Width::k64});
  });
  count("core, 64 bits", pixels_of(frame), same);
  same = same_as(frame, expected, &status,
                 [&](const Band& band) { return render_band_32(tree, frame.camera, frame.shading, band); });
  if (status == Status::kBadArgument) {  // some ray is not for this path
    bool all_accepted = true;
    for (std::int32_t y = 0; y < frame.camera.height_px(); ++y) {
      for (std::int32_t x = 0; x < frame.camera.width_px(); ++x) {
        all_accepted = all_accepted && accepts_32(frame.camera.ray(x, y), scene.level);
      }
    }
    count("core, 32 bits: refused", 0, !all_accepted);
  } else {
    count("core, 32 bits", pixels_of(frame), same);
  }
  same = same_as(frame, expected, &status, [&](const Band& band) {
    return render_band_cut(tree, frame.camera, frame.shading, Cutoff(), NodeColors(), band);
  });
  count("cut-off of nothing", pixels_of(frame), same);

  const CompactShape shape{tree.level(),          kDefaultRankShift,     tree.node_count(), tree.node_count(),
                           8 * tree.node_count(), tree.many_materials(), tree.merged()};
  if (tree.node_count() < 50000) {
    const HeapBytes room(shared_tree_bytes(shape));
    const HeapBytes work(shared_work_bytes(tree.node_count()));
    SharedTree shared;
    REQUIRE(SharedTree::make(tree, room.span(), work.span(), &shared) == Status::kOk);
    same = same_as(frame, expected, &status,
                   [&](const Band& band) { return render_band(shared, frame.camera, frame.shading, band); });
    count("shared tree", pixels_of(frame), same);
  }
}

void Soak::draw_bricks(const WideScene& scene, const BrickMap& map, const FrameCase& frame,
                       const std::vector<std::uint8_t>& expected) {
  if (!draws_fast(map, frame.camera)) {
    return;
  }
  const bool is_deep = scene.level > kMaxBrickMapLevel;
  Status status = Status::kOk;
  const auto draw = [&](const Band& band) {
    return render_band(scene.tree, map, frame.camera, frame.shading, band);
  };
  count(is_deep ? kDeepBricks : "bricks", pixels_of(frame), same_as(frame, expected, &status, draw));
  // Row by row, or as many as a page has.
  const std::int32_t step = band_row_multiple(frame.band.format);
  bool is_right = true;
  const std::size_t stride = row_bytes(frame.band.format, frame.camera.width_px());
  for (std::int32_t row = 0; row < frame.band.rows; row += step) {
    FrameCase part = frame;
    part.band.first_row = row;
    part.band.rows = std::min(step, frame.band.rows - row);
    const std::size_t first = stride * static_cast<std::size_t>(row_place(frame.band.format, row));
    const std::size_t size = band_size(part);
    const std::vector<std::uint8_t> wanted(expected.begin() + static_cast<std::ptrdiff_t>(first),
                                           expected.begin() + static_cast<std::ptrdiff_t>(first + size));
    is_right =
        is_right && same_as(part, wanted, &status, [&](const Band& band) {
          return is_deep ? draw(band) : render_band_32(scene.tree, map, frame.camera, frame.shading, band);
        });
  }
  count(is_deep ? std::string(kDeepBricks) + ", by rows" : "bricks, 32 bits, by rows", pixels_of(frame),
        is_right);
}

void Soak::draw_anytime(const WideScene& scene, const FrameCase& frame,
                        const std::vector<std::uint8_t>& expected) {
  const HeapBytes memory(anytime_bytes(frame.camera.width_px(), frame.camera.height_px(), frame.band.format));
  AnytimeFrame drawn;
  REQUIRE(AnytimeFrame::make(scene.tree, frame.camera, frame.shading, frame.band.format, memory.span(),
                             &drawn) == Status::kOk);
  for (int turn = 0; turn < 100000 && !drawn.done(); ++turn) {
    REQUIRE(drawn.refine(scene.tree, 100000) == Status::kOk);
  }
  const Band band = drawn.band(0, frame.camera.height_px());
  count("any-time", pixels_of(frame),
        drawn.done() && std::equal(expected.begin(), expected.end(), band.pixels.begin()));
}

void Soak::draw_wide_all(std::mt19937_64& random, const WideScene& scene, const FrameCase& frame,
                         const std::vector<std::uint8_t>& expected) {
  for (int set = 0; set < wide::instruction_set_count(); ++set) {
    wide::use_instruction_set(set);
    const wide::Options options = random_options(random);
    const bool threads = thread_count(options) > 1;
    const std::string name = std::string("wide, ") + wide::instruction_set() + (threads ? ", threads" : "");
    if (const auto ours = draw_wide(scene, frame, options)) {
      count(name, pixels_of(frame), *ours == expected);
    }
  }
}

void Soak::draw_lit(std::mt19937_64& random, const WideScene& scene, const FrameCase& frame) {
  if (wide::RayMap::bytes(scene.tree) > std::size_t{1} << 24) {
    return;  // a second a map
  }
  const LitCase lit = random_light(random, scene.level);
  const LitDrawn expected = draw_lit_core(scene, frame, lit);
  FrameCase half = frame;
  half.band.rows = frame.band.rows / 2;
  half.band.rows -= half.band.rows % band_row_multiple(frame.band.format);
  const LitDrawn again = draw_lit_core(scene, half, lit);
  count("lit core, half of it", pixels_of(half),
        std::equal(again.pixels.begin(), again.pixels.end(), expected.pixels.begin()));
  const HeapBytes memory(wide::RayMap::bytes(scene.tree));
  Arena arena(memory.span());
  wide::RayMap map;
  REQUIRE(wide::RayMap::make(scene.tree, &arena, &map) == Status::kOk);
  use_random_instruction_set(random);
  const int threads = static_cast<int>(pick(random, 1, 3));
  const std::size_t workspace =
      wide::lit_workspace_bytes(lit.effects, lit.scene) * static_cast<std::size_t>(threads);
  const LitDrawn ours = draw_lit_streams(scene, map, frame, lit, workspace, threads);
  count(threads > 1 ? "lit streams, threads" : "lit streams", pixels_of(frame),
        ours.pixels == expected.pixels);
}

// Some of the frame's rays by the exact judge, where a grid holds the world.
void Soak::judge(std::mt19937_64& random, const WideScene& scene, const FrameCase& frame) {
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
    const auto x = static_cast<std::int32_t>(pick(random, 0, frame.camera.width_px() - 1));
    const auto y = static_cast<std::int32_t>(pick(random, 0, frame.camera.height_px() - 1));
    const Ray ray = frame.camera.ray(x, y);
    Hit hit;
    REQUIRE(closest_hit(scene.tree, ray, &hit) == Status::kOk);
    is_right = is_right && same_answer(hit, reference::walk(grid, to_reference(ray)));
  }
  count("rays of the core, by the judge", kJudged, is_right);
}

// Most of such a world is empty: a camera that finds what is solid.
void look_at_deep(std::mt19937_64& random, const WideScene& scene, FrameCase* frame) {
  frame->camera = hard_deep_camera(random, scene.tree);
  frame->band.rows = frame->camera.height_px();
  set_depth_range(scene, frame);
}

void Soak::draw_frame(std::mt19937_64& random) {
  const bool is_real = pick(random, 0, 3) == 0;
  const std::vector<WideScene>& real = real_worlds();
  const WideScene own = is_real ? WideScene{} : any_world(random);
  const WideScene& scene =
      is_real ? real[static_cast<std::size_t>(pick(random, 0, static_cast<std::int64_t>(real.size()) - 1))]
              : own;
  const HeapBytes room(std::min(most_brick_map_bytes(scene.tree), std::size_t{1} << 23));
  BrickMap map;  // of no level where there is none
  (void)BrickMap::make(scene.tree, room.span(), &map);
  for (int view = 0; view < 4; ++view) {
    FrameCase frame;
    if (!hard_frame(random, scene, &frame)) {
      continue;
    }
    if (map.level() > kMaxBrickMapLevel && view % 2 == 1) {
      look_at_deep(random, scene, &frame);
    }
    std::uint64_t hits = 0;
    const std::vector<std::uint8_t> expected = draw_core(scene, frame, &hits);
    draw_by_core(scene, frame, expected);
    draw_bricks(scene, map, frame, expected);
    draw_anytime(scene, frame, expected);
    draw_wide_all(random, scene, frame, expected);
    if (view == 0) {
      draw_lit(random, scene, frame);
      judge(random, scene, frame);
    }
  }
}

void publish(const Soak& soak, std::uint64_t first_seed, double seconds) {
  std::printf(
      "| renderer | frames | pixels | wrong frames | first seed that shows it |\n"
      "| --- | ---: | ---: | ---: | ---: |\n");
  std::vector<Tally> tallies = soak.tallies();
  std::sort(tallies.begin(), tallies.end(),
            [](const Tally& one, const Tally& other) { return one.name < other.name; });
  for (const Tally& tally : tallies) {
    std::printf("| %s | %llu | %llu | %llu | %s |\n", tally.name.c_str(),
                static_cast<unsigned long long>(tally.frames), static_cast<unsigned long long>(tally.pixels),
                static_cast<unsigned long long>(tally.wrong_frames),
                tally.wrong_frames == 0 ? "" : std::to_string(tally.first_wrong_seed).c_str());
  }
  std::printf("\n%llu pixels, seeds %llu to %llu, %.0f s, %llu frames wrong\n",
              static_cast<unsigned long long>(soak.pixels()), static_cast<unsigned long long>(first_seed),
              static_cast<unsigned long long>(soak.next_seed() - 1), seconds,
              static_cast<unsigned long long>(soak.wrong()));
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
  Soak soak(first_seed);
  while (soak.pixels() < kPixels || soak.pixels_of_deep_worlds() < kPixels / 40 || seconds() < 60 * minutes) {
    soak.frame();
  }
  if (minutes > 0 || soak.wrong() != 0) {
    publish(soak, first_seed, seconds());
  }
  CHECK(soak.wrong() == 0);
  // None was left out.
  CHECK(soak.tallies().size() >= 11);
}

}  // namespace thimble::tests
