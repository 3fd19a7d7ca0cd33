// What the viewer shows: the pace of frames, pictures stretched, and the finished picture in all its passes.
#include <doctest/doctest.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "scene/host_memory.h"
#include "scene/magnify.h"
#include "scene/moving_pool.h"
#include "support/check_command.h"
#include "thimble/light/scene.h"
#include "thimble/picture/render.h"
#include "viewer/fast_frames.h"
#include "viewer/finished_picture.h"

namespace {

using namespace thimble;
using namespace thimble::tools;
using namespace thimble::tools::viewer;

std::shared_ptr<const OpenScene> scene_of(const std::string& name) {
  SceneArguments arguments;
  arguments.scene = name;
  SceneReading reading(arguments, 2);
  return reading.take();
}

ViewWishes view_of(std::int32_t width, std::int32_t height) {
  ViewWishes view;
  view.width_px = width;
  view.height_px = height;
  return view;
}

constexpr auto kGoesOn = [](std::int32_t) { return true; };

std::vector<std::uint8_t> drawn(const FinishedPicture& picture, int step = 0) {
  wide::Threads threads(2);
  std::vector<std::uint8_t> rgb;
  REQUIRE(picture.draw(step, &threads, &rgb, kGoesOn));
  return rgb;
}

}  // namespace

TEST_CASE("pace: slow frames -> coarser, fast ones -> finer again, between limits") {
  Pace pace(0.02, true);
  CHECK(pace.engine() == FastEngine::kWide);
  pace.take(0.5);  // the first does not count
  CHECK(pace.step() == 1);
  pace.take(0.03);
  CHECK(pace.step() == 2);
  for (int i = 0; i < 50; ++i) {
    pace.take(0.015);  // would be 0.06 at full size
  }
  CHECK(pace.step() == 2);
  for (int i = 0; i < 50; ++i) {
    pace.take(0.002);
  }
  CHECK(pace.step() == 1);
}

TEST_CASE("pace: what is slow at any size -> rays where they are faster, else the wide renderer stays") {
  const auto settle = [](double ray_pixels_a_second) {
    Pace pace(0.02, true);
    for (int i = 0; i < 100; ++i) {
      const double pixels = 921600.0 / (pace.step() * pace.step());
      pace.take(pace.engine() == FastEngine::kWide ? 0.08 : pixels / ray_pixels_a_second);
      CHECK(pace.step() >= 1);
      CHECK(pace.step() <= Pace::kMostStep);
    }
    return pace.engine();
  };
  CHECK(settle(2e6) == FastEngine::kRays);
  CHECK(settle(2e5) == FastEngine::kWide);
  CHECK(Pace(0.02, false).engine() == FastEngine::kRays);
}

TEST_CASE(
    "lit pace: late frames -> none for a while, twice as long each time; in time -> finer, and soon again") {
  LitPace pace;
  const auto frames_without = [&pace](double seconds) {
    pace.take(seconds, 0.1);
    int frames = 0;
    while (pace.next() == 0) {
      ++frames;
    }
    return frames;
  };
  CHECK(pace.next() == 2);
  CHECK(frames_without(0.11) == LitPace::kLeastPause);
  CHECK(frames_without(0.3) == 2 * LitPace::kLeastPause);
  CHECK(frames_without(0.09) == 0);
  CHECK(frames_without(0.11) == 4 * LitPace::kLeastPause);  // one in time is not enough
  for (int i = 0; i < 20; ++i) {
    CHECK(frames_without(0.05) == 0);
    CHECK(pace.next() == 2);  // every pixel would take 0.2
  }
  CHECK(frames_without(0.11) == LitPace::kLeastPause);
  for (int i = 0; i < 20; ++i) {
    CHECK(frames_without(0.015) == 0);
  }
  CHECK(pace.next() == 1);
  CHECK(frames_without(0.11) == 0);
  CHECK(pace.next() == 2);
  for (int i = 0; i < 20; ++i) {
    CHECK(frames_without(1) <= LitPace::kMostPause);
  }
  CHECK(frames_without(1) == LitPace::kMostPause);
}

TEST_CASE(
    "fast frames: with time for the light -> the finished picture's, every second pixel; else as they were") {
  const auto scene = scene_of("castle");
  const auto look = std::make_shared<const FinishedLook>(scene, viewer::LookWishes{});
  FinishedPicture picture(look, view_of(160, 120));
  const std::vector<std::uint8_t> wanted = drawn(picture, 2);
  FastFrames frames(scene, picture.is_plain(), 2);
  // A clock of which each look takes a second.
  double time = 0;
  const auto clock = [&time] { return time++; };
  std::vector<std::uint8_t> rgb{1, 2, 3};
  CHECK_FALSE(frames.draw_lit(picture, &rgb, 0.5, clock));
  CHECK(rgb == std::vector<std::uint8_t>{1, 2, 3});
  for (int frame = 0; frame < LitPace::kLeastPause; ++frame) {
    CHECK_FALSE(frames.draw_lit(picture, &rgb, 1e9, clock));
  }
  CHECK(frames.draw_lit(picture, &rgb, 1e9, clock));
  CHECK(frames.engine() == std::string("lit"));
  REQUIRE(rgb.size() == 3 * 160 * 120);
  for (std::size_t y = 0; y < 60; ++y) {
    for (std::size_t x = 0; x < 80; ++x) {
      CHECK(std::equal(wanted.begin() + static_cast<std::ptrdiff_t>(3 * (80 * y + x)),
                       wanted.begin() + static_cast<std::ptrdiff_t>(3 * (80 * y + x) + 3),
                       rgb.begin() + static_cast<std::ptrdiff_t>(3 * (160 * 2 * y + 2 * x))));
    }
  }
  // A picture may be as bright as the last one that was measured, whatever that showed.
  const auto bright = std::make_shared<const FinishedLook>(scene_of("glass"), viewer::LookWishes{});
  std::vector<std::uint8_t> shown[3];
  (void)drawn(FinishedPicture(bright, view_of(40, 30)), 2);
  look->keep_exposure(*bright);
  for (int i = 0; i < 3; ++i) {
    FinishedPicture again(look, view_of(160, 120));
    if (i != 1) {
      again.keep_exposure();
    }
    shown[i] = drawn(again, 2);
  }
  CHECK(shown[0] != shown[1]);
  CHECK(shown[1] == shown[2]);
  // Stars and flat shades have no light.
  viewer::LookWishes flat;
  flat.shade = ShadeMode::kNormal;
  flat.shade_word = "normal";
  const auto no_light = std::make_shared<const FinishedLook>(scene, flat);
  CHECK_FALSE(frames.draw_lit(FinishedPicture(no_light, view_of(160, 120)), &rgb, 1e9, clock));
}

TEST_CASE("magnify: every pixel that was drawn stays, those between lie between, one colour stays one") {
  std::mt19937 random(1);
  for (int step = 1; step <= kMostStep; ++step) {
    const std::int32_t width = 37;
    const std::int32_t height = 23;
    const std::int32_t columns = thinned_px(width, step);
    const std::int32_t rows = thinned_px(height, step);
    std::vector<std::uint8_t> small(static_cast<std::size_t>(3 * columns * rows));
    for (std::uint8_t& byte : small) {
      byte = static_cast<std::uint8_t>(random());
    }
    std::vector<std::uint8_t> full(static_cast<std::size_t>(3 * width * height));
    std::vector<std::uint16_t> work(magnify_work(width));
    magnify_rows(small.data(), step, width, height, 0, rows, work.data(), full.data());
    std::vector<std::uint8_t> parts(full.size());  // as threads draw it
    for (const auto& [first, end] : {std::pair{rows / 3, rows}, std::pair{0, rows / 3}}) {
      magnify_rows(small.data(), step, width, height, first, end, work.data(), parts.data());
    }
    CHECK(parts == full);
    for (std::int32_t y = 0; y < rows; ++y) {
      for (std::int32_t x = 0; x < 3 * columns; ++x) {
        CHECK(full[static_cast<std::size_t>(3 * width * y * step + 3 * (x / 3) * step + x % 3)] ==
              small[static_cast<std::size_t>(3 * columns * y + x)]);
      }
    }
    for (const int value : {0, 1, 128, 255}) {
      small.assign(small.size(), static_cast<std::uint8_t>(value));
      magnify_rows(small.data(), step, width, height, 0, rows, work.data(), full.data());
      CHECK(full == std::vector<std::uint8_t>(full.size(), static_cast<std::uint8_t>(value)));
    }
  }
}

TEST_CASE("refinement: coarse to fine -> ends at the rows of the finished picture; cancelled -> ends soon") {
  const auto scene = scene_of("spheres,depth=5");
  const auto look = std::make_shared<const FinishedLook>(scene, viewer::LookWishes{});
  const auto picture = std::make_shared<const FinishedPicture>(look, view_of(101, 67));
  const std::vector<std::uint8_t> wanted = drawn(*picture);
  CHECK(wanted.size() == 3 * 101 * 67);
  for (const int threads : {1, 2, 3}) {
    Refinement refinement(picture, threads);
    std::vector<std::uint8_t> shown;
    int last_step = 99;
    while (!refinement.is_finished()) {
      if (refinement.take(&shown)) {
        CHECK(refinement.step() <= last_step);
        last_step = refinement.step();
        CHECK(shown.size() == wanted.size());
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    CHECK(shown == wanted);
  }
  const auto large = std::make_shared<const FinishedPicture>(look, view_of(1600, 1200));
  Refinement cancelled(large, 2);
  cancelled.cancel();
#ifdef __SANITIZE_THREAD__
  constexpr std::chrono::seconds kSoon(60);  // all takes some fifteen times as long
#else
  constexpr std::chrono::seconds kSoon(5);
#endif
  const auto end = std::chrono::steady_clock::now() + kSoon;
  while (!cancelled.has_ended() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  CHECK(cancelled.has_ended());
  CHECK_FALSE(cancelled.is_finished());
}

TEST_CASE(
    "finished picture: after coarse passes -> their samples are taken, and the bytes are those without "
    "them") {
  for (const char* const name : {"castle", "spheres,depth=5"}) {
    for (const int across : {1, 2, 3}) {
      CAPTURE(name);
      CAPTURE(across);
      viewer::LookWishes wishes;
      wishes.across = across;
      const auto look = std::make_shared<const FinishedLook>(scene_of(name), wishes);
      const FinishedPicture picture(look, view_of(101, 67));
      REQUIRE(picture.across() == across);
      wide::Threads threads(2);
      const std::vector<std::uint8_t> wanted = drawn(picture);
      for (const std::vector<int>& steps : {std::vector<int>{8, 4, 2, 1}, std::vector<int>{3, 1},
                                            std::vector<int>{4}, std::vector<int>{1, 2}}) {
        KeptSamples kept;
        std::vector<std::uint8_t> rgb;
        for (const int step : steps) {
          REQUIRE(picture.draw(step, &threads, &rgb, kGoesOn, &kept));
          CHECK(kept.step == step);
          CHECK(rgb.size() == static_cast<std::size_t>(3 * thinned_px(101, step) * thinned_px(67, step)));
          // A pass that is interrupted leaves what is kept as it was.
          CHECK_FALSE(picture.draw(
              step, &threads, &rgb, [](std::int32_t) { return false; }, &kept));
        }
        std::vector<std::uint8_t> finished;
        KeptSamples other = kept;
        REQUIRE(picture.draw(0, &threads, &finished, kGoesOn, &kept));
        CHECK(finished == wanted);
        other.drawn[0] = {255, 0, 255, 255};
        REQUIRE(picture.draw(0, &threads, &finished, kGoesOn, &other));
        CHECK(finished != wanted);
        std::copy_n(wanted.begin(), 3, finished.begin());
        CHECK(finished == wanted);
      }
    }
  }
}

TEST_CASE(
    "finished picture: samples at edges -> row by row, the bytes of render with the words of the look") {
  struct Wish {
    std::string scene;
    std::string effects;
    std::optional<ShadeMode> shade;
    bool has_edges;
  };
  for (const Wish& wish :
       {Wish{"castle", "", {}, true}, Wish{"castle", "none", {}, true}, Wish{"glass", "", {}, true},
        Wish{"spheres,depth=5", "direct-light,shadows,ambient-occlusion", {}, true},
        Wish{"spheres,depth=5", "", ShadeMode::kNormal, true}, Wish{"points:2000,depth=6", "", {}, false}}) {
    CAPTURE(wish.scene);
    CAPTURE(wish.effects);
    viewer::LookWishes wishes;
    wishes.across = kEdgeGrid;
    wishes.at_edges = true;
    wishes.shade = wish.shade;
    wishes.shade_word = "normal";
    if (!wish.effects.empty()) {
      wishes.effects.choice = parse_effects(wish.effects).value();
    }
    const auto look = std::make_shared<const FinishedLook>(scene_of(wish.scene), wishes);
    std::vector<std::string> words{"render", wish.scene, "--size", "97x61", "--quiet", "-o"};
    const tests::TemporaryFolder folder;
    words.push_back(folder.path("a.ppm"));
    words.insert(words.end(), look->words().begin(), look->words().end());
    CHECK(std::find(words.begin(), words.end(), "auto") != words.end());
    tests::check_done(words);
    const std::string text = tests::read_text(folder.path("a.ppm"));
    const std::vector<std::uint8_t> wanted(text.end() - 3 * 97 * 61, text.end());
    ViewWishes view = view_of(97, 61);
    view.side = NamedView::kBest;
    view.fov_degrees = kPictureFov;
    for (const int threads : {1, 2}) {
      const FinishedPicture picture(look, view);
      CHECK(picture.at_edges() == wish.has_edges);
      wide::Threads some(threads);
      std::vector<std::uint8_t> rgb;
      std::int32_t rows = 0;
      bool is_same = true;
      CHECK(picture.draw(0, &some, &rgb, [&](std::int32_t now) {
        const auto shown = rgb.begin() + std::ptrdiff_t{3} * 97 * now;
        is_same = is_same && now >= rows && std::equal(rgb.begin(), shown, wanted.begin());
        rows = now;
        return true;
      }));
      CHECK(is_same);
      CHECK(rows == 61);
      CHECK(rgb == wanted);
      CHECK_FALSE(picture.draw(0, &some, &rgb, [](std::int32_t) { return false; }));
    }
  }
}

TEST_CASE("fast frames: after a finished picture -> as bright as it, in the mean") {
  const auto scene = scene_of("castle");
  const auto look = std::make_shared<const FinishedLook>(scene, viewer::LookWishes{});
  const std::vector<std::uint8_t> finished = drawn(FinishedPicture(look, view_of(160, 120)));
  const FinishedPicture picture(look, view_of(160, 120));
  FastFrames frames(scene, picture.is_plain(), 2);
  std::vector<std::uint8_t> quick;
  frames.draw(picture, &quick);
  REQUIRE(quick.size() == finished.size());
  // Of the middle, where the castle is.
  const auto mean = [](const std::vector<std::uint8_t>& rgb) {
    double sum = 0;
    for (int y = 45; y < 85; ++y) {
      const auto row = rgb.begin() + 3 * (160 * y + 60);
      sum += std::accumulate(row, row + 3 * 40, 0.0);
    }
    return sum / (40 * 3 * 40);
  };
  CAPTURE(mean(quick));
  CAPTURE(mean(finished));
  CHECK(mean(quick) > 0.93 * mean(finished));  // shadows and corners are darker there, so it may be brighter
  CHECK(mean(quick) < 1.15 * mean(finished));
}

TEST_CASE("fast frames: same view -> wide and rays show the same things; water is drawn, too") {
  for (const char* name : {"castle", "spheres,depth=5", "points:2000,depth=6", "water,depth=5"}) {
    CAPTURE(name);
    const auto scene = scene_of(name);
    const auto look = std::make_shared<const FinishedLook>(scene, viewer::LookWishes{});
    const FinishedPicture picture(look, view_of(160, 120));
    FastFrames frames(scene, picture.is_plain(), 2);
    std::vector<std::uint8_t> rgb;
    for (int i = 0; i < 3; ++i) {
      frames.draw(picture, &rgb);
      CHECK(rgb.size() == 3 * 160 * 120);
    }
    CHECK((frames.engine() == std::string("wide")) == picture.is_plain());
    if (frames.step() != 1) {
      continue;  // a machine that is busy
    }
    std::vector<std::uint8_t> rays(3 * 160);
    int differ = 0;
    for (std::int32_t y = 0; y < 120; ++y) {
      picture.draw_quick_row(1, y, rays.data());
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const int error = rgb[static_cast<std::size_t>(3 * 160 * y) + i] - rays[i];
        differ += std::abs(error) > 48 ? 1 : 0;
      }
    }
    CHECK(differ < 3 * 160 * 120 / 20);
  }
}

TEST_CASE(
    "moving pool: rain -> rings that run on from frame to frame, the same in every run; shown in their "
    "place") {
  const auto scene = scene_of("water,depth=5");
  const auto look = std::make_shared<const FinishedLook>(scene, viewer::LookWishes{});
  FinishedPicture picture(look, view_of(96, 72));
  REQUIRE(picture.water() != nullptr);
  const auto drawn = [&] {
    std::vector<std::uint8_t> rgb(std::size_t{3} * 96 * 72);
    for (std::int32_t y = 0; y < 72; ++y) {
      picture.draw_quick_row(1, y, rgb.data() + std::size_t{3} * 96 * static_cast<std::size_t>(y));
    }
    return rgb;
  };
  const std::vector<std::uint8_t> at_rest = drawn();
  const HostMemory memory(MovingPool::bytes(*picture.water()));
  const HostMemory other(MovingPool::bytes(*picture.water()));
  MovingPool pool(scene->tree(), *picture.water(), memory.bytes());
  MovingPool again(scene->tree(), *picture.water(), other.bytes());
  std::vector<std::uint8_t> before = at_rest;
  for (std::uint32_t frame = 0; frame <= MovingPool::kDropFrames; ++frame) {
    CAPTURE(frame);
    pool.step();
    again.step();
    picture.show_water(again.surface());
    const std::vector<std::uint8_t> twin = drawn();
    picture.show_water(pool.surface());
    const std::vector<std::uint8_t> now = drawn();
    CHECK(now == twin);
    CHECK((frame == 0 || now != before));  // the first drop has hardly fallen
    before = now;
  }
  CHECK(before != at_rest);
}

TEST_CASE("picking: a voxel seen from the front -> its name, its face and its colour; beside it nothing") {
  const auto scene = scene_of("spheres,depth=5");
  const auto look = std::make_shared<const FinishedLook>(scene, viewer::LookWishes{});
  ViewWishes view = view_of(64, 64);
  view.forward = {0, 1, 0};
  view.placed = true;
  const FinishedPicture picture(look, view);
  int hits = 0;
  for (std::int32_t y = 0; y < 64; y += 7) {
    for (std::int32_t x = 0; x < 64; x += 7) {
      const auto picked = pick(*scene, picture.camera(), x, y);
      if (!picked) {
        continue;
      }
      ++hits;
      const std::string text = picked_text(*scene, picture.camera(), *picked, x, y);
      CHECK(text.find("voxel ") == 0);
      CHECK(text.find(", material ") != std::string::npos);
      for (int axis = 0; axis < 3; ++axis) {
        const double inside = picked->point[static_cast<std::size_t>(axis)] - picked->hit.voxel[axis];
        CHECK(inside >= -1e-6);
        CHECK(inside <= 1 + 1e-6);
      }
      if (picked->hit.axis == 1) {
        CHECK(text.find("front face (-y)") != std::string::npos);
      }
    }
  }
  CHECK(hits > 5);
  CHECK_FALSE(pick(*scene, picture.camera(), -1, 0));
  CHECK_FALSE(pick(*scene, picture.camera(), 0, 64));
}
