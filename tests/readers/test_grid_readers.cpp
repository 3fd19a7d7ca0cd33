// Readers of voxel grids: .binvox, .mts, .schematic and .schem, .qb, .kvx, NumPy arrays, grids of heights.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "readers/block_colors.h"
#include "readers/formats.h"
#include "readers/read_any.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"

using namespace thimble::tools;
using namespace thimble::tools::test;
using thimble::tests::deflated;
using thimble::tests::little;

namespace {

std::string big(std::uint64_t value, std::size_t bytes) {
  std::string out = little(value, bytes);
  std::reverse(out.begin(), out.end());
  return out;
}

bool has_voxel(const std::vector<GridVoxel>& voxels, const GridVoxel& wanted) {
  return std::find(voxels.begin(), voxels.end(), wanted) != voxels.end();
}

std::string binvox(const std::string& dim, const std::string& runs) {
  return "#binvox 1\ndim " + dim + "\ntranslate 0 0 0\nscale 1\ndata\n" + runs;
}

// ---- Minecraft

std::string tag(int kind, const std::string& name, const std::string& value) {
  return std::string(1, static_cast<char>(kind)) + big(name.size(), 2) + name + value;
}
std::string bytes_tag(const std::string& name, const std::string& bytes) {
  return tag(7, name, big(bytes.size(), 4) + bytes);
}
std::string compound(const std::string& name, const std::string& entries) {
  return tag(10, name, entries + std::string(1, '\0'));
}
std::string sides(unsigned width, unsigned height, unsigned length) {
  return tag(2, "Width", big(width, 2)) + tag(2, "Height", big(height, 2)) + tag(2, "Length", big(length, 2));
}
std::string schematic(const std::string& more) {
  return compound("Schematic", tag(9, "Entities",
                                   std::string(1, 10) + big(1, 4) + tag(8, "id", big(2, 2) + "ab") +
                                       std::string(1, '\0')) +
                                   sides(2, 1, 3) + more);
}

std::string mts(unsigned version, const std::vector<unsigned>& numbers, const std::string& chances) {
  std::string nodes;
  for (const unsigned number : numbers) {
    nodes += big(number, 2);
  }
  nodes += chances + std::string(chances.size(), '\0');
  return "MTSM" + big(version, 2) + big(2, 2) + big(1, 2) + big(2, 2) + (version >= 3 ? "\x7f" : "") +
         big(2, 2) + big(3, 2) + "air" + big(12, 2) + "default:dirt" + deflated(nodes, 15);
}

// ---- NumPy

std::string npy(const std::string& type, const std::string& shape, const std::string& data,
                bool fortran = false) {
  const std::string header = "{'descr': '" + type + "', 'fortran_order': " + (fortran ? "True" : "False") +
                             ", 'shape': " + shape + ", }\n";
  return std::string("\x93NUMPY\x01\x00", 8) + little(header.size(), 2) + header + data;
}

std::string zip(const std::vector<std::pair<std::string, std::string>>& members, bool deflate) {
  std::string out;
  std::string directory;
  for (const auto& [name, data] : members) {
    const std::string packed = deflate ? deflated(data, -15) : data;
    const std::string common = little(20, 2) + little(0, 2) + little(deflate ? 8 : 0, 2) + little(0, 8) +
                               little(packed.size(), 4) + little(data.size(), 4) + little(name.size(), 2) +
                               little(0, 2);
    directory += "PK\x01\x02" + little(20, 2) + common + little(0, 10) + little(out.size(), 4) + name;
    out += "PK\x03\x04" + common + name + packed;
  }
  const std::size_t start = out.size();
  return out + directory + "PK\x05\x06" + little(0, 4) + little(members.size(), 2) +
         little(members.size(), 2) + little(directory.size(), 4) + little(start, 4) + little(0, 2);
}

// ---- Qubicle, KVX

std::string qb(bool packed, const std::string& voxels, std::int32_t x = 0) {
  return little(0x101, 4) + little(0, 4) + little(1, 4) + little(packed ? 1 : 0, 4) + little(0, 4) +
         little(1, 4) + "\x02" + "ab" + little(2, 4) + little(1, 4) + little(2, 4) +
         little(static_cast<std::uint32_t>(x), 4) + little(0, 8) + voxels;
}

std::string kvx() {
  // 1 x 2 columns of 3 voxels: the first has one slab of two, the second is empty.
  const std::string slab = std::string("\x01\x02\x3f", 3) + "\x05\x06";
  const std::string tables =
      little(0, 4) + little(0, 4) + little(14, 2) + little(14 + 5, 2) + little(14 + 5, 2);
  std::string model = little(1, 4) + little(2, 4) + little(3, 4) + little(0, 12) + tables + slab;
  std::string palette(768, '\0');
  palette[15] = 63;
  palette[18 + 2] = 63;
  return little(model.size(), 4) + model + palette;
}

}  // namespace

TEST_CASE("binvox: runs -> voxels, y fastest, then z, then x") {
  // Index = (x * 2 + z) * 3 + y; solid: x 0, z 1, y 0 and 1.
  const std::string file = binvox("1 2 3", std::string("\0\x03\x01\x02\0\x01", 6));
  CHECK(looks_like_binvox(SharedBytes::own(file).bytes));
  const auto voxels = read_voxels(read_binvox, file);
  REQUIRE(voxels.size() == 2);
  CHECK(voxels[0] == GridVoxel{0, 0, 1, {}});
  CHECK(voxels[1] == GridVoxel{0, 1, 1, {}});
  CHECK(accepted_lengths(read_binvox, file).empty());
}

TEST_CASE("binvox: damage -> the place") {
  CHECK(contains(error_of(read_binvox, binvox("1 2 3", std::string("\0\x03\x02\x02", 4))), "the value 2"));
  CHECK(contains(error_of(read_binvox, binvox("1 2 3", std::string("\x01\xff", 2))), "255 times"));
  CHECK(contains(error_of(read_binvox, binvox("1 2 3", std::string("\x01\0", 2))), "0 times"));
  CHECK(contains(error_of(read_binvox, binvox("1 2 3", std::string("\0\x06", 2))), "no solid"));
  CHECK(contains(error_of(read_binvox, binvox("1 2 5000", "")), "'5000'"));
  CHECK(contains(error_of(read_binvox, binvox("4096 4096 4096", "\x01\x01")), "ends after 1 of 68719476736"));
  CHECK(contains(error_of(read_binvox, "#binvox 2\n"), "version 1"));
  CHECK(contains(error_of(read_binvox, "#binvox 1\ndata\n"), "before 'dim'"));
  CHECK(contains(error_of(read_binvox, "dim"), "#binvox"));
}

TEST_CASE("mts: nodes -> coloured voxels; chance 0 and air -> none") {
  const Rgb dirt = *block_color("default:dirt");
  for (const unsigned version : {1U, 2U, 3U, 4U}) {
    INFO(version);
    const auto voxels = read_voxels(read_mts, mts(version, {1, 0, 1, 1}, std::string("\x7f\x7f\x7f\x7f", 4)));
    REQUIRE(voxels.size() == 3);
    CHECK(voxels[0] == GridVoxel{0, 1, 0, dirt});  // z 0 is the farthest
    CHECK(voxels[1] == GridVoxel{0, 0, 0, dirt});
  }
  CHECK(read_voxels(read_mts, mts(4, {1, 1, 1, 1}, std::string("\x7f\0\x80\xff", 4))).size() == 2);
  CHECK(
      contains(error_of(read_mts, mts(4, {1, 2, 1, 1}, std::string(4, '\x7f'))), "node 1 has the number 2"));
  CHECK(contains(error_of(read_mts, mts(4, {1, 1, 1}, std::string(3, '\x7f'))), "12 bytes"));
  CHECK(contains(error_of(read_mts, mts(4, {1, 1, 1, 1, 1}, std::string(5, '\x7f'))), "limit"));
  CHECK(contains(error_of(read_mts, mts(4, {0, 0, 0, 0}, std::string(4, '\x7f'))), "nothing but air"));
  CHECK(contains(error_of(read_mts, mts(5, {}, "")), "version 5"));
  CHECK(accepted_lengths(read_mts, mts(4, {1, 0, 1, 1}, std::string(4, '\x7f'))).empty());
}

TEST_CASE("schematic: numbers, data and added bits -> colours") {
  // (x, z): stone air / air white wool / air 256 + 1, which is no stone
  const std::string file =
      schematic(bytes_tag("Blocks", std::string("\x01\0\0\x23\0\x01", 6)) +
                bytes_tag("Data", std::string(6, '\0')) + bytes_tag("AddBlocks", std::string("\0\0\x01", 3)));
  CHECK(looks_like_schematic(SharedBytes::own(file).bytes));
  const auto voxels = read_voxels(read_schematic, file);
  REQUIRE(voxels.size() == 3);
  CHECK(voxels[0] == GridVoxel{0, 2, 0, *block_color("stone")});
  CHECK(voxels[1] == GridVoxel{1, 1, 0, *block_color("white_wool")});
  CHECK(voxels[2].color != voxels[0].color);
  CHECK(accepted_lengths(read_schematic, file).size() <= 2);  // the ends of the compounds
}

TEST_CASE("schem: versions 1 to 3 -> the palette's colours") {
  const std::string palette =
      compound("Palette", tag(3, "minecraft:air", big(0, 4)) +
                              tag(3, "minecraft:oak_log[axis=y]", big(200, 4)) + std::string());
  // 200 takes two bytes.
  const std::string blocks("\xC8\x01\0\0\0\0\0", 7);
  std::string many = palette;
  const std::string v2 = compound("Schematic", sides(2, 1, 3) + many + bytes_tag("BlockData", blocks) +
                                                   tag(8, "padding", big(2000, 2) + std::string(2000, 'x')));
  const auto voxels = read_voxels(read_schematic, v2);
  REQUIRE(voxels.size() == 1);
  CHECK(voxels[0] == GridVoxel{0, 2, 0, *block_color("oak_log")});
  const std::string v3 = compound(
      "", compound("Schematic", sides(2, 1, 3) + compound("Blocks", many + bytes_tag("Data", blocks)) +
                                    tag(8, "padding", big(2000, 2) + std::string(2000, 'x'))));
  CHECK(read_voxels(read_schematic, v3) == voxels);
  CHECK(contains(error_of(read_schematic,
                          compound("Schematic", sides(2, 1, 3) + palette + bytes_tag("BlockData", blocks))),
                 "the number 200"));
  CHECK(contains(
      error_of(read_schematic,
               compound("Schematic", sides(2, 1, 4) + compound("Palette", tag(3, "stone", big(0, 4))) +
                                         bytes_tag("BlockData", std::string(7, '\0')))),
      "7 bytes"));
  CHECK(contains(
      error_of(read_schematic,
               compound("Schematic", sides(1, 1, 1) + compound("Palette", tag(3, "stone", big(0, 4))) +
                                         bytes_tag("BlockData", std::string(1, '\x05')))),
      "the number 5"));
}

TEST_CASE("schematic: damage -> a sentence, and no deep or long nothing") {
  CHECK(contains(error_of(read_schematic, "text"), "Schematic"));
  CHECK(contains(error_of(read_schematic, schematic("")), "0 bytes"));
  CHECK(contains(error_of(read_schematic, compound("Schematic", bytes_tag("Blocks", "a"))), "not all there"));
  CHECK(contains(error_of(read_schematic, compound("Schematic", tag(2, "Width", big(5000, 2)))), "5000"));
  CHECK(contains(error_of(read_schematic, schematic(tag(9, "x", std::string(1, '\0') + big(7, 4)))),
                 "nothings"));
  CHECK(contains(error_of(read_schematic, schematic(tag(99, "x", ""))), "kind 99"));
  CHECK(contains(error_of(read_schematic, schematic(tag(11, "x", big(0xFFFFFFFF, 4)))), "-1"));
  std::string deep;
  for (int i = 0; i < 100000; ++i) {
    deep += std::string("\x09", 1) + big(1, 4);
  }
  CHECK(contains(error_of(read_schematic, schematic(tag(9, "x", deep))), "512"));
}

TEST_CASE("blocks: names -> colours by what they are") {
  CHECK(block_color("minecraft:air") == std::nullopt);
  CHECK(block_color("air") == std::nullopt);
  CHECK(block_color("minecraft:light_blue_wool") != block_color("minecraft:blue_wool"));
  CHECK(block_color("minecraft:oak_stairs[facing=east]") == block_color("oak_planks"));
  CHECK(block_color("minecraft:spruce_log") != block_color("minecraft:birch_log"));
  CHECK(block_color("default:leaves") == block_color("minecraft:oak_leaves"));
  CHECK(block_color("minecraft:grass_block") == block_color(2, 0));
  CHECK(block_color("something:nobody_knows").has_value());
  for (unsigned number = 0; number < 5000; ++number) {
    CHECK(block_color(number, 3).has_value() == (number != 0 && number != 36 && number != 166));
  }
}

static Source read_height_rows(const SharedBytes& file, const ReadOptions&, const Progress& progress) {
  return read_npy(file, {"", {}, ArrayAs::kHeights}, progress);
}

TEST_CASE("npy: shapes -> voxels, colours, points, heights") {
  for (const bool fortran : {false, true}) {
    // 2 x 1 x 3 booleans: [1][0][2] alone is solid.
    std::string data(6, '\0');
    data[fortran ? 5 : 5] = 1;
    const auto voxels = read_voxels(read_npy, npy("|b1", "(2, 1, 3)", data, fortran));
    REQUIRE(voxels.size() == 1);
    CHECK(voxels[0] == GridVoxel{1, 0, 2, {}});
  }
  std::string data(6, '\0');
  data[1] = 1;  // second number in memory
  CHECK(read_voxels(read_npy, npy("|u1", "(2, 1, 3)", data, false))[0] == GridVoxel{0, 0, 1, {}});
  CHECK(read_voxels(read_npy, npy("|u1", "(2, 1, 3)", data, true))[0] == GridVoxel{1, 0, 0, {}});
  CHECK(read_voxels(read_npy, npy("|u1", "(1, 1, 2, 3)", std::string("\0\0\0\x01\x02\x03", 6))) ==
        std::vector<GridVoxel>{{0, 0, 1, {1, 2, 3}}});
  CHECK(read_voxels(read_npy, npy("|u1", "(1, 1, 2, 4)", std::string("\0\0\0\x01\x01\x02\x03\0", 8))) ==
        std::vector<GridVoxel>{{0, 0, 0, {0, 0, 0}}});
  std::string floats;
  for (const float value : {1.0F, 2.0F, -3.0F, 10.0F, 20.0F, 30.0F}) {
    floats += big(std::bit_cast<std::uint32_t>(value), 4);
  }
  const auto points = read_points(read_npy, npy(">f4", "(2, 3)", floats));
  REQUIRE(points.size() == 2);
  CHECK(points[1].y == 20);
  CHECK(points[0].z == -3);
  CHECK_FALSE(cloud_has_color(read_npy, npy(">f4", "(1, 6)", floats)) == false);
  const auto hills = read_voxels(read_height_rows, npy("<i2", "(2, 3)", little(0, 10) + little(100, 2)));
  CHECK(hills.size() > 512 * 341);
  // The last of the first row is the lowest, the last of the last row, which is near, the highest.
  CHECK(std::any_of(hills.begin(), hills.end(),
                    [](const GridVoxel& v) { return v.x == 511 && v.y == 0 && v.z == 85; }));
}

TEST_CASE("npz: stored and deflated -> the largest array; damage -> a sentence") {
  const std::string small = npy("|u1", "(1, 1, 1)", "\x01");
  const std::string large = npy("|u1", "(1, 2, 2)", "\x01\x01\x01\x01");
  const std::string scalar = npy("<f8", "()", little(0, 8));
  for (const bool deflate : {false, true}) {
    const std::string file =
        zip({{"dx.npy", scalar}, {"a.npy", small}, {"b.npy", large}, {"c.txt", "text"}}, deflate);
    CHECK(looks_like_npy(SharedBytes::own(file).bytes));
    CHECK(read_voxels(read_npy, file).size() == 4);
    CHECK(accepted_lengths(read_npy, file).empty());
  }
  CHECK(contains(error_of(read_npy, zip({{"a.npy", scalar}}, true)), "two dimensions"));
  CHECK(contains(error_of(read_npy, npy("<f4", "(3)", std::string(12, '\0'))), "3 numbers"));
  CHECK(contains(error_of(read_npy, npy("<c8", "(3, 3)", "")), "'<c8'"));
  CHECK(contains(error_of(read_npy, npy("|O", "(3, 3)", "")), "'|O'"));
  CHECK(contains(error_of(read_npy, npy("<f8", "(4096, 4096, 4096)", "")), "room for 0"));
  CHECK(contains(error_of(read_npy, npy("<f8", "(18446744073709551615, 9, 9)", "")), "no length"));
  CHECK(contains(error_of(read_npy, npy("<f8", "(9223372036854775807, 9223372036854775807, 9)", "")),
                 "room for 0"));
  CHECK(contains(error_of(read_npy, npy("|u1", "(1, 1, 5000)", std::string(5000, '\x01'))), "5000"));
  CHECK(contains(error_of(read_npy, npy("|u1", "(1, 1, 5)", std::string(5, '\0'))), "nothing solid"));
  CHECK(contains(error_of(read_npy, std::string("\x93NUMPY\x09\0\0\0", 10)), "version 9"));
  CHECK(accepted_lengths(read_npy, large).empty());
}

TEST_CASE("zip: one scene among other files -> the scene; none or several -> a sentence") {
  const std::string array = npy("|u1", "(1, 2, 2)", "\x01\x01\x01\x01");
  const std::string cloud = "1 2 3\n4 5 6\n";
  const auto read = [](const std::string& file) {
    return read_any(ReadOptions{"/tmp/a.zip", std::nullopt}, SharedBytes::own(file));
  };
  const auto refusal = [&](const std::string& file) {
    try {
      read(file);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const bool deflate : {false, true}) {
    const std::string file = zip({{"a/", ""},
                                  {"__MACOSX/._b.ply", "junk"},
                                  {"a/.DS_Store", "junk"},
                                  {"a/LICENSE.txt", "all yours"},
                                  {"a/picture.png", "\x89PNG"},
                                  {"a/b.npy", array}},
                                 deflate);
    CHECK(std::get<std::unique_ptr<VoxelGrid>>(read(file))->size() == std::array<std::int32_t, 3>{1, 2, 2});
    CHECK(std::holds_alternative<std::unique_ptr<PointCloud>>(read(zip({{"a.txt", cloud}}, deflate))));
    for (std::size_t length = 30; length < file.size(); ++length) {
      CHECK_FALSE(refusal(file.substr(0, length)).empty());
    }
  }
  CHECK(refusal(zip({{"a.png", "x"}}, false)) == "the archive holds no scene");
  CHECK(contains(refusal(zip({{"a.xyz", cloud}, {"b/c.npy", array}}, true)),
                 "2 scenes, 'a.xyz' and 'b/c.npy'"));
  CHECK(contains(refusal(zip({{"b.zip", zip({{"a.txt", cloud}}, false)}}, false)), "no scene"));
  CHECK(contains(refusal(zip({{"a.xyz", "1 2\n"}}, false)), "line 1"));
}

TEST_CASE("asc: an ESRI grid -> a landscape; holes where there is no data") {
  const std::string head = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n";
  CHECK(looks_like_height_grid(SharedBytes::own(head).bytes));
  const auto whole = read_voxels(read_height_grid, head + "1 2 3\n4 5 6\n");
  const auto holed = read_voxels(read_height_grid, head + "1 2 3\n4 5 -9999");
  CHECK(holed.size() < whole.size());
  CHECK(contains(error_of(read_height_grid, head + "1 2 3 4 5"), "room for 5"));
  CHECK(contains(error_of(read_height_grid, head + "1 2 3 4 5 6 7"), "line 7: '7' comes after"));
  CHECK(contains(error_of(read_height_grid, head + "1 2 x 4 5 6"), "line 7: 'x'"));
  CHECK(contains(error_of(read_height_grid, "ncols 4000000000\nnrows 4000000000\n1 2"), "room for"));
  CHECK(contains(error_of(read_height_grid, "ncols -3\nnrows 2\n1"), "line 1"));
  CHECK(contains(error_of(read_height_grid, head + "-9999 -9999 -9999 -9999 -9999 -9999"), "no point"));
}

TEST_CASE("qb: packed or not -> the same voxels") {
  // Slice z 0: red, nothing; slice z 1: twice green.
  const std::string red = std::string("\xff\0\0\xff", 4);
  const std::string green = std::string("\0\xff\0\xff", 4);
  const std::string plain = qb(false, red + little(0, 4) + green + green);
  const std::string packed =
      qb(true, red + little(0, 4) + little(6, 4) + little(2, 4) + little(2, 4) + green + little(6, 4));
  const auto voxels = read_voxels(read_qb, plain);
  REQUIRE(voxels.size() == 3);
  CHECK(voxels[0].color == Rgb{255, 0, 0});
  CHECK(voxels[0] == GridVoxel{0, 1, 0, {255, 0, 0}});  // z comes towards the eye
  CHECK(has_voxel(voxels, {1, 0, 0, {0, 255, 0}}));
  CHECK(read_voxels(read_qb, packed) == voxels);
  CHECK(read_voxels(read_qb, qb(false, red + little(0, 4) + green + green, -1000000)) == voxels);
  CHECK(accepted_lengths(read_qb, plain).empty());
  CHECK(accepted_lengths(read_qb, packed).empty());
  CHECK(contains(error_of(read_qb, qb(true, little(2, 4) + little(0xFFFFFFFF, 4) + red)), "more than its 2"));
  CHECK(contains(error_of(read_qb, qb(false, little(0, 16))), "no voxels"));
  CHECK(contains(error_of(read_qb, "text"), "1, 1, 0, 0"));
}

TEST_CASE("kvx: slabs -> voxels with z up and six-bit colours") {
  const auto voxels = read_voxels(read_kvx, kvx());
  REQUIRE(voxels.size() == 2);
  CHECK(voxels[0] == GridVoxel{0, 1, 1, {255, 0, 0}});
  CHECK(voxels[1] == GridVoxel{0, 1, 0, {0, 0, 255}});
  CHECK(accepted_lengths(read_kvx, kvx()).empty());
  std::string file = kvx();
  file[36] = '\x7f';  // where the first column begins
  CHECK(contains(error_of(read_kvx, file), "column 0,0"));
  file = kvx();
  file[4] = '\0';
  CHECK(contains(error_of(read_kvx, file), "a side of 0"));
}
