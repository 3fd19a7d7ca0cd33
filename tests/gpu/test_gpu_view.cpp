// view --engine gpu: the viewer's pictures by a device that keeps the scene are those without one.
#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "gpu/renderer.h"
#include "readers/source.h"
#include "support/check_command.h"
#include "viewer/fast_frames.h"
#include "viewer/finished_picture.h"

namespace thimble::tests {
namespace {

using namespace tools;
using namespace tools::viewer;

std::shared_ptr<const FinishedLook> look_by(const std::string& engine, const std::string& name,
                                            bool at_edges) {
  SceneArguments arguments;
  arguments.scene = name;
  SceneReading reading(arguments, 2);
  viewer::LookWishes wishes;
  wishes.engine = engine;
  wishes.at_edges = at_edges;
  wishes.across = at_edges ? kEdgeGrid : 0;
  return std::make_shared<const FinishedLook>(reading.take(), wishes);
}

std::vector<std::uint8_t> drawn(const std::shared_ptr<const FinishedLook>& look, int step) {
  ViewWishes view;
  view.width_px = 61;
  view.height_px = 43;
  const FinishedPicture picture(look, view);
  wide::Threads threads(2);
  std::vector<std::uint8_t> rgb;
  REQUIRE(picture.draw(step, &threads, &rgb, [](std::int32_t) { return true; }));
  return rgb;
}

}  // namespace

TEST_CASE("gpu view: each pass, also where samples are at edges -> the bytes without a GPU") {
  if (gpu::devices().empty()) {
    MESSAGE("skipped: there is no Vulkan device");
    return;
  }
  for (const bool at_edges : {false, true}) {
    const auto by_gpu = look_by("gpu", "spheres,depth=5", at_edges);
    const auto without = look_by("wide", "spheres,depth=5", at_edges);
    CHECK(by_gpu->gpu().empty());
    for (const int step : {4, 1, 0}) {
      CAPTURE(step);
      CHECK(drawn(by_gpu, step) == drawn(without, step));
    }
    CHECK(by_gpu->gpu() == gpu::devices().front().name);
    CHECK(without->gpu().empty());
  }
}

TEST_CASE("gpu view: auto -> a GPU of its own, never a software driver") {
  const auto look = look_by("auto", "spheres,depth=5", false);
  drawn(look, 1);
  const bool has_gpu = !gpu::devices().empty() && !gpu::devices().front().is_software;
  CHECK(look->gpu().empty() == !has_gpu);
}

TEST_CASE("gpu view: what it does not draw -> a sentence") {
  ViewWishes view;
  view.width_px = 61;
  view.height_px = 43;
  for (const char* name : {"lagoon", "points:300,depth=6"}) {
    const auto look = look_by("gpu", name, false);
    CHECK_THROWS_AS(FinishedPicture(look, view), InputError);
  }
  check_refused({"view", "castle", "--engine", "gpu", "--shade", "depth", "--bench", "1"}, 2, {});
}

}  // namespace thimble::tests
