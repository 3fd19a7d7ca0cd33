// Samples where edges are: which pixels are edges, how many samples they get, and where these lie.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <set>
#include <vector>

#include "support/scene_under_test.h"
#include "thimble/picture/render.h"

namespace thimble::tests {
namespace {

using Row = std::vector<std::uint8_t>;

ConstBytes view(const Row& row) {
  return {row.data(), row.size()};
}

Row strengths_of(const Row& above, const Row& row, const Row& below, int channels) {
  const HeapBytes out(row.size() / static_cast<std::size_t>(channels));
  const auto width = static_cast<std::int32_t>(out.view().size);
  REQUIRE(edge_strengths(view(above), view(row), view(below), channels, width, out.span()) == Status::kOk);
  return {out.view().begin(), out.view().end()};
}

Row samples_of(const Row& strengths) {
  const HeapBytes out(strengths.size());
  const auto width = static_cast<std::int32_t>(strengths.size());
  REQUIRE(place_edge_samples(view(strengths), width, out.span()) == Status::kOk);
  Row in_place = strengths;
  REQUIRE(place_edge_samples(view(in_place), width, {in_place.data(), in_place.size()}) == Status::kOk);
  CHECK(in_place == Row(out.view().begin(), out.view().end()));
  return in_place;
}

// The rule by sorting: pairs of samples, one round after the other, to the strongest first.
Row samples_by_sorting(const Row& strengths) {
  Row samples(strengths.size());
  for (std::size_t first = 0; first < strengths.size(); first += 64) {
    const std::size_t end = std::min(first + 64, strengths.size());
    std::vector<std::size_t> edges;
    for (std::size_t x = first; x < end; ++x) {
      if (strengths[x] >= 16) {
        edges.push_back(x);
      }
    }
    std::stable_sort(edges.begin(), edges.end(),
                     [&](std::size_t a, std::size_t b) { return strengths[a] > strengths[b]; });
    std::size_t left = 72 * (end - first) / 64;
    for (int round = 0; round < 2; ++round) {
      for (const std::size_t x : edges) {
        if (left >= 2) {
          samples[x] = static_cast<std::uint8_t>(samples[x] + 2);
          left -= 2;
        }
      }
    }
  }
  return samples;
}

PerspectiveView perspective(std::int32_t width_px, std::int32_t height_px) {
  PerspectiveView view;
  view.eye = {Q8::saturate(-10), Q8::saturate(-12), Q8::saturate(14)};
  view.forward = {17, 19, -9};
  view.fov_degrees = Q16::saturate(25);
  view.width_px = width_px;
  view.height_px = height_px;
  return view;
}

TEST_CASE("edge samples: strengths -> the largest difference of a channel to the four neighbours") {
  // One channel, alone, then with rows above and below; the rim has no neighbours beyond.
  CHECK(strengths_of({}, {10, 10, 30, 25}, {}, 1) == Row{0, 20, 20, 5});
  CHECK(strengths_of({10, 11, 12, 255}, {10, 10, 30, 25}, {0, 10, 30, 20}, 1) == Row{10, 20, 20, 230});
  CHECK(strengths_of({}, {255}, {}, 1) == Row{0});
  CHECK(strengths_of({}, {255}, {0}, 1) == Row{255});
  // Of three, each counts; diagonal neighbours do not.
  CHECK(strengths_of({}, {1, 2, 3, 1, 2, 3, 1, 90, 3}, {}, 3) == Row{0, 88, 88});
  CHECK(strengths_of({9, 2, 3, 1, 2, 3}, {1, 2, 3, 1, 2, 3}, {1, 2, 3, 1, 2, 250}, 3) == Row{8, 247});
  // Of four, the fourth alone: cover before black.
  CHECK(strengths_of({}, {0, 0, 0, 255, 0, 0, 0, 0}, {}, 4) == Row{255, 255});
}

TEST_CASE("edge samples: random strengths -> what sorting gives, within the segment's share") {
  std::mt19937_64 random(3);
  for (int round = 0; round < 4000; ++round) {
    Row strengths(random() % 200);
    const auto kinds = 1 + random() % 256;
    const auto share = random() % 100;
    for (std::uint8_t& strength : strengths) {
      strength = static_cast<std::uint8_t>(random() % 100 < share ? random() % kinds : random() % 17);
    }
    const Row samples = samples_of(strengths);
    REQUIRE(samples == samples_by_sorting(strengths));
    int all = 0;
    for (const std::uint8_t count : samples) {
      all += count;
    }
    REQUIRE(8 * all <= 9 * static_cast<int>(strengths.size()));
  }
}

TEST_CASE("edge samples: places -> pairs across the centre, no two in a row or a column") {
  std::set<int> columns;
  std::set<int> rows;
  for (int i = 0; i < kMostEdgeSamples; ++i) {
    const EdgeSamplePlace place = edge_sample_place(i);
    columns.insert(place.x);
    rows.insert(place.y);
    const EdgeSamplePlace facing = edge_sample_place(i ^ 1);
    CHECK(place.x + facing.x == kEdgeGrid - 1);
    CHECK(place.y + facing.y == kEdgeGrid - 1);
  }
  CHECK(columns.size() == 4);
  CHECK(rows.size() == 4);
}

TEST_CASE("edge samples: windows and rows of samples -> the very rays of the camera that they are of") {
  OrthographicView parallel;
  parallel.eye = {Q8::saturate(5), Q8::saturate(7), Q8::saturate(40)};
  parallel.forward = {3, 1, -7};
  parallel.span = Q14::saturate(20);
  parallel.width_px = 4 * 23;
  parallel.height_px = 4 * 17;
  for (const bool is_perspective : {true, false}) {
    Camera fine;
    REQUIRE((is_perspective ? fine.set(perspective(4 * 23, 4 * 17), 6) : fine.set(parallel, 6)) ==
            Status::kOk);
    const auto same = [](const Ray& a, const Ray& b) {
      return a.direction == b.direction && a.origin.x.raw == b.origin.x.raw &&
             a.origin.y.raw == b.origin.y.raw && a.origin.z.raw == b.origin.z.raw;
    };
    const Camera window = fine.window(31, 5, 9, 7);
    CHECK(window.width_px() == 9);
    CHECK(window.height_px() == 7);
    CHECK(window.level() == fine.level());
    for (std::int32_t y = 0; y < 7; ++y) {
      for (std::int32_t x = 0; x < 9; ++x) {
        REQUIRE(same(window.ray(x, y), fine.ray(31 + x, 5 + y)));
      }
    }
    for (int index = 0; index < kMostEdgeSamples; ++index) {
      const EdgeSamplePlace place = edge_sample_place(index);
      const Camera row = edge_sample_row(fine, 11, 6, 12, index);
      REQUIRE(row.width_px() == 12);
      REQUIRE(row.height_px() == 1);
      for (std::int32_t x = 0; x < 12; ++x) {
        REQUIRE(same(row.ray(x, 0), fine.ray(4 * (11 + x) + place.x, 4 * 6 + place.y)));
      }
    }
  }
}

TEST_CASE("edge samples: limits -> an error and nothing written") {
  Row row(30);
  Row out(10, 7);
  const auto strengths = [&](std::size_t above, std::size_t size, std::size_t below, int channels,
                             std::int32_t width, std::size_t room) {
    return edge_strengths({row.data(), above}, {row.data(), size}, {row.data(), below}, channels, width,
                          {out.data(), room});
  };
  CHECK(strengths(30, 30, 30, 0, 10, 10) == Status::kBadArgument);
  CHECK(strengths(30, 30, 30, 5, 6, 10) == Status::kBadArgument);
  CHECK(strengths(30, 30, 30, 3, -1, 10) == Status::kOutOfRange);
  CHECK(strengths(30, 30, 30, 3, kMaxPicturePx + 1, 10) == Status::kOutOfRange);
  CHECK(strengths(29, 30, 30, 3, 10, 10) == Status::kOutOfMemory);
  CHECK(strengths(30, 29, 30, 3, 10, 10) == Status::kOutOfMemory);
  CHECK(strengths(30, 30, 29, 3, 10, 10) == Status::kOutOfMemory);
  CHECK(strengths(30, 30, 30, 3, 10, 9) == Status::kOutOfMemory);
  CHECK(place_edge_samples({row.data(), 10}, -1, {out.data(), 10}) == Status::kOutOfRange);
  CHECK(place_edge_samples({row.data(), 10}, kMaxPicturePx + 1, {out.data(), 10}) == Status::kOutOfRange);
  CHECK(place_edge_samples({row.data(), 9}, 10, {out.data(), 10}) == Status::kOutOfMemory);
  CHECK(place_edge_samples({row.data(), 10}, 10, {out.data(), 9}) == Status::kOutOfMemory);
  CHECK(out == Row(10, 7));
  CHECK(strengths(0, 30, 0, 3, 10, 10) == Status::kOk);
}

}  // namespace
}  // namespace thimble::tests
