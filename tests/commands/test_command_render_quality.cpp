// --samples, --cutoff and --max-depth of `thimble render`: what they draw, what they count, what they refuse.
// Plain pictures are drawn by single rays here: the wide renderer counts other visits and has memory of its
// own.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "support/check_command.h"
#include "support/json.h"

namespace {

using namespace thimble::tests;

struct QualityPicture {
  std::string bytes;
  Json stats;
};

QualityPicture render_ppm(const Words& more, const std::string& scene = "spheres") {
  const TemporaryFolder folder;
  check_done(Words{"render", scene, "--engine", "ray64", "--size", "64x48", "--quiet", "-o",
                   folder.path("a.ppm"), "--stats", folder.path("a.json")} +
             more);
  return {read_text(folder.path("a.ppm")), read_json(folder.path("a.json"))};
}

TEST_CASE("render quality: the least of each option -> the very picture and counts without it") {
  for (const char* projection : {"perspective", "orthographic"}) {
    const QualityPicture plain = render_ppm({"--projection", projection, "--shade", "color"});
    for (const Words& option : {Words{"--samples", "1"}, {"--cutoff", "0"}, {"--max-depth", "6"}}) {
      INFO(option[0]);
      const QualityPicture same =
          render_ppm({"--projection", projection, "--shade", "color", option[0], option[1]});
      CHECK(same.bytes == plain.bytes);
      CHECK(same.stats["node_visits"] == plain.stats["node_visits"]);
      CHECK(same.stats["hits"] == plain.stats["hits"]);
      CHECK(same.stats["frame_crc32"] == plain.stats["frame_crc32"]);
    }
    CHECK(!plain.stats.contains("samples"));
  }
}

TEST_CASE("render quality: more of each -> samples multiply rays, a cut-off and a depth save visits") {
  const QualityPicture plain = render_ppm({"--shade", "color"});
  const QualityPicture sampled = render_ppm({"--shade", "color", "--samples", "9"});
  CHECK(sampled.stats["rays"] == 9 * 64 * 48);
  CHECK(sampled.stats["samples"] == 9);
  CHECK(sampled.bytes != plain.bytes);
  CHECK(sampled.bytes.size() == plain.bytes.size());
  std::uint64_t before = plain.stats["node_visits"];
  for (const char* pixels : {"2", "4", "16"}) {
    const QualityPicture cut = render_ppm({"--shade", "color", "--cutoff", pixels});
    const std::uint64_t visits = cut.stats["node_visits"];
    CHECK(visits < before);
    CHECK(cut.stats["hits"] >= plain.stats["hits"]);
    CHECK(cut.stats["cutoff_px"] == std::atof(pixels));
    before = visits;
  }
  const QualityPicture shallow = render_ppm({"--shade", "color", "--max-depth", "4"});
  CHECK(shallow.stats["node_visits"] < plain.stats["node_visits"]);
  CHECK(shallow.stats["max_depth"] == 4);
  const QualityPicture all =
      render_ppm({"--shade", "color", "--max-depth", "5", "--cutoff", "3", "--samples", "4"});
  CHECK(all.stats["rays"] == 4 * 64 * 48);
}

TEST_CASE(
    "render quality: samples, plain and lit -> the mean of the same view drawn larger, pixel by pixel") {
  const TemporaryFolder folder;
  for (const Words& scene :
       {Words{"spheres", "--eye", "-40,-60,80", "--target", "32,32,30", "--shade", "depth"},
        Words{"water", "--effects", "auto"}}) {
    CAPTURE(scene[0]);
    const auto draw = [&](const std::string& size, const std::string& samples, const std::string& file) {
      check_done(Words{"render"} + scene +
                 Words{"--quiet", "--size", size, "--samples", samples, "-o", folder.path(file)});
      const std::string text = read_text(folder.path(file));
      return text.substr(text.find("255\n") + 4);
    };
    const std::string mean = draw("40x30", "4", "mean.ppm");
    const std::string fine = draw("80x60", "1", "fine.ppm");
    REQUIRE(mean.size() == 3U * 40 * 30);
    REQUIRE(fine.size() == 4 * mean.size());
    for (std::size_t i = 0; i < mean.size(); ++i) {
      const std::size_t at = 3 * (i / 120 * 2 * 80 + i / 3 % 40 * 2) + i % 3;
      int sum = 2;
      for (const std::size_t place : {at, at + 3, at + 240, at + 243}) {
        sum += static_cast<unsigned char>(fine[place]);
      }
      REQUIRE(static_cast<int>(static_cast<unsigned char>(mean[i])) == sum / 4);
    }
  }
}

TEST_CASE("render quality: samples that are no square -> the next square's picture, and it is said") {
  CHECK(render_ppm({"--samples", "8"}).bytes == render_ppm({"--samples", "9"}).bytes);
  CHECK(render_ppm({"--samples", "50"}).stats["samples"] == 64);
  const Words words{"render", "spheres", "--size", "8x6", "--samples", "8", "-o", "-"};
  CHECK(run_command(words).err.find("note: --samples 8 is not a square; 9 are taken") != std::string::npos);
  Words quiet = words;
  quiet.emplace_back("--quiet");
  CHECK(run_command(quiet).err.empty());
}

TEST_CASE("render quality: --hits with a cut-off -> lowest corners of blocks, never farther than without") {
  const TemporaryFolder folder;
  const auto hits = [&](const Words& more) {
    check_done(Words{"render", "spheres", "--quiet", "--size", "32x24", "-o", folder.path("a.ppm"), "--hits",
                     folder.path("h.csv"), "--shade", "depth"} +
               more);
    return lines_of(read_text(folder.path("h.csv")));
  };
  const auto plain = hits({});
  const auto cut = hits({"--cutoff", "8", "--samples", "4"});
  REQUIRE(plain.size() == cut.size());
  int different = 0;
  for (std::size_t i = 1; i < plain.size(); ++i) {
    const auto a = split(plain[i]);
    const auto b = split(cut[i]);
    CHECK(std::equal(a.begin() + 9, a.begin() + 15, b.begin() + 9));  // the same rays
    if (a[2] == "1") {
      REQUIRE(b[2] == "1");
      CHECK(std::stod(b[6]) <= std::stod(a[6]));
      different += a[3] != b[3] || a[4] != b[4] || a[5] != b[5] ? 1 : 0;
    }
  }
  CHECK(different > 10);
}

TEST_CASE("render quality: bad values -> status 2; what cannot be done -> status 1; each a sentence") {
  const auto refused = [](const Words& more, int status, const std::string& named) {
    check_refused(Words{"render", "spheres", "--quiet", "-o", "-"} + more, status, {named});
  };
  for (const char* value : {"0", "-1", "65", "81", "x", "", "4.0"}) {
    refused({"--samples", value}, 2, "1 to 64");
  }
  for (const char* value : {"-0.1", "64.1", "nan", "inf", "x", ""}) {
    refused({"--cutoff", value}, 2, "0 to 64");
  }
  for (const char* value : {"0", "13", "x"}) {
    refused({"--max-depth", value}, 2, "1 to 12");
  }
  refused({"--cutoff", "1", "--structure", "pool"}, 2, "--structure compact");
  refused({"--max-depth", "4", "--structure", "dense"}, 2, "--structure compact");
  refused({"--samples", "64", "--size", "2049x10"}, 1, "2048");
  for (const char* value : {"autos", "aut", "auto,4", "auto4"}) {
    refused({"--samples", value}, 2, "neither auto nor");
  }
  refused({"--samples", "auto", "--size", "10x4097"}, 1, "--samples auto wants a picture of at most 4096");
}

TEST_CASE(
    "render quality: a budget without room for mean colours -> an error that says how much; then drawn") {
  const TemporaryFolder folder;
  const std::string baked = folder.path("s.oct");
  check_done({"bake", "spheres", "--quiet", "-o", baked});
  const QualityPicture plain = render_ppm({"--shade", "color", "--cutoff", "0"}, baked);
  const std::string budget = std::to_string(plain.stats["high_water_bytes"].get<std::uint64_t>());
  const auto with = [&](const Words& more) {
    return run_command(
        Words{"render", baked, "--size", "64x48", "--quiet", "-o", "-", "--memory", budget, "--cutoff", "2"} +
        more);
  };
  const CommandResult refused = with({"--shade", "color"});
  CHECK(refused.status == 1);
  CHECK(refused.err.find("mean colours") != std::string::npos);
  CHECK(refused.err.find(" bytes") != std::string::npos);
  CHECK(with({"--shade", "depth"}).status == 0);  // wants none
}

}  // namespace
