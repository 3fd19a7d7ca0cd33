// Readers of voxel grids: .binvox, .mts, Minecraft's four, .bt and .ot, .qb and .qbcl, .kvx and .kv6, .vxl, .gox,
// NumPy arrays, grids of heights.
#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <string>
#include <vector>

#include "readers/formats.h"
#include "readers/read_any.h"
#include "scene/random.h"
#include "scene/scene_source.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"
#include "support/run_command.h"

using namespace thimble::tools;
using namespace thimble::tools::test;
using thimble::Vec3i;
using thimble::tests::big;
using thimble::tests::deflated;
using thimble::tests::little;
using thimble::tests::npy;
using thimble::tests::repeated;
using thimble::tests::TemporaryFolder;

namespace {

// Voxels of Qubicle and Goxel.
const std::string kRedVoxel("\xff\0\0\xff", 4);
const std::string kGreenVoxel("\0\xff\0\xff", 4);

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

std::string ints(const std::string& name, const std::vector<int>& values, bool as_list) {
  std::string list;
  std::string entries;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string value = big(static_cast<std::uint32_t>(values[i]), 4);
    list += value;
    entries += tag(3, std::string(1, static_cast<char>('x' + i)), value);
  }
  return as_list ? tag(9, name, "\x03" + big(values.size(), 4) + list) : compound(name, entries);
}
/// A list of compounds.
std::string list_tag(const std::string& name, const std::vector<std::string>& entries) {
  std::string all;
  for (const std::string& entry : entries) {
    all += entry + std::string(1, '\0');
  }
  return tag(9, name, "\x0A" + big(entries.size(), 4) + all);
}
std::string block_name(const std::string& name) {
  return compound("Properties", tag(8, "axis", big(1, 2) + "y")) + tag(8, "Name", big(name.size(), 2) + name);
}
std::string region(const std::string& name, const std::vector<int>& position, const std::vector<int>& size,
                   const std::vector<std::string>& palette, const std::vector<std::uint64_t>& words) {
  std::string longs;
  for (const std::uint64_t word : words) {
    longs += big(word, 8);
  }
  return compound(name, tag(12, "BlockStates", big(words.size(), 4) + longs) + list_tag("TileEntities", {}) +
                            ints("Position", position, false) + list_tag("BlockStatePalette", palette) +
                            ints("Size", size, false));
}
std::string litematic(const std::string& regions) {
  return compound("", compound("Metadata", ints("EnclosingSize", {1, 2, 3}, false)) +
                          tag(3, "Version", big(6, 4)) + compound("Regions", regions));
}
std::string structure(const std::string& palettes, const std::vector<std::string>& blocks) {
  return compound("", list_tag("blocks", blocks) + palettes + ints("size", {2, 3, 4}, true) +
                          tag(3, "DataVersion", big(3953, 4)));
}
std::string listed(const std::vector<int>& pos, unsigned state) {
  return tag(3, "state", big(state, 4)) + compound("nbt", tag(8, "id", big(1, 2) + "a")) +
         ints("pos", pos, true);
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

std::string zip(const std::vector<std::pair<std::string, std::string>>& members, bool deflate) {
  std::string out;
  std::string directory;
  for (const auto& [name, data] : members) {
    const std::string packed = deflate ? deflated(data, -15) : data;
    const std::string common =
        little(20, 2) + little(0, 2) + little(deflate ? 8 : 0, 2) + little(0, 4) +
        little(::crc32_z(0, reinterpret_cast<const Bytef*>(data.data()), data.size()), 4) +
        little(packed.size(), 4) + little(data.size(), 4) + little(name.size(), 2) + little(0, 2);
    directory += "PK\x01\x02" + little(20, 2) + common + little(0, 10) + little(out.size(), 4) + name;
    out += "PK\x03\x04" + common + name + packed;
  }
  const std::size_t start = out.size();
  return out + directory + "PK\x05\x06" + little(0, 4) + little(members.size(), 2) +
         little(members.size(), 2) + little(directory.size(), 4) + little(start, 4) + little(0, 2);
}

// ---- OctoMap

/// A map whose nodes are these; those of an .ot of colours where `colors` says so.
std::string octomap(const std::string& nodes, bool is_binary, const std::string& id = "OcTree") {
  return std::string("# Octomap OcTree ") + (is_binary ? "binary " : "") + "file\n# a comment\nid " + id +
         "\nsize 17\nres 0.05\ndata\n" + nodes;
}
/// A node of an .ot.
std::string map_node(float log_odds, unsigned children, const std::string& color = "") {
  return little(std::bit_cast<std::uint32_t>(log_odds), 4) + color + little(children, 1);
}
// ---- Qubicle, Voxlap

std::string qb_matrix(const std::array<unsigned, 3>& size, const std::string& voxels, std::int32_t x = 0,
                      const std::string& name = "ab") {
  return little(name.size(), 1) + name + little(size[0], 4) + little(size[1], 4) + little(size[2], 4) +
         little(static_cast<std::uint32_t>(x), 4) + little(0, 8) + voxels;
}
std::string qb(const std::vector<std::string>& matrices, bool packed = false, bool left_handed = false) {
  std::string out = little(0x101, 4) + little(0, 4) + little(left_handed ? 0 : 1, 4) +
                    little(packed ? 1 : 0, 4) + little(0, 4) + little(matrices.size(), 4);
  for (const std::string& matrix : matrices) {
    out += matrix;
  }
  return out;
}
/// One matrix of 2 x 1 x 2 voxels.
std::string qb(bool packed, const std::string& voxels, std::int32_t x = 0, bool left_handed = false,
               const std::string& name = "ab") {
  return qb({qb_matrix({2, 1, 2}, voxels, x, name)}, packed, left_handed);
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

/// Nodes as Qubicle's projects have them.
std::string qbcl(const std::string& nodes) {
  std::string out = "QBCL" + little(0, 4) + little(2, 4) + little(1, 4) + little(2, 4) + std::string(8, 'p');
  for (const std::string text : {"title", "", "", "author", "", "", ""}) {
    out += little(text.size(), 4) + text;
  }
  return out + std::string(16, 't') + nodes;
}
std::string qbcl_node(unsigned kind, const std::string& content, bool visible = true) {
  return little(kind, 4) + little(1, 4) + little(4, 4) + "name" + std::string(1, visible ? '\1' : '\0') +
         std::string(2, '\1') + content;
}
std::string qbcl_model(unsigned children) {
  return std::string(36, '\0') + little(children, 4);
}
/// Of 2 x 3 x 1 voxels.
std::string qbcl_matrix(std::int32_t x, const std::string& columns) {
  const std::string packed = deflated(columns, 15);
  return little(2, 4) + little(3, 4) + little(1, 4) + little(static_cast<std::uint32_t>(x), 4) +
         little(0, 8) + little(0, 12) + little(packed.size(), 4) + packed;
}

std::string kv6(unsigned count, const std::vector<unsigned>& lengths) {
  // 2 x 1 columns of 300 voxels: two in the first, one in the second.
  std::string file = "Kvxl" + little(2, 4) + little(1, 4) + little(300, 4) + little(0, 12) + little(count, 4);
  file += std::string("\x01\x02\x03\x80", 4) + little(0, 4) + std::string("\x04\x05\x06\x80", 4) +
          little(299, 4) + std::string("\x07\x08\x09\x80", 4) + little(7, 4) + little(2, 4) + little(1, 4);
  for (const unsigned length : lengths) {
    file += little(length, 2);
  }
  return file;
}

/// A map of Voxlap with one row of columns.
std::string vxl(const std::vector<std::string>& columns) {
  std::string file = little(0x09072000, 4) + little(columns.size(), 4) + little(1, 4) + std::string(96, 'c');
  for (const std::string& column : columns) {
    file += column;
  }
  return file;
}
std::string span(unsigned words, unsigned top, unsigned bottom, unsigned air, const std::string& colors) {
  return little(words, 1) + little(top, 1) + little(bottom, 1) + little(air, 1) + colors;
}

// ---- Goxel

std::string gox_chunk(const std::string& kind, const std::string& content) {
  return kind + little(content.size(), 4) + content + little(0, 4);
}
std::string gox_entry(const std::string& key, const std::string& value) {
  return little(key.size(), 4) + key + little(value.size(), 4) + value;
}
/// A block whose voxels at 1,2,3 and 4,0,0 have these bytes: r, g, b, alpha.
std::string gox_block(const std::string& first, const std::string& second, unsigned side = 64) {
  std::string rows;
  for (unsigned row = 0; row < side; ++row) {
    rows += '\0' + std::string(std::size_t{4} * side, '\0');
  }
  const auto put = [&](std::size_t voxel, const std::string& rgba) {
    rows.replace(voxel / side * (4 * side + 1) + 1 + voxel % side * 4, 4, rgba);
  };
  put(1 + 2 * 16 + 3 * 256, first);
  put(4, second);
  const auto chunk = [](const std::string& kind, const std::string& content) {
    const std::string both = kind + content;
    return big(content.size(), 4) + both + big(0, 4);  // nobody looks at the check sum
  };
  return gox_chunk("BL16", "\x89PNG\r\n\x1a\n" +
                               chunk("IHDR", big(side, 4) + big(side, 4) + std::string("\x08\x06\0\0\0", 5)) +
                               chunk("IDAT", deflated(rows, 15)) + chunk("IEND", ""));
}
std::string gox_place(unsigned block, std::int32_t x) {
  return little(block, 4) + little(static_cast<std::uint32_t>(x), 4) + little(0, 12);
}
std::string gox_layer(const std::string& places, const std::string& entries) {
  return gox_chunk("LAYR", little(places.size() / 20, 4) + places + entries);
}
std::string gox_mat(float scale, float x) {
  std::string out;
  for (int i = 0; i < 16; ++i) {
    out += little(i == 0 ? scale : i % 5 == 0 ? 1.0F : i == 12 ? x : 0.0F);
  }
  return gox_entry("mat", out);
}
std::string gox(const std::string& chunks, unsigned version = 2) {
  return "GOX " + little(version, 4) + gox_chunk("IMG ", "") + chunks;
}

Notes notes_of_file(Reader reader, const std::string& file) {
  return notes_of(source_of(reader, file));
}

}  // namespace

TEST_CASE("binvox: runs -> voxels, y fastest, then z, then x") {
  // Index = (x * 2 + z) * 3 + y; solid: x 0, z 1, y 0 and 1.
  const std::string file = binvox("1 2 3", std::string("\0\x03\x01\x02\0\x01", 6));
  CHECK(find_reader("", file) != nullptr);
  const auto voxels = read_voxels(read_binvox, file);
  REQUIRE(voxels.size() == 2);
  CHECK(voxels[0] == GridVoxel{0, 0, 1, {}});
  CHECK(voxels[1] == GridVoxel{0, 1, 1, {}});
  CHECK(accepted_lengths(read_binvox, file).empty());
  std::string commented = file;
  CHECK(read_voxels(read_binvox, commented.insert(commented.find("dim"), "# by hand\n")) == voxels);
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
    CHECK(voxels[0] == GridVoxel{0, 0, 0, dirt});  // z 0 is the nearest
    CHECK(voxels[1] == GridVoxel{0, 1, 0, dirt});
  }
  CHECK(read_voxels(read_mts, mts(4, {1, 1, 1, 1}, std::string("\x7f\0\x80\xff", 4))).size() == 2);
  CHECK(
      contains(error_of(read_mts, mts(4, {1, 2, 1, 1}, std::string(4, '\x7f'))), "block 1 has the number 2"));
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
  CHECK(looks_like_schematic(file));
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
  const std::string deep = repeated("\x09" + big(1, 4), 100000);
  CHECK(contains(error_of(read_schematic, schematic(tag(9, "x", deep))), "512"));
}

TEST_CASE("litematic: regions, packed across words, sizes below zero -> voxels where they lie") {
  // 3 x 5 x 1 (x, y, z) of 17 kinds: five bits each. Block 12 lies in both words: its number 16 has its highest bit
  // alone in the second. Blocks 0 and 14 are of kind 1.
  std::vector<std::string> palette{block_name("minecraft:air"), block_name("minecraft:stone")};
  palette.resize(17, block_name("minecraft:oak_log"));
  const std::vector<std::uint64_t> words{1, 1 | std::uint64_t{1} << 6};
  const std::string wall = region("wall", {10, -3, 7}, {3, 5, 1}, palette, words);
  const std::string file = litematic(wall);
  const Rgb stone = *block_color("stone");
  CHECK(looks_like_schematic(file));
  CHECK(read_voxels(read_schematic, file) ==
        std::vector<GridVoxel>{{0, 0, 0, stone}, {0, 0, 4, *block_color("oak_log")}, {2, 0, 4, stone}});
  // The same box from its other corner, and one block of another palette beside it.
  const std::string turned = region("turned", {12, 1, 7}, {-3, -5, -1}, palette, words);
  CHECK(read_voxels(read_schematic, litematic(turned)) == read_voxels(read_schematic, file));
  const auto two = read_voxels(
      read_schematic,
      litematic(turned + region("b", {8, 1, 9}, {1, -1, 1}, {block_name("sand"), block_name("dirt")}, {1})));
  REQUIRE(two.size() == 4);
  CHECK(two[0] == GridVoxel{2, 2, 0, stone});
  CHECK(two[3] == GridVoxel{0, 0, 4, *block_color("dirt")});
  CHECK(accepted_lengths(read_schematic, file).empty());
  const auto refusal = [&](const std::vector<int>& position, const std::vector<int>& size,
                           const std::vector<std::string>& names, std::uint64_t word) {
    return error_of(read_schematic, litematic(wall + region("b", position, size, names, {word})));
  };
  const std::vector<std::string> one{block_name("stone")};
  CHECK(contains(refusal({0, 0, 0}, {0, 1, 1}, one, 0), "Size of region 'b' is 0"));
  CHECK(contains(refusal({0, 0, 0}, {1, INT32_MIN, 1}, one, 0), "Size of region 'b' is 2147483648"));
  CHECK(contains(refusal({5000, 0, 0}, {1, 1, 1}, one, 0), "all regions is 4991"));
  CHECK(contains(refusal({INT32_MIN, 0, 0}, {-1, 1, 1}, one, 0), "all regions is 2147483661"));
  CHECK(
      contains(refusal({0, 0, 0}, {4096, 4096, 4096}, one, 0), "no room for 68719476736 blocks of 1 kinds"));
  CHECK(contains(refusal({0, 0, 0}, {33, 1, 1}, one, 0), "no room for 33"));
  CHECK(contains(refusal({0, 0, 0}, {1, 1, 1}, {}, 0), "of 0 kinds"));
  CHECK(contains(refusal({0, 0, 0}, {1, 1, 1}, one, 3), "number 3, which is not among the 1"));
  CHECK(
      contains(refusal({0, 0, 0}, {1, 1, 1}, {block_name("a"), ""}, 0), "entry 1 of a palette has no Name"));
  CHECK(contains(error_of(read_schematic, litematic(compound("b", tag(3, "Size", big(1, 4))))), "no three"));
  CHECK(contains(error_of(read_schematic, litematic("")), "not all there, nor are Regions"));
}

TEST_CASE("structure: pos and state of a list -> voxels; of several palettes the first") {
  const std::string names =
      list_tag("palette", {block_name("air"), block_name("stone"), block_name("gold_block")});
  const std::vector<std::string> blocks{listed({0, 0, 0}, 0), listed({1, 2, 0}, 1), listed({0, 1, 3}, 2)};
  const std::string file = structure(names, blocks);
  CHECK(looks_like_schematic(file));
  const std::vector<GridVoxel> wanted{{1, 3, 2, *block_color("stone")},
                                      {0, 0, 1, *block_color("gold_block")}};
  CHECK(read_voxels(read_schematic, file) == wanted);
  CHECK(accepted_lengths(read_schematic, file).empty());
  // Lists of a list are nameless: what follows the name "palette", twice.
  const std::string list = names.substr(3 + 7);
  const Source several = read_schematic(
      SharedBytes::own(structure(tag(9, "palettes", "\x09" + big(2, 4) + list + list), blocks)), {}, {});
  CHECK(notes_of(several) == Notes{"of its 2 palettes the first is shown"});
  CHECK(std::get<std::unique_ptr<VoxelGrid>>(several)->size() == std::array<std::int32_t, 3>{2, 4, 3});
  const auto refusal = [&](const std::string& block) {
    return error_of(read_schematic, structure(names, {listed({0, 0, 0}, 1), block}));
  };
  CHECK(contains(refusal(listed({0, 3, 0}, 1)), "block 1 of the list is not within the size"));
  CHECK(contains(refusal(listed({0, 0, -1}, 1)), "not within"));
  CHECK(contains(refusal(listed({0, 0, 0}, 3)), "number 3, which is not among the 3"));
  CHECK(contains(refusal(tag(3, "state", big(1, 4))), "not within"));
  CHECK(contains(refusal(ints("pos", {0, 0, 0}, true)), "not among the 3"));
  CHECK(contains(refusal(ints("pos", {0, 0}, true)), "no three numbers"));
  CHECK(contains(error_of(read_schematic, structure(names, {listed({0, 0, 0}, 0)})), "nothing but air"));
  CHECK(contains(error_of(read_schematic, compound("", ints("size", {1, 4097, 1}, true))), "size is 4097"));
  const std::string many =
      tag(9, "palette", "\x0A" + big(INT32_MAX, 4) + block_name("stone") + std::string(1, '\0'));
  CHECK(contains(error_of(read_schematic, compound("", many)), "entry 1 of a palette has no Name"));
  CHECK(contains(error_of(read_schematic, compound("", tag(9, "palette", "\x03" + big(1, 4) + "name"))),
                 "no Name"));
}

TEST_CASE("octomap: occupied leaves of every level -> cubes") {
  // Down to a node of four voxels a side: octant 0 a cube of two, 1 free, 2 a node whose octant 5 is one voxel.
  const std::string binary =
      little(0xC000, 2) + repeated(little(3, 2), 13) + little(0x36, 2) + little(0x840, 2);
  const std::string file = octomap(binary, true);
  CHECK(looks_like_octomap(file));
  auto voxels = read_voxels(read_octomap, file);
  REQUIRE(voxels.size() == 9);
  CHECK(voxels[7] == GridVoxel{1, 1, 1, {}});
  CHECK(voxels[8] == GridVoxel{1, 2, 1, {}});
  CHECK(accepted_lengths(read_octomap, file).empty());
  // The same with log-odds, and with colours.
  const auto full = [](const std::string& blue, const std::string& red) {
    return map_node(-1, 0x80, blue) + repeated(map_node(-1, 1, blue), 13) + map_node(-1, 7, blue) +
           map_node(0, 0, blue) + map_node(-0.001F, 0, red) + map_node(-1, 0x28, blue) +
           map_node(std::bit_cast<float>(0x7FC00000U), 0, blue) + map_node(3.5F, 0, red);
  };
  for (const char* const id : {"OcTree", "1", "OcTreeStamped"}) {
    CHECK(read_voxels(read_octomap, octomap(full("", ""), false, id)) == voxels);
  }
  for (GridVoxel& voxel : voxels) {
    voxel.color = {0, 1, 255};
  }
  voxels[8].color = {255, 2, 3};
  const std::string colored =
      octomap(full(std::string("\0\x01\xff", 3), "\xff\x02\x03"), false, "ColorOcTree");
  CHECK(read_voxels(read_octomap, colored) == voxels);
  CHECK(accepted_lengths(read_octomap, colored).empty());
}

TEST_CASE("octomap: damage -> a sentence; large cubes and deep nodes -> no long or deep nothing") {
  const auto binary = [](const std::string& nodes) { return error_of(read_octomap, octomap(nodes, true)); };
  CHECK(contains(error_of(read_octomap, "# Octree"), "it does not begin with \"# Octomap OcTree file\""));
  CHECK(contains(error_of(read_octomap, "# Octomap OcTree file\nid OcTree\n"), "no line 'data'"));
  CHECK(contains(error_of(read_octomap, octomap("", false, "RoughOcTree")), "of class 'RoughOcTree'"));
  CHECK(contains(binary(""), "no occupied leaf"));
  CHECK(contains(binary(little(0x5555, 2)), "no occupied leaf"));
  CHECK(contains(binary(little(2, 2)), "35184372088832 voxels and 32768 long"));
  CHECK(contains(binary(repeated(little(3, 2), 5) + little(2, 2)), "1073741824 voxels and 1024 long"));
  CHECK(contains(binary(little(0xC003, 2) + repeated(repeated(little(3, 2), 14) + little(2, 2), 2)),
                 "32769 long"));
  CHECK(contains(binary(repeated(little(3, 2), 100000)), "below the last of 16 levels"));
  CHECK(contains(error_of(read_octomap, octomap(repeated(map_node(0, 1), 100000), false)), "below the last"));
  CHECK(contains(error_of(read_octomap, octomap(map_node(0, 0), false)), "65536 long"));
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
    CHECK(looks_like_npy(file));
    CHECK(read_voxels(read_npy, file).size() == 4);
    CHECK(accepted_lengths(read_npy, file).empty());
  }
  CHECK(contains(error_of(read_npy, zip({{"a.npy", scalar}}, true)), "two dimensions"));
  CHECK(contains(error_of(read_npy, npy("<f4", "(3)", std::string(12, '\0'))), "3 numbers"));
  CHECK(contains(error_of(read_npy, scalar), "an array of one number is"));
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

static Source read_archive(const SharedBytes& file, const ReadOptions&, const Progress& progress) {
  return read_any({"/tmp/a.zip"}, file, progress);
}

TEST_CASE("zip: one scene among other files -> the scene; none or several -> a sentence") {
  const std::string array = npy("|u1", "(1, 2, 2)", "\x01\x01\x01\x01");
  const std::string cloud = "1 2 3\n4 5 6\n";
  for (const bool deflate : {false, true}) {
    const std::string file = zip({{"a/", ""},
                                  {"__MACOSX/._b.ply", "junk"},
                                  {"a/.DS_Store", "junk"},
                                  {"a/LICENSE.txt", "all yours"},
                                  {"a/picture.png", "\x89PNG"},
                                  {"a/b.npy", array}},
                                 deflate);
    CHECK(read_voxels(read_archive, file) == read_voxels(read_npy, array));
    CHECK(read_points(read_archive, zip({{"a.txt", cloud}}, deflate)).size() == 2);
    for (std::size_t length = 30; length < file.size(); ++length) {
      CHECK_FALSE(error_of(read_archive, file.substr(0, length)).empty());
    }
  }
  CHECK(error_of(read_archive, zip({{"a.png", "x"}}, false)) == "the archive holds no scene");
  CHECK(contains(error_of(read_archive, zip({{"a.xyz", cloud}, {"b/c.npy", array}}, true)),
                 "2 scenes, 'a.xyz' and 'b/c.npy'"));
  CHECK(
      contains(error_of(read_archive, zip({{"b.zip", zip({{"a.txt", cloud}}, false)}}, false)), "no scene"));
  CHECK(contains(error_of(read_archive, zip({{"a.xyz", "1 2\n"}}, false)), "line 1"));
  // Another byte than the check sum is of; a program in front, and a comment that holds the mark of an end.
  const std::string one = zip({{"a.xyz", cloud}}, false);
  std::string changed = one;
  changed[one.find(cloud)] = '7';
  CHECK(contains(error_of(read_archive, changed), "'a.xyz' is damaged: the directory has another check sum"));
  CHECK(error_of(read_archive, "#!/bin/sh\n" + one).empty());
  const std::string comment = "about PK\x05\x06 and how it ends.";
  CHECK(error_of(read_archive, one.substr(0, one.size() - 2) + little(comment.size(), 2) + comment).empty());
}

TEST_CASE("asc: an ESRI grid -> a landscape; holes where there is no data") {
  const std::string head = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n";
  CHECK(looks_like_height_grid(head));
  const auto whole = read_voxels(read_height_grid, head + "1 2 3\n4 5 6\n");
  const auto holed = read_voxels(read_height_grid, head + "1 2 3\n4 5 -9999");
  CHECK(holed.size() < whole.size());
  CHECK(read_voxels(read_height_grid, "ncols 3\nnrows 2\nNODATA_value nan\n1 2 3\n4 5 nan") == holed);
  CHECK(contains(error_of(read_height_grid, head + "1 2 3 4 5"), "room for 5"));
  CHECK(contains(error_of(read_height_grid, head + "1 2 3 4 5 6 7"), "line 7: '7' comes after"));
  CHECK(contains(error_of(read_height_grid, head + "1 2 x 4 5 6"), "line 7: 'x'"));
  CHECK(contains(error_of(read_height_grid, "ncols 4000000000\nnrows 4000000000\n1 2"), "room for"));
  CHECK(contains(error_of(read_height_grid, "ncols -3\nnrows 2\n1"), "line 1"));
  CHECK(contains(error_of(read_height_grid, head + "-9999 -9999 -9999 -9999 -9999 -9999"), "no point"));
}

TEST_CASE("qb: packed or not -> the same voxels") {
  // Slice z 0: red, nothing; slice z 1: twice green.
  const std::string plain = qb(false, kRedVoxel + little(0, 4) + kGreenVoxel + kGreenVoxel);
  const std::string packed = qb(true, kRedVoxel + little(0, 4) + little(6, 4) + little(2, 4) + little(2, 4) +
                                          kGreenVoxel + little(6, 4));
  const auto voxels = read_voxels(read_qb, plain);
  REQUIRE(voxels.size() == 3);
  CHECK(voxels[0].color == Rgb{255, 0, 0});
  CHECK(voxels[0] == GridVoxel{0, 1, 0, {255, 0, 0}});  // z comes towards the eye
  CHECK(has_voxel(voxels, {1, 0, 0, {0, 255, 0}}));
  CHECK(read_voxels(read_qb, packed) == voxels);
  CHECK(read_voxels(read_qb, qb(false, kRedVoxel + little(0, 4) + kGreenVoxel + kGreenVoxel, -1000000)) ==
        voxels);
  CHECK(accepted_lengths(read_qb, plain).empty());
  CHECK(accepted_lengths(read_qb, packed).empty());
  CHECK(contains(error_of(read_qb, qb(true, little(2, 4) + little(0xFFFFFFFF, 4) + kRedVoxel)),
                 "more than its 2"));
  CHECK(contains(error_of(read_qb, qb(false, little(0, 16))), "no voxels"));
  CHECK(contains(error_of(read_qb, "text"), "1, 1, 0, 0"));
}

TEST_CASE(
    "qb: a left-handed z axis -> goes away from the eye; Goxel's, which says right-handed, too, with a "
    "note") {
  const std::string voxels = kRedVoxel + little(0, 12);
  CHECK(read_voxels(read_qb, qb(false, voxels)) == std::vector<GridVoxel>{{0, 1, 0, {255, 0, 0}}});
  CHECK(read_voxels(read_qb, qb(false, voxels, 0, true)) == std::vector<GridVoxel>{{0, 0, 0, {255, 0, 0}}});
  CHECK(notes_of_file(read_qb, qb(false, voxels, 0, true)).empty());
  for (const std::string name : {"Layer.1", "background"}) {
    const std::string file = qb(false, voxels, 0, false, name);
    CHECK(read_voxels(read_qb, file) == std::vector<GridVoxel>{{0, 0, 0, {255, 0, 0}}});
    REQUIRE(notes_of_file(read_qb, file).size() == 1);
    CHECK(contains(notes_of_file(read_qb, file)[0], "Goxel"));
  }
  CHECK(
      notes_of_file(read_qb, qb(true, kRedVoxel + little(6, 4) + little(6, 4), 0, false, "Layer.1")).empty());
}

TEST_CASE("grid: as blocks -> the same voxels, materials and all; what is solid in a few cubes") {
  const TemporaryFolder folder;
  const auto open = [&](const std::vector<std::string>& matrices) {
    SceneArguments arguments;
    arguments.scene = folder.write("a.qb", qb(matrices));
    return open_scene(arguments);
  };
  using Voxels = std::map<std::array<std::int32_t, 3>, std::uint8_t>;
  const auto both = [](const SceneSource& source, int* calls) {
    std::array<Voxels, 2> all;
    source.stream([&](auto x, auto y, auto z, std::uint8_t m) { all[0][{x, y, z}] = m; }, {});
    source.stream_blocks(
        [&](const Vec3i& corner, int level, std::uint8_t m) {
          ++*calls;
          for_voxels(corner, level, [&](auto x, auto y, auto z) { all[1][{x, y, z}] = m; });
        },
        {});
    CHECK(all[0] == all[1]);
    return all[0].size();
  };
  int calls = 0;
  CHECK(both(*open({qb_matrix({8, 12, 16}, repeated(little(0xFF0000FF, 4), 8 * 12 * 16))}), &calls) ==
        8 * 12 * 16);
  CHECK(calls == 2 * 3 * 4);
  SplitMix64 random(5);
  std::vector<std::string> layers;  // each over the one before
  for (int layer = 0; layer < 2; ++layer) {
    std::string mixed;
    for (int i = 0; i < 9 * 7 * 10; ++i) {
      mixed += little(std::array{0U, 0xFF0000FFU, 0xFF00FF00U, 0xFFFF0000U}[random.next() % 4], 4);
    }
    layers.push_back(qb_matrix({9, 7, 10}, mixed));
  }
  const std::size_t solid = both(*open(layers), &calls);
  CHECK(solid > 500);
  CHECK(solid < 630);
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

TEST_CASE("qbcl: matrices of models and compounds -> voxels with y up; what is hidden -> none") {
  // Columns of y: red, nothing, green; three times blue.
  const std::string columns = little(3, 2) + kRedVoxel + little(0, 4) + kGreenVoxel + little(2, 2) +
                              std::string("\x03\0\0\x02", 4) + std::string("\0\0\xff\x01", 4);
  const std::string file = qbcl(qbcl_node(0, qbcl_matrix(-5, columns)));
  CHECK(find_reader("", file) != nullptr);
  const std::vector<GridVoxel> one{{0, 0, 0, {255, 0, 0}},
                                   {0, 0, 2, {0, 255, 0}},
                                   {1, 0, 0, {0, 0, 255}},
                                   {1, 0, 1, {0, 0, 255}},
                                   {1, 0, 2, {0, 0, 255}}};
  CHECK(read_voxels(read_qbcl, file) == one);
  CHECK(accepted_lengths(read_qbcl, file).empty());
  const std::string matrix = qbcl_node(0, qbcl_matrix(0, columns));
  const std::string far = qbcl_matrix(100, columns);
  CHECK(read_voxels(read_qbcl, qbcl(qbcl_node(1, qbcl_model(3) + qbcl_node(0, far, false) +
                                                     qbcl_node(1, qbcl_model(1) + qbcl_node(0, far), false) +
                                                     matrix))) == one);
  CHECK(read_voxels(read_qbcl,
                    qbcl(qbcl_node(2, qbcl_matrix(0, columns) + little(1, 4) + qbcl_node(0, far)))) == one);
  CHECK(read_voxels(read_qbcl, qbcl(qbcl_node(1, qbcl_model(2) + matrix + qbcl_node(0, far)))).size() == 10);
}

TEST_CASE("qbcl: damage -> a sentence, and nothing is believed") {
  const auto one = [](const std::string& columns) { return qbcl(qbcl_node(0, qbcl_matrix(0, columns))); };
  CHECK(contains(error_of(read_qbcl, "text"), "QBCL"));
  CHECK(contains(error_of(read_qbcl, "QBCL" + little(0, 4) + little(3, 4)), "version 3"));
  CHECK(contains(error_of(read_qbcl, one(little(1, 2) + std::string("\x04\0\0\x02", 4))), "unpacked"));
  CHECK(contains(error_of(read_qbcl, one(little(2, 2) + std::string("\x04\0\0\x02\x01\x01\x01\x01", 8))),
                 "more than its 3"));
  // With nothing behind it, it is no run.
  CHECK(read_voxels(read_qbcl, one(little(1, 2) + std::string("\x04\0\0\x02\0\0", 6))) ==
        std::vector<GridVoxel>{{0, 0, 0, {4, 0, 0}}});
  CHECK(contains(error_of(read_qbcl, one(std::string(4, '\0'))), "no voxels"));
  CHECK(contains(error_of(read_qbcl, one(std::string(60, '\0'))), "limit of 53 bytes"));
  CHECK(contains(error_of(read_qbcl, qbcl(qbcl_node(3, ""))), "kind of node 3"));
  CHECK(contains(error_of(read_qbcl, qbcl(qbcl_node(1, qbcl_model(0xFFFFFFFF)))), "the header"));
  CHECK(contains(error_of(read_qbcl, qbcl(qbcl_node(0, little(5000, 4)))), "5000"));
  CHECK(
      contains(error_of(read_qbcl, "QBCL" + little(0, 4) + little(2, 4) + std::string(8, '\xff')), "bytes"));
  CHECK(contains(error_of(read_qbcl, qbcl(repeated(qbcl_node(1, qbcl_model(1)), 100000))), "the header"));
}

TEST_CASE("kv6: columns -> voxels with z up; damage -> a sentence") {
  const std::string file = kv6(3, {2, 1});
  CHECK(find_reader("", file) != nullptr);
  CHECK(read_voxels(read_kv6, file) ==
        std::vector<GridVoxel>{{0, 0, 299, {3, 2, 1}}, {0, 0, 0, {6, 5, 4}}, {1, 0, 292, {9, 8, 7}}});
  CHECK(accepted_lengths(read_kv6, file).empty());
  CHECK(contains(error_of(read_kv6, kv6(3, {2, 2})), "the voxels"));
  CHECK(contains(error_of(read_kv6, kv6(3, {2, 0})), "3 of them, and the columns have 2"));
  CHECK(contains(error_of(read_kv6, kv6(0xFFFFFFFF, {2, 1})), "34359738360"));
  CHECK(contains(error_of(read_kv6, kvx()), "Kvxl"));
  std::string changed = file;
  changed[13] = '\0';  // 44 voxels deep
  CHECK(contains(error_of(read_kv6, changed), "column 0,0 lies at 299"));
  changed[4] = '\0';
  CHECK(contains(error_of(read_kv6, changed), "a side of 0"));
}

TEST_CASE("vxl: spans -> coloured voxels, earth between them, solid to the bottom") {
  const std::string red = std::string("\0\0\xff\x80", 4);
  const std::string blue = std::string("\xff\0\0\x80", 4);
  // Red at 10, earth, blue at 13 under it; air; blue at 60, earth.
  const std::string bridge = span(3, 10, 10, 0, red + blue) + span(0, 60, 60, 14, blue);
  const std::string plain = span(0, 63, 63, 0, red);
  const auto voxels = read_voxels(read_vxl, vxl({bridge, plain}));
  const Rgb earth{103, 64, 40};
  CHECK((find_reader("", vxl({plain}))->read == read_vxl));
  REQUIRE(voxels.size() == 9);
  for (const GridVoxel& voxel : std::vector<GridVoxel>{{0, 0, 53, {255, 0, 0}},
                                                       {0, 0, 52, earth},
                                                       {0, 0, 51, earth},
                                                       {0, 0, 50, {0, 0, 255}},
                                                       {0, 0, 3, {0, 0, 255}},
                                                       {0, 0, 2, earth},
                                                       {0, 0, 0, earth},
                                                       {1, 0, 0, {255, 0, 0}}}) {
    CHECK(has_voxel(voxels, voxel));
  }
  CHECK(accepted_lengths(read_vxl, vxl({bridge, plain})).empty());
  // One that reaches below 64 makes all 256 deep.
  CHECK(read_voxels(read_vxl, vxl({plain, span(0, 64, 64, 0, red)})).size() == 193 + 192);
  CHECK(notes_of_file(read_vxl, vxl({plain})).empty());
  CHECK(contains(notes_of_file(read_vxl, vxl({plain}) + "more").at(0), "4 bytes behind the last of 1 x 1"));
}

TEST_CASE("vxl: without a header -> 512 x 512 columns, the first row farthest; damage -> a sentence") {
  std::string map;
  for (int i = 0; i < 512 * 512; ++i) {
    map += span(0, 63, 63, 0, i == 513 ? "\x01\x02\x03\x80" : "\x01\x01\x01\x80");
  }
  const auto voxels = read_voxels(read_vxl, map);
  CHECK(voxels.size() == 512 * 512);
  CHECK(has_voxel(voxels, {1, 510, 0, {3, 2, 1}}));
  CHECK(contains(error_of(read_vxl, map.substr(0, map.size() - 1)), "the columns"));
  const std::string color(4, '\x01');
  for (const std::string& column : {span(0, 64, 62, 0, ""), span(1, 60, 60, 0, color),
                                    span(2, 10, 10, 0, color) + span(0, 20, 20, 10, color),
                                    span(3, 10, 10, 0, color + color) + span(0, 20, 20, 11, color),
                                    span(2, 10, 10, 0, color) + span(0, 20, 20, 21, color)}) {
    CHECK(contains(error_of(read_vxl, vxl({column})), "column 0,0"));
  }
  CHECK(contains(error_of(read_vxl, vxl({})), "a side of 0"));
  CHECK(contains(error_of(read_vxl, "Voxel Animation"), "Command & Conquer"));
}

TEST_CASE("gox: layers -> voxels, the later over the earlier; copies moved; hidden ones none") {
  const std::string green = std::string("\0\xff\0\x7f", 4);
  const std::string thin = std::string("\0\0\xff\x7e", 4);
  const std::string blocks = gox_block(kRedVoxel, green) + gox_block(green, thin) + gox_chunk("MATE", "any");
  const std::string visible = gox_entry("visible", std::string(1, '\1'));
  const std::string hidden = gox_entry("visible", std::string(1, '\0'));
  const std::string first = gox_layer(gox_place(0, 0), gox_entry("id", little(7, 4)) + visible);
  const std::string file = gox(blocks + first);
  CHECK(find_reader("", file) != nullptr);
  const std::vector<GridVoxel> one{{3, 0, 0, {0, 255, 0}}, {0, 2, 3, {255, 0, 0}}};
  CHECK(read_voxels(read_gox, file) == one);
  CHECK(accepted_lengths(read_gox, file).empty());
  CHECK(read_voxels(read_gox, gox(blocks + first, 1)) == one);
  CHECK(read_voxels(read_gox, gox(blocks + first + gox_layer(gox_place(1, -100), hidden))) == one);
  CHECK(read_voxels(read_gox, gox(blocks + first + gox_layer(gox_place(1, 0), ""))).back() ==
        GridVoxel{0, 2, 3, {0, 255, 0}});
  CHECK_THROWS_WITH_AS(read_voxels(read_gox, gox(blocks + gox_layer(gox_place(0, 0), hidden))),
                       "no layer of the file is visible", InputError);
  const auto copy = [&](const std::string& mat, unsigned id, unsigned of) {
    return gox_layer("", mat + gox_entry("id", little(id, 4)) + gox_entry("base_id", little(of, 4)));
  };
  // A copy of what is hidden is seen, and so is a copy of a copy.
  const std::string base = gox_layer(gox_place(0, 0), gox_entry("id", little(7, 4)) + hidden);
  CHECK(read_voxels(read_gox, gox(blocks + base + copy(gox_mat(1, 5), 8, 7))) == one);
  CHECK(has_voxel(
      read_voxels(read_gox, gox(blocks + first + copy(gox_mat(1, -5), 8, 7) + copy(gox_mat(1, -5), 9, 8))),
      {10, 2, 3, {255, 0, 0}}));
  CHECK(notes_of_file(read_gox, file).empty());
  for (const std::string& layer : {copy(gox_mat(2, 0), 8, 7), copy(gox_mat(1, 0.5F), 8, 7), copy("", 8, 8),
                                   copy("", 8, 9), gox_layer("", gox_entry("shape", "cube"))}) {
    CHECK(read_voxels(read_gox, gox(blocks + first + layer)) == one);
    CHECK(contains(notes_of_file(read_gox, gox(blocks + first + layer)).at(0), "1 layer is not drawn"));
  }
}

TEST_CASE("gox: damage -> a sentence with its place") {
  const auto scene = [&](const std::string& blocks, const std::string& places) {
    return error_of(read_gox, gox(blocks + gox_layer(places, "")));
  };
  CHECK(contains(error_of(read_gox, "text"), "GOX"));
  CHECK(contains(error_of(read_gox, gox("", 3)), "version 3"));
  CHECK(contains(scene("", ""), "no voxels"));
  CHECK(contains(scene(gox_block(kRedVoxel, kRedVoxel), gox_place(1, 0)), "block 1 is not among the 1"));
  CHECK(contains(scene(gox_block(kRedVoxel, kRedVoxel, 32), gox_place(0, 0)),
                 "byte offset 20: the block is no picture of 64 x 64"));
  CHECK(contains(scene(gox_chunk("BL16", "no"), gox_place(0, 0)), "no picture"));
  std::string damaged = gox_block(kRedVoxel, kRedVoxel);
  damaged[damaged.find("IDAT") + 10] = '\x7f';
  CHECK(contains(scene(damaged, gox_place(0, 0)), "the block is damaged"));
  CHECK(contains(scene(gox_block(kRedVoxel, kRedVoxel), gox_place(0, INT32_MIN) + gox_place(0, INT32_MAX)),
                 "4294967"));
  CHECK(contains(error_of(read_gox, gox(gox_chunk("LAYR", little(0xFFFFFFFF, 4)))), "85899345900"));
  CHECK(contains(error_of(read_gox, "GOX " + little(2, 4) + "LAYR" + little(0xFFFFFFFF, 4)), "4294967295"));
}
