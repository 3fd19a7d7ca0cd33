#include <doctest/doctest.h>
#include <zlib.h>

#include <array>
#include <set>
#include <string>
#include <vector>

#include "scene/generators.h"
#include "scene/random.h"

namespace {

using namespace thimble::tools;

struct Digest {
  std::uint64_t calls = 0;
  std::uint32_t crc = 0;
};

std::vector<std::array<int, 4>> voxels_of(const std::string& text) {
  std::vector<std::array<int, 4>> voxels;
  generate(*parse_generator(text), [&](int x, int y, int z, std::uint8_t material) {
    voxels.push_back({x, y, z, material});
  });
  return voxels;
}

/// The CRC-32 is of x, y, z as two bytes each, low byte first, and the material.
Digest digest(const std::string& text) {
  Digest result;
  for (const auto& [x, y, z, material] : voxels_of(text)) {
    ++result.calls;
    for (const int part : {x, x >> 8, y, y >> 8, z, z >> 8, material}) {
      const auto byte = static_cast<std::uint8_t>(part);
      result.crc = static_cast<std::uint32_t>(crc32(result.crc, &byte, 1));
    }
  }
  return result;
}

}  // namespace

TEST_CASE("random: SplitMix64 -> the published generator's numbers") {
  // The first outputs for seed 1234567, as listed for other implementations (Rosetta Code, "Pseudo-random
  // numbers/Splitmix64").
  SplitMix64 random(1234567);
  CHECK(random.next() == 6457827717110365317U);
  CHECK(random.next() == 3203168211198807973U);
  CHECK(random.next() == 9817491932198370423U);
  CHECK(random.next() == 4593380528125082431U);
  CHECK(random.next() == 16408922859458223821U);
}

TEST_CASE("generators: a spec in full and by default -> as written") {
  const auto points = parse_generator("points:1000000,seed=7,depth=12");
  REQUIRE(points.has_value());
  CHECK(points->kind == GeneratorKind::kPoints);
  CHECK(points->count == 1000000);
  CHECK(points->seed == 7);
  CHECK(points->depth == 12);
  const auto cluster = parse_generator("cluster:0");
  REQUIRE(cluster.has_value());
  CHECK(cluster->kind == GeneratorKind::kCluster);
  CHECK(cluster->count == 0);
  CHECK(cluster->seed == 1);
  CHECK(cluster->depth == 10);
  CHECK(parse_generator("spheres")->depth == 6);
  CHECK(parse_generator("water,depth=1")->depth == 1);
  CHECK(parse_generator("water,depth=8,seed=18446744073709551615")->seed == 18446744073709551615U);
  CHECK(parse_generator("points:1000000000")->count == kMaxGeneratorPoints);
  CHECK(parse_generator("points:1e6")->count == 1000000);
  CHECK(parse_generator("cluster:2.5E3,depth=6")->count == 2500);
}

TEST_CASE("generators: names of files -> no generator") {
  for (const char* text :
       {"", "points.xyz", "point:3", "./water", "waters", "Spheres", " spheres", "clusters:3", "a,b"}) {
    CAPTURE(std::string(text));
    CHECK_FALSE(parse_generator(text).has_value());
  }
}

TEST_CASE("generators: a name with bad parameters -> an error") {
  for (const char* text : {"points",
                           "points:",
                           "points:x",
                           "points:-1",
                           "points:+1",
                           "points:1e",
                           "points:1e100",
                           "points:1.5e0",
                           "points:.5e1",
                           "points:1.0",
                           "points: 1",
                           "points:1000000001",
                           "points:99999999999999999999999",
                           "points,seed=1",
                           "points:1,",
                           "points:1,seed",
                           "points:1,seed=",
                           "points:1,seed=-1",
                           "points:1,seed=18446744073709551616",
                           "points:1,depth=0",
                           "points:1,depth=13",
                           "points:1,depth=x",
                           "points:1,depth=5,depth=6",
                           "points:1,colour=3",
                           "points:1,,seed=1",
                           "points:1,seed=1,",
                           "points:1:2",
                           "cluster",
                           "cluster,depth=4",
                           "spheres:3",
                           "spheres,",
                           "spheres:",
                           "water:1",
                           "water,Seed=1",
                           "water,=1",
                           "water,seed=1=2"}) {
    CAPTURE(std::string(text));
    CHECK_THROWS_AS(parse_generator(text), InputError);
  }
  CHECK_THROWS_WITH_AS(parse_generator("points:1,depth=13"), "depth must be a whole number 1..12, not \"13\"",
                       InputError);
}

TEST_CASE("generators: golden streams -> the same on every machine") {
  struct Golden {
    const char* text;
    std::uint64_t calls;
    std::uint32_t crc;
  };
  for (const Golden& golden :
       {Golden{"points:1000", 1000, 0x1BCAFE78}, Golden{"points:1000,seed=7,depth=12", 1000, 0xB2960E60},
        Golden{"cluster:20000", 20000, 0x95E68EE9},
        Golden{"cluster:1000,seed=18446744073709551615,depth=12", 1000, 0x9D3FCCAB},
        Golden{"spheres", 28327, 0x342B0D8D}, Golden{"spheres,seed=2,depth=5", 3543, 0xA8B3342A},
        Golden{"water", 42084, 0x5F1C1D4B}, Golden{"water,seed=2,depth=5", 4661, 0x9FB20E0E},
        Golden{"demo", 72295, 0xE189945F}, Golden{"demo,seed=2,depth=5", 9073, 0xD617E655},
        Golden{"demo,seed=3,depth=7", 589670, 0x9B95AAB3}}) {
    const Digest result = digest(golden.text);
    CAPTURE(std::string(golden.text));
    CHECK(result.calls == golden.calls);
    CHECK(result.crc == golden.crc);
  }
}

TEST_CASE("generators: every kind at every depth -> inside the world, materials in the palette") {
  for (const char* text : {"points:2000", "cluster:2000", "spheres", "water", "demo"}) {
    const bool solid = std::string(text).find(':') == std::string::npos;
    for (int depth = 1; depth <= (solid ? 6 : 12); ++depth) {
      const std::string spec = std::string(text) + ",depth=" + std::to_string(depth);
      CAPTURE(spec);
      const Palette palette = generator_palette(parse_generator(spec)->kind);
      std::uint64_t calls = 0;
      generate(*parse_generator(spec), [&](int x, int y, int z, std::uint8_t material) {
        ++calls;
        REQUIRE((x >= 0 && y >= 0 && z >= 0 && x < 1 << depth && y < 1 << depth && z < 1 << depth));
        REQUIRE((solid ? material > 0 && !(palette[material].color == palette[0].color) : material == 0));
      });
      CHECK((calls == 2000 || (solid && calls > 0)));
    }
  }
}

TEST_CASE("generators: points and clusters at a smaller depth -> the same points, coarser") {
  for (const char* text : {"points:500", "cluster:500"}) {
    const auto fine = voxels_of(std::string(text) + ",depth=12");
    const auto coarse = voxels_of(std::string(text) + ",depth=5");
    REQUIRE(fine.size() == coarse.size());
    for (std::size_t i = 0; i < fine.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        REQUIRE((fine[i][axis] >> 7) == coarse[i][axis]);
      }
    }
  }
}

TEST_CASE("generators: demo -> each voxel once; a camera in the air that looks at the castle at any depth") {
  for (const std::string text : {"demo", "demo,seed=5", "demo,depth=7"}) {
    CAPTURE(text);
    const auto spec = parse_generator(text);
    std::set<std::array<int, 3>> places;
    std::size_t calls = 0;
    generate(*spec, [&](int x, int y, int z, std::uint8_t) {
      ++calls;
      places.insert({x, y, z});
    });
    CHECK(places.size() == calls);
    const auto camera = generator_camera(*spec);
    REQUIRE(camera.has_value());
    const int side = 1 << spec->depth;
    CHECK(places.count({camera->eye.x.floor(), camera->eye.y.floor(), camera->eye.z.floor()}) == 0);
    CHECK(camera->target.x.floor() == side / 2);
    CHECK(camera->target.y.floor() == side / 2);
    CHECK(camera->fov_degrees == thimble::Q16::saturate(52));
    // The middle of the castle's court is paved, and there is air above it.
    const int voxel = side / 64;
    CHECK(places.count({35 * voxel, 33 * voxel, 13 * voxel}) == 1);
    CHECK(places.count({35 * voxel, 33 * voxel, 15 * voxel}) == 0);
  }
  CHECK_FALSE(generator_camera(*parse_generator("spheres")).has_value());
}

TEST_CASE("generators: water's camera -> at the same place of the world at every depth") {
  for (const int depth : {1, 4, 6, 12}) {
    CAPTURE(depth);
    const auto camera = generator_camera(*parse_generator("water,depth=" + std::to_string(depth)));
    REQUIRE(camera.has_value());
    CHECK(camera->eye.x.raw == 6 * 256 * (1 << depth) / 64);
    CHECK(camera->eye.y.raw == -22 * 256 * (1 << depth) / 64);
    CHECK(camera->target.z.raw == 11 * 256 * (1 << depth) / 64);
  }
}

TEST_CASE("generators: a sink that throws -> the exception comes through") {
  for (const char* text : {"points:10", "cluster:10", "spheres", "water", "demo"}) {
    CHECK_THROWS_AS(generate(*parse_generator(text), [](int, int, int, std::uint8_t) { throw 1; }), int);
  }
}
