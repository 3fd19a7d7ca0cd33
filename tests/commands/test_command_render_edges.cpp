// `thimble render --samples auto`: the rule of thimble/picture/render.h, whoever draws, in bands of any
// height, on any number of threads, within any budget.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "support/check_command.h"
#include "support/counts.h"
#include "support/json.h"
#include "thimble/picture/render.h"

namespace {

using namespace thimble::tests;

struct Shot {
  std::vector<std::uint8_t> rgb;
  Json stats;
};

Shot render(const Words& words, const std::string& size) {
  const TemporaryFolder folder;
  check_done(Words{"render"} + words +
             Words{"--size", size, "--quiet", "-o", folder.path("a.ppm"), "--stats", folder.path("a.json")});
  const std::string text = read_text(folder.path("a.ppm"));
  const std::string pixels = text.substr(text.find("255\n") + 4);
  return {{pixels.begin(), pixels.end()}, read_json(folder.path("a.json"))};
}

constexpr int kWidth = 90;
constexpr int kHeight = 60;
const char* const kSize = "90x60";
const char* const kFineSize = "360x240";

// The rule once more, from the picture of one sample and the one four times as large.
std::vector<std::uint8_t> with_samples_at_edges(const Shot& one, const Shot& fine, int* more) {
  using thimble::Bytes;
  using thimble::ConstBytes;
  constexpr std::size_t kLine = 3 * kWidth;
  std::vector<std::uint8_t> picture = one.rgb;
  std::vector<std::uint8_t> samples(kWidth);
  for (int y = 0; y < kHeight; ++y) {
    const auto row = [&](int at) {
      return at < 0 || at >= kHeight
                 ? ConstBytes()
                 : ConstBytes(one.rgb.data() + kLine * static_cast<std::size_t>(at), kLine);
    };
    const Bytes bytes(samples.data(), samples.size());
    REQUIRE(thimble::edge_strengths(row(y - 1), row(y), row(y + 1), 3, kWidth, bytes) ==
            thimble::Status::kOk);
    REQUIRE(thimble::place_edge_samples(bytes, kWidth, bytes) == thimble::Status::kOk);
    for (int x = 0; x < kWidth; ++x) {
      const int count = samples[static_cast<std::size_t>(x)];
      *more += count;
      for (std::size_t channel = 0; channel < 3; ++channel) {
        std::uint8_t& value =
            picture[kLine * static_cast<std::size_t>(y) + 3 * static_cast<std::size_t>(x) + channel];
        int sum = value;
        for (int i = 0; i < count; ++i) {
          const auto place = thimble::edge_sample_place(i);
          sum += fine.rgb[4 * kLine * static_cast<std::size_t>(4 * y + place.y) +
                          3 * static_cast<std::size_t>(4 * x + place.x) + channel];
        }
        value = static_cast<std::uint8_t>(std::lround(static_cast<double>(sum) / (count + 1)));
      }
    }
  }
  return picture;
}

double rms(const Shot& one, const Shot& other) {
  double sum = 0;
  for (std::size_t i = 0; i < one.rgb.size(); ++i) {
    const double difference = int{one.rgb[i]} - int{other.rgb[i]};
    sum += difference * difference;
  }
  return std::sqrt(sum / static_cast<double>(one.rgb.size()));
}

TEST_CASE("render --samples auto: plain and lit -> one sample, and the fine picture's where edges are") {
  const std::vector<Words> cases{
      {"castle", "--shade", "color"},
      {"castle", "--shade", "depth", "--projection", "orthographic", "--engine", "ray64"},
      {"spheres", "--shade", "normal", "--engine", "ray32"},
      {"points:3000,depth=7", "--shade", "mono"},
      {"castle", "--shade", "color", "--structure", "pool"},
      {"castle", "--effects", "direct-light,shadows,ambient-occlusion"},
      {"water", "--effects", "auto"},
      {"glass", "--effects", "auto", "--projection", "orthographic"},
  };
  for (const Words& words : cases) {
    CAPTURE(words);
    const Shot one = render(words, kSize);
    const Shot fine = render(words, kFineSize);
    const Shot drawn = render(words + Words{"--samples", "auto"}, kSize);
    int more = 0;
    CHECK(drawn.rgb == with_samples_at_edges(one, fine, &more));
    CHECK(drawn.rgb != one.rgb);
    CHECK(more > 0);
    CHECK(drawn.stats["samples"] == "auto");
    if (!drawn.stats.contains("rays_by_kind")) {
      CHECK(drawn.stats["rays"] == kWidth * kHeight + more);
    } else {
      CHECK(drawn.stats["rays_by_kind"]["primary"] == kWidth * kHeight + more);
    }
  }
}

TEST_CASE("render --samples auto: threads, budgets and structures -> the same picture") {
  const std::vector<std::pair<Words, std::vector<Words>>> cases{
      {{"castle"}, {{"--threads", "1"}, {"--threads", "3"}, {"--memory", "300K"}, {"--memory", "2M"}}},
      {{"castle", "--background", "123456", "--ground", "off"}, {{"--threads", "2"}, {"--memory", "400K"}}},
      {{"room", "--effects", "auto"}, {{"--threads", "1"}, {"--threads", "5"}, {"--memory", "200K"}}},
      {{"castle", "--effects", "direct-light,shadows,ambient-occlusion,sky"},
       {{"--engine", "ray64"}, {"--engine", "ray64", "--threads", "1"}, {"--threads", "3"}}},
      {{"castle", "--shade", "normal"},
       {{"--engine", "ray64"}, {"--memory", "220K"}, {"--structure", "pool"}}},
      {{"castle", "--shade", "color", "--cutoff", "3"}, {{"--memory", "400K"}, {"--threads", "2"}}},
  };
  for (const auto& [each_words, ways] : cases) {
    const auto& words = each_words;
    CAPTURE(words);
    const Shot first = render(words + Words{"--samples", "auto"}, kSize);
    for (const Words& way : ways) {
      CAPTURE(way);
      const Shot other = render(words + Words{"--samples", "auto"} + way, kSize);
      CHECK(other.rgb == first.rgb);
      if (way[0] == "--memory") {
        CHECK(other.stats["high_water_bytes"] <= other.stats["budget_bytes"]);
      }
    }
  }
}

TEST_CASE(
    "render --samples auto: more pixels than are drawn together -> as in small bands; behind them, as of one "
    "sample") {
  for (const Words& scene : thimble::tests::takes_few()
                                ? std::vector<Words>{{"castle", "--effects", "direct-light"}}
                                : std::vector<Words>{{"castle"}, {"room"}}) {
    CAPTURE(scene);
    constexpr const char* kLarge = "260x200";
    const Shot whole = render(scene + Words{"--samples", "auto"}, kLarge);
    CHECK(render(scene + Words{"--samples", "auto", "--memory", "600K"}, kLarge).rgb == whole.rgb);
    // What is far from edges: the first and last column's upper half.
    const Shot single = render(scene + Words{"--samples", "1"}, kLarge);
    REQUIRE(single.rgb.size() == whole.rgb.size());
    const std::size_t line = whole.rgb.size() / 200;
    int differ = 0;
    for (std::size_t y = 0; y < 100; ++y) {
      for (std::size_t c = 0; c < 3; ++c) {
        differ += whole.rgb[y * line + c] != single.rgb[y * line + c] ? 1 : 0;
        differ += whole.rgb[(y + 1) * line - 3 + c] != single.rgb[(y + 1) * line - 3 + c] ? 1 : 0;
      }
    }
    CHECK(differ <= 30);
  }
}

TEST_CASE("render --samples auto: models -> nearer to 64 samples than one by half, with few rays") {
  const std::string size = thimble::tests::takes_few() ? "80x60" : "240x180";
  for (const Words& words : {Words{"castle", "--shade", "color"}, Words{"ship", "--shade", "color"},
                             Words{"castle", "--effects", "direct-light,shadows"}, Words{"castle"}}) {
    CAPTURE(words);
    const Shot best = render(words + Words{"--samples", "64"}, size);
    const Shot one = render(words + Words{"--samples", "1"}, size);
    const Shot edges = render(words + Words{"--samples", "auto"}, size);
    CHECK(rms(edges, best) < 0.6 * rms(one, best));
    CHECK(edges.stats["rays"].get<double>() < 3 * one.stats["rays"].get<double>());
  }
}

}  // namespace
