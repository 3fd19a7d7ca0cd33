// The comparison with textbook traversals: ours is never wrong, and theirs are what textbooks say, not straw
// men.
#include <doctest/doctest.h>

#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "instruments/hard_cases.h"
#include "reference/textbook.h"
#include "support/counts.h"

namespace thimble::tools {
namespace {

const std::uint64_t kRays = thimble::tests::many_or_few<std::uint64_t>(28000, 4200);

std::size_t column(const std::string& key) {
  for (std::size_t i = 0; i < kTracers; ++i) {
    if (key == kTracerNames[i].key) {
      return i;
    }
  }
  FAIL("no tracer ", key);
  return 0;
}

const std::vector<HardCaseRow>& rows() {
  static const std::vector<HardCaseRow> kRows = run_hard_cases(kRays, 7, {});
  return kRows;
}

TEST_CASE("hard cases: this tracer -> no ray wrong, neither in 64 bits nor in 32") {
  std::uint64_t rays = 0;
  for (const HardCaseRow& row : rows()) {
    INFO(row.name);
    rays += row.rays;
    CHECK(row.hits > row.rays / 4);
    for (const char* key : {"thimble_64", "thimble_32"}) {
      CHECK(row.wrong[column(key)] == 0);
      CHECK(row.wrong_face[column(key)] == 0);
    }
  }
  CHECK(rays >= kRays);
}

TEST_CASE(
    "hard cases: textbook traversals, any ray -> right but for one in five hundred, with an epsilon where "
    "they step by points") {
  const HardCaseRow& any = rows().front();
  REQUIRE(any.name == "any ray");
  for (const char* key : {"walk_float", "walk_float_epsilon", "walk_double", "walk_double_epsilon",
                          "points_float_epsilon", "points_double_epsilon", "octree_float",
                          "octree_float_epsilon", "octree_double", "octree_double_epsilon"}) {
    INFO(key);
    CHECK(any.wrong[column(key)] <= 1 + any.rays / 500);
  }
}

TEST_CASE(
    "hard cases: textbook traversals, degenerate rays -> each is wrong somewhere, with and without an "
    "epsilon") {
  for (std::size_t tracer = 2; tracer < kTracers; ++tracer) {
    std::uint64_t wrong = 0;
    for (const HardCaseRow& row : rows()) {
      wrong += row.wrong[tracer];
    }
    INFO(std::string(kTracerNames[tracer].key));
    CHECK(wrong > 0);
  }
}

TEST_CASE("hard cases: the same seed -> the same counts; another -> others; progress ends below one") {
  double last = -1;
  const auto again = run_hard_cases(280, 3, [&](double done) {
    CHECK(done >= last);
    last = done;
  });
  CHECK(last < 1);
  const auto same = run_hard_cases(280, 3, {});
  const auto other = run_hard_cases(280, 4, {});
  bool differs = false;
  for (std::size_t i = 0; i < again.size(); ++i) {
    CHECK(again[i].hits == same[i].hits);
    CHECK(again[i].wrong == same[i].wrong);
    differs = differs || again[i].hits != other[i].hits;
  }
  CHECK(differs);
}

TEST_CASE("textbook traversals: a ray along x through the middle of cells -> the voxel, its face and its t") {
  reference::BitGrid grid({8, 8, 8});
  grid.set({5, 2, 3});
  const reference::Pyramid pyramid(grid);
  const reference::Ray ray{{-256, 2 * 256 + 128, 3 * 256 + 128}, {3, 0, 0}};
  for (const reference::TextbookHit& hit :
       {reference::grid_walk<double>(grid, ray, 0), reference::point_steps<double>(grid, ray, 1e-6),
        reference::octree_descent<double>(pyramid, ray, 1e-6)}) {
    REQUIRE(hit.hit);
    CHECK(hit.voxel == reference::Voxel{5, 2, 3});
    CHECK(hit.axis == 0);
    CHECK(hit.t == doctest::Approx(6));
  }
  const reference::BitGrid flat({8, 4, 8});
  CHECK_THROWS_AS(reference::Pyramid{flat}, std::invalid_argument);
}

}  // namespace
}  // namespace thimble::tools

// Every fixed-point operation against exact arithmetic: within the bound that its header names, and the bound
// means something.
namespace thimble::tools {
namespace {

const std::uint64_t kCases = thimble::tests::many_or_few<std::uint64_t>(100000, 3000);
constexpr std::uint64_t kSeed = 41;

TEST_CASE("operation errors: sweep -> none above its bound, and no bound above four times what is seen") {
  INFO("seed ", kSeed);
  double last = 0;
  std::set<std::string> names;
  for (const OperationError& found : sweep_operations(kCases, kSeed, [&](double done) {
         CHECK(done >= last);
         last = done;
       })) {
    INFO(found.operation, ": ", found.error, " of ", found.bound, " ", found.unit);
    CHECK(found.cases >= 256);
    CHECK(found.error <= found.bound);
    CHECK(found.bound <= 4 * found.error);
    CHECK(names.insert(found.operation).second);
  }
  CHECK(last == 1);
  CHECK(names.size() >= 24);
}

}  // namespace
}  // namespace thimble::tools
