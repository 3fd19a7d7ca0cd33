// The wide renderer in scenes that are made for one of its ways to draw: every pixel is the core's.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scene/built_scene.h"
#include "scene/framing.h"
#include "scene/scene_source.h"
#include "scene/wide_renderer.h"
#include "support/wide_cases.h"

namespace thimble::tests {

TEST_CASE("wide: greys found as voxels are met -> every pixel is the core's, between any two planes") {
  const BestInstructionSet after;
  const int kFrames = many_or_few(800, 150);
  std::uint64_t met = 0;
  std::uint64_t exact = 0;
  for (int i = 0; i < kFrames; ++i) {
    const std::uint64_t seed = 52000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    CAPTURE(seed);
    const int level = static_cast<int>(pick(random, 6, 10));
    const std::int64_t side = std::int64_t{1} << level;
    // Near one another in part, so that some lie before others; no eight that make a block.
    const WideScene scene = make_scene(level, [&](Octree* octree) {
      for (std::int64_t n = pick(random, 1, 6000); n > 0; --n) {
        const std::int64_t most = pick(random, 0, 2) == 0 ? side - 1 : std::min<std::int64_t>(side - 1, 63);
        const Vec3i at = random_voxel(random, 0, most);
        if ((at.x & at.y & at.z & 1) == 0) {
          REQUIRE(octree->insert(at, 1) == Status::kOk);
        }
      }
    });
    REQUIRE_FALSE(scene.lists.has_blocks());
    use_random_instruction_set(random);
    FrameCase frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    frame.shading.mode = ShadeMode::kDepth;
    if (pick(random, 0, 1) == 0) {
      // Some part of the range; where floats do not tell greys, they are found at the end.
      const std::int64_t range = frame.shading.far_q8 - std::int64_t{frame.shading.near_q8};
      const std::int64_t part = range >> pick(random, 0, 3);
      if (range > 0 && part > 0 && frame.shading.near_q8 >= 0) {
        frame.shading.near_q8 += static_cast<std::int32_t>(pick(random, 0, range - part));
        frame.shading.far_q8 = frame.shading.near_q8 + static_cast<std::int32_t>(part);
      }
    }
    CAPTURE(scene.level);
    CAPTURE(wide::instruction_set());
    CAPTURE(frame.camera.is_perspective());
    CAPTURE(frame.shading.near_q8);
    CAPTURE(frame.shading.far_q8);
    const wide::Options options = random_options(random);
    wide::Stats stats;
    const auto ours = draw_wide(scene, frame, options, nullptr, &stats);
    if (!ours) {
      continue;
    }
    std::uint64_t expected_hits = 0;
    CHECK(*ours == draw_core(scene, frame, &expected_hits));
    met += stats.counts.hits;
    exact += stats.counts.exact;
  }
  CHECK(met > 20 * static_cast<std::uint64_t>(kFrames));
  INFO(exact << " of " << met);
  CHECK(exact > met / 500);
}

TEST_CASE("wide: thick surfaces, voxels of about a pixel to many -> every pixel is the core's") {
  const BestInstructionSet after;
  const int kFrames = many_or_few(48, 4);
  for (int i = 0; i < kFrames; ++i) {
    const std::uint64_t seed = 300 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    CAPTURE(seed);
    // Balls with holes, so that blocks of several sizes and single voxels lie before one another.
    const int level = static_cast<int>(pick(random, 5, 8));
    const std::int32_t side = std::int32_t{1} << level;
    const auto fill = [&](Octree* octree) {
      const std::int64_t holes = pick(random, 0, 60);
      for (int ball = 0; ball < 4; ++ball) {
        const Vec3i middle = random_voxel(random, 0, side - 1);
        const auto radius = static_cast<std::int32_t>(pick(random, 2, std::min(40, side / 3)));
        for (std::int32_t z = std::max(0, middle.z - radius); z < std::min(side, middle.z + radius); ++z) {
          for (std::int32_t y = std::max(0, middle.y - radius); y < std::min(side, middle.y + radius); ++y) {
            for (std::int32_t x = std::max(0, middle.x - radius); x < std::min(side, middle.x + radius);
                 ++x) {
              const std::int32_t dx = x - middle.x;
              const std::int32_t dy = y - middle.y;
              const std::int32_t dz = z - middle.z;
              if (dx * dx + dy * dy + dz * dz < radius * radius && pick(random, 0, 99) >= holes) {
                REQUIRE(octree->insert({x, y, z}, static_cast<std::uint8_t>(ball)) == Status::kOk);
              }
            }
          }
        }
      }
    };
    const WideScene scene = make_scene(level, fill, std::size_t{48} << 20);
    FrameCase frame;
    const double world = 256.0 * side;
    PerspectiveView view;
    view.eye = {Q8::from_raw(static_cast<std::int32_t>(0.2 * world)),
                Q8::from_raw(static_cast<std::int32_t>(-0.62 * world)),
                Q8::from_raw(static_cast<std::int32_t>(0.75 * world))};
    view.forward = {static_cast<std::int32_t>(pick(random, 200, 400)), 1120, -300};
    view.fov_degrees = Q16::from_raw(static_cast<std::int32_t>(pick(random, 10, 70)) * 65536);
    view.width_px = 500;
    view.height_px = 360;
    REQUIRE(frame.camera.set(view, scene.level) == Status::kOk);
    frame.shading.mode = i % 2 == 0 ? ShadeMode::kDepth : ShadeMode::kColor;
    set_depth_range(scene, &frame);
    frame.band.rows = 360;
    std::uint64_t hits = 0;
    const auto expected = draw_core(scene, frame, &hits);
    for (const int threads : {1, 2}) {
      use_random_instruction_set(random);
      CAPTURE(wide::instruction_set());
      CAPTURE(threads);
      const wide::Options options = options_of(threads, wide::Order::kBlocks);
      const auto ours = draw_wide(scene, frame, options);
      REQUIRE(ours.has_value());
      CHECK(*ours == expected);
    }
  }
}

TEST_CASE("wide: clouds of voxels of a part of a pixel to some -> every pixel is the core's") {
  const BestInstructionSet after;
  const int kClouds = many_or_few(8, 2);
  const int kViews = many_or_few(12, 3);
  std::uint64_t boxes = 0;
  std::uint64_t candidates = 0;
  for (int i = 0; i < kClouds; ++i) {
    const std::uint64_t seed = 9100 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    CAPTURE(seed);
    // Single voxels: so many that they hide one another, here more of them, there fewer.
    const int level = static_cast<int>(pick(random, 6, 8));
    const std::int32_t side = std::int32_t{1} << level;
    const auto fill = [&](Octree* octree) {
      const std::int64_t per_thousand = pick(random, 5, 60);
      const std::int64_t points = std::int64_t{side} * side * side * per_thousand / 1000;
      for (std::int64_t n = 0; n < points; ++n) {
        const std::int32_t most = n % 3 == 0 ? side / 2 : side;
        REQUIRE(octree->insert({static_cast<std::int32_t>(pick(random, 0, most - 1)),
                                static_cast<std::int32_t>(pick(random, 0, side - 1)),
                                static_cast<std::int32_t>(pick(random, 0, most - 1))},
                               1) == Status::kOk);
      }
    };
    const WideScene scene = make_scene(level, fill, std::size_t{64} << 20);
    REQUIRE_FALSE(scene.lists.has_blocks());
    for (int v = 0; v < kViews; ++v) {
      CAPTURE(v);
      FrameCase frame;
      const auto width = static_cast<std::int32_t>(pick(random, 60, 260));
      const auto height = static_cast<std::int32_t>(pick(random, 40, 180));
      const Vec3Q8 middle{Q8::from_raw(128 * side), Q8::from_raw(128 * side), Q8::from_raw(128 * side)};
      // Voxels of `px` pixels at the middle of the world.
      const double px = 0.2 * std::pow(15.0, static_cast<double>(pick(random, 0, 1000)) / 1000);
      Vec3i away{static_cast<std::int32_t>(pick(random, -100, 100)),
                 static_cast<std::int32_t>(pick(random, -100, 100)),
                 static_cast<std::int32_t>(pick(random, -100, 100))};
      if (v % 4 == 3) {  // along an axis
        away = {0, 0, 0};
        away[static_cast<int>(pick(random, 0, 2))] = pick(random, 0, 1) == 0 ? 100 : -100;
      }
      if (away == Vec3i{0, 0, 0}) {
        away.x = 1;
      }
      const double length = std::sqrt(1.0 * away.x * away.x + 1.0 * away.y * away.y + 1.0 * away.z * away.z);
      bool is_set = false;
      if (v % 2 == 0) {
        const double fov = static_cast<double>(pick(random, 20, 100));
        const double focal_px = height / 2.0 / std::tan(fov / 360 * 3.14159265358979);
        const double far = std::min(focal_px / px, 4.0 * side);  // in voxels; inside the cloud, now and then
        PerspectiveView view;
        for (int axis = 0; axis < 3; ++axis) {
          view.eye[axis] =
              Q8::from_raw(middle[axis].raw + static_cast<std::int32_t>(256 * far * away[axis] / length));
        }
        view.forward = look_at(view.eye, middle);
        view.fov_degrees = Q16::from_raw(static_cast<std::int32_t>(fov * 65536));
        view.width_px = width;
        view.height_px = height;
        is_set = frame.camera.set(view, scene.level) == Status::kOk;
      } else {
        OrthographicView view;
        for (int axis = 0; axis < 3; ++axis) {
          view.eye[axis] =
              Q8::from_raw(middle[axis].raw + static_cast<std::int32_t>(256.0 * side * away[axis] / length));
        }
        view.forward = look_at(view.eye, middle);
        view.span = Q14::from_raw(static_cast<std::int32_t>(width / px * Q14::kOne));
        view.width_px = width;
        view.height_px = height;
        is_set = frame.camera.set(view, scene.level) == Status::kOk;
      }
      if (!is_set) {
        continue;
      }
      frame.shading.mode = v % 3 == 0 ? ShadeMode::kNormal : ShadeMode::kDepth;
      set_depth_range(scene, &frame);
      frame.band.rows = height;
      std::uint64_t expected_hits = 0;
      const auto expected = draw_core(scene, frame, &expected_hits);
      for (int set = 0; set < wide::instruction_set_count(); ++set) {
        wide::use_instruction_set(set);
        CAPTURE(wide::instruction_set());
        const wide::Options options = options_of(v % 3 == 1 ? 2 : 1, wide::Order::kBlocks);
        std::uint64_t hits = 0;
        wide::Stats stats;
        const auto ours = draw_wide(scene, frame, options, &hits, &stats);
        REQUIRE(ours.has_value());
        CHECK(hits == expected_hits);
        CHECK(*ours == expected);
        boxes += stats.counts.boxes;
        candidates += stats.counts.candidates;
      }
    }
  }
  CHECK(candidates < 2 * boxes);
}

TEST_CASE("wide: whole frames of the generators' scenes -> every pixel is the core's") {
  // Many: enough to see what goes wrong in one pixel of a hundred thousand.
  const int kFrames = many_or_few(5, 2);
  const auto names = many_or_few<std::vector<std::string>>({"spheres,depth=9", "points:3000000", "water"},
                                                           {"spheres,depth=7"});
  for (const std::string& name : names) {
    tools::SceneArguments arguments;
    arguments.scene = name;
    tools::BuiltScene built(*tools::open_scene(arguments), {});
    const auto renderer = tools::WideRenderer::make(&built, 800, 600, 1);
    REQUIRE(renderer != nullptr);
    const double side = 1 << built.level();
    for (int i = name == names.front() ? 0 : kFrames - 2; i < kFrames; ++i) {
      CAPTURE(name);
      CAPTURE(i);
      const double drift = 0.003 * side * (i + 1);
      tools::ViewWishes view;
      view.orthographic = i == 4;
      view.target = tools::Real3{side / 2 + drift / 3, side / 2, side / 2 + drift / 5};
      view.eye = i == 3 ? tools::Real3{side / 2, side * 0.3, side / 2}
                        : tools::Real3{side * 0.2 + drift, -side * 0.62, side * 0.75 - drift / 2};
      const Camera camera = tools::frame_box(view, built.level(), built.bounds()).camera;
      Shading shading;
      shading.near_q8 = depth_range(camera, built.bounds()).near_q8;
      shading.far_q8 = depth_range(camera, built.bounds()).far_q8;
      std::vector<std::uint8_t> ours(800 * 600);
      std::vector<std::uint8_t> expected(800 * 600);
      Band band;
      band.format = PixelFormat::kGray8;
      band.rows = 600;
      band.pixels = Bytes(ours.data(), ours.size());
      wide::Counts work;
      RenderCounts counts;
      REQUIRE(renderer->render(camera, shading, band, &counts, &work) == Status::kOk);
      // Floats decide nearly all. A surface has fewer candidates; as many of them are ties.
      CHECK(work.exact < work.candidates / (renderer->lists().is_surface() ? 30 : 50));
      band.pixels = Bytes(expected.data(), expected.size());
      RenderCounts expected_counts;
      REQUIRE(built.render_band(camera, shading, band, &expected_counts, {}) == Status::kOk);
      CHECK(counts.hits == expected_counts.hits);
      CHECK(count_different(ours, expected) == 0);
    }
  }
}

TEST_CASE("wide: the order is chosen by what boxes hide -> few more tests than pixels, whatever the scene") {
  const auto names = many_or_few<std::vector<std::string>>(
      {"points:100000", "points:2000000", "spheres", "spheres,depth=8", "water,depth=9"},
      {"points:100000", "spheres", "water,depth=7"});
  for (const std::string& name : names) {
    tools::SceneArguments arguments;
    arguments.scene = name;
    const auto source = tools::open_scene(arguments);
    const tools::BuiltScene built(*source, {});
    HeapBytes list_bytes(wide::VoxelLists::bytes(built.compact()));
    Arena arena(list_bytes.span());
    wide::VoxelLists lists;
    REQUIRE(wide::VoxelLists::make(built.compact(), &arena, &lists) == Status::kOk);
    std::vector<std::uint8_t> workspace(wide::workspace_bytes(400, 300));
    std::vector<std::uint8_t> pixels(std::size_t{400} * 300);
    for (const bool orthographic : {false, true}) {
      CAPTURE(name);
      CAPTURE(orthographic);
      tools::ViewWishes view;
      view.orthographic = orthographic;
      view.width_px = 400;
      view.height_px = 300;
      const Camera camera = tools::frame_box(view, built.level(), built.bounds()).camera;
      Band band;
      band.format = PixelFormat::kGray8;
      band.rows = 300;
      band.pixels = Bytes(pixels.data(), pixels.size());
      const auto draw = [&](wide::Order order) {
        wide::Options options;
        options.order = order;
        wide::Stats stats;
        REQUIRE(wide::render(lists, camera, {}, band, Bytes(workspace.data(), workspace.size()), nullptr,
                             options, &stats) == Status::kOk);
        return stats;
      };
      const wide::Stats chosen = draw(wide::Order::kAuto);
      const wide::Stats flat = draw(wide::Order::kFlat);
      const wide::Stats blocks = draw(wide::Order::kBlocks);
      // A box costs about as much as two tests, a block as much as twenty boxes.
      const auto cost = [](const wide::Stats& stats) {
        return 2 * stats.counts.candidates + stats.counts.boxes + 20 * stats.counts.nodes;
      };
      CAPTURE(cost(flat));
      CAPTURE(cost(blocks));
      CHECK(cost(chosen) * 10 <= std::min(cost(flat), cost(blocks)) * 16);
      CHECK(chosen.counts.candidates < 4 * pixels.size());
    }
  }
}

}  // namespace thimble::tests
