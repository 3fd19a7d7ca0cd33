// Files that programs really write and that are read wrongly easily: what a file says is what its source holds, and what
// it does not hold is noted.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "readers/formats.h"
#include "readers/read_any.h"
#include "readers/vox_parts.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"
#include "support/run_command.h"

using namespace thimble::tools;
using namespace thimble::tools::test;
using thimble::tests::deflated;
using thimble::tests::npy;
using thimble::tests::TemporaryFolder;
using thimble::tests::vox_chunk;
using thimble::tests::vox_file;

namespace {

using Colors = std::vector<Rgb>;

constexpr Rgb kRed{255, 0, 0};
constexpr Rgb kGreen{0, 255, 0};
constexpr Rgb kBlue{0, 0, 255};

Source array_of(ArrayAs as, const std::string& text) {
  return read_npy(SharedBytes::own(text), {"", {}, as}, {});
}

Colors colors_of(const Source& source) {
  Colors colors;
  const auto& cloud = *std::get<std::unique_ptr<PointCloud>>(source);
  if (cloud.has_color()) {
    cloud.for_each([&](const CloudPoint& point) { colors.push_back(point.color); });
  }
  return colors;
}

std::size_t points_of(const Source& source) {
  std::size_t count = 0;
  std::get<std::unique_ptr<PointCloud>>(source)->for_each([&](const CloudPoint&) { ++count; });
  return count;
}

template <class Number>
std::string numbers(const std::vector<Number>& values) {
  std::string bytes(values.size() * sizeof(Number), 0);
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

}  // namespace

TEST_CASE("colours: what full is follows the file's highest, noted where it is a guess, or --colors") {
  const auto read = [](FormatReader* reader, const std::string& text, std::uint16_t full) {
    return reader(SharedBytes::own(text), {"", {}, ArrayAs::kByShape, full}, {});
  };
  const auto floats = [](float red) { return npy("<f4", "(1, 6)", numbers<float>({1, 2, 3, red, 0, 0})); };
  const std::string fields =
      "FIELDS x y z r g b\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n";
  const std::string floats_of_ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "property float red\nproperty float green\nproperty float blue\nend_header\n";
  struct Row {
    FormatReader* reader;
    std::string file;
    bool is_noted;
    std::uint8_t guessed, of_bytes;  ///< the red that is read without --colors, and with --colors 255
  };
  const std::vector<Row> rows{{read_xyz, "1 2 3 1 0 0\n", true, 255, 1},
                              {read_xyz, "1 2 3 0.5 0 0\n", false, 128, 1},
                              {read_xyz, "1 2 3 51 0 0\n", false, 51, 51},
                              {read_npy, floats(1), true, 255, 1},
                              {read_npy, floats(51), false, 51, 51},
                              {read_pcd, fields + "1 2 3 1 0 0\n", true, 255, 1},
                              {read_pcd, fields + "1 2 3 257 0 0\n", true, 1, 255},
                              {read_ply, floats_of_ply + "1 2 3 1 0 0\n", true, 255, 1},
                              {read_ply, floats_of_ply + "1 2 3 51 0 0\n", false, 51, 51}};
  for (const Row& row : rows) {
    CAPTURE(row.file);
    const Source guessed = read(row.reader, row.file, 0);
    CHECK(notes_hold(guessed, "--colors") == row.is_noted);
    CHECK(colors_of(guessed) == Colors{{row.guessed, 0, 0}});
    const Source stated = read(row.reader, row.file, 255);
    CHECK_FALSE(notes_hold(stated, "--colors"));
    CHECK(colors_of(stated) == Colors{{row.of_bytes, 0, 0}});
  }
  const std::string head = "x,y,z,r,g,b\n";
  CHECK(notes_hold(read(read_xyz, head + "1,2,3,1.01,0,0\n", 0),
                   "no color is above 2: full is taken to be 255"));
  CHECK(notes_hold(read(read_ply, floats_of_ply + "1 2 3 1e30 0 0\n", 0), "below 0, above 65535"));
  CHECK(colors_of(read(read_xyz, "1 2 3 0.5 300 7\n", 0)).empty());  // no scale that whole numbers have
  CHECK(colors_of(read(read_xyz, "1 2 3 0 300 0\n", 300)) == Colors{{0, 255, 0}});

  const std::string corners = "COFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n3 0 1 2\n";
  const Source mesh = read(read_off, corners, 0);
  CHECK(std::get<TriangleMesh>(mesh).colors == Colors{kRed, kGreen, kBlue});
  CHECK(notes_hold(mesh, "--colors"));
  CHECK(std::get<TriangleMesh>(read(read_off, corners, 255)).colors.front() == Rgb{1, 0, 0});

  const auto vertices = [](const std::string& red) {
    return "v 0 0 0 " + red + " 0 0\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n";
  };
  CHECK(std::get<TriangleMesh>(read(read_obj, vertices("1"), 0)).colors.front() == kRed);
  CHECK(notes_hold(read(read_obj, vertices("1"), 0), "--colors"));
  CHECK(std::get<TriangleMesh>(read(read_obj, vertices("0.5"), 0)).colors.front() == Rgb{128, 0, 0});
  CHECK(std::get<TriangleMesh>(read(read_obj, vertices("51"), 0)).colors.front() == Rgb{51, 0, 0});
  CHECK(std::get<TriangleMesh>(read(read_obj, vertices("1"), 255)).colors.front() == Rgb{1, 0, 0});

  CHECK_THROWS_WITH_AS(read_any({"a.stl", {}, ArrayAs::kByShape, 255}, SharedBytes::own("solid\n")),
                       doctest::Contains("of another kind (STL mesh)"), InputError);
}

TEST_CASE("npy: N x 3 to N x 9 numbers of any type -> points, heights only by --as-heights") {
  const std::string indices = npy("<i8", "(3, 3)", numbers<std::int64_t>({1, 2, 3, 2, 2, 3, 5, 5, 5}));
  CHECK(points_of(source_of(read_npy, indices)) == 3);
  CHECK(notes_hold(source_of(read_npy, indices), "voxels by --as-voxels"));
  CHECK(notes_of(array_of(ArrayAs::kPoints, indices)).empty());
  for (int columns = 3; columns <= 9; ++columns) {
    CAPTURE(columns);
    const std::string rows = numbers(std::vector<float>(static_cast<std::size_t>(4 * columns), 0.25F));
    const std::string file = npy("<f4", "(4, " + std::to_string(columns) + ")", rows);
    const Source points = source_of(read_npy, file);
    CHECK(points_of(points) == 4);
    CHECK(colors_of(points).empty() == (columns < 6));
    CHECK(notes_hold(points, "columns") == (columns != 3 && columns != 6));
    CHECK(points_of(array_of(ArrayAs::kPoints, file)) == 4);
    CHECK(std::holds_alternative<std::unique_ptr<VoxelGrid>>(array_of(ArrayAs::kHeights, file)) !=
          std::holds_alternative<std::unique_ptr<PointCloud>>(array_of(ArrayAs::kHeights, file)));
  }
  const std::string heights = npy("<f4", "(4, 10)", numbers(std::vector<float>(40, 1)));
  CHECK_THROWS_AS(array_of(ArrayAs::kPoints, heights), InputError);
}

TEST_CASE("npy: numbers below 0 in X x Y x Z -> noted, for solid is what is 0.5 or more") {
  const auto file = [](float first) { return npy("<f4", "(1, 1, 2)", numbers<float>({first, 1})); };
  CHECK(notes_hold(source_of(read_npy, file(-1)), "numbers below 0, as distances to a surface are"));
  CHECK(notes_of(source_of(read_npy, file(0))).empty());
}

TEST_CASE("npy: halves -> read by every kind of number; 65 dimensions -> refused in a short sentence") {
  // 1, 2^-24, the greatest, -2, infinite: five points, of which one is left out.
  const std::vector<std::uint16_t> halves{0x3C00, 0,      0, 0x0001, 0,      0, 0x7BFF, 0,
                                          0,      0xC000, 0, 0,      0x7C00, 0, 0};
  const Source source = source_of(read_npy, npy("<f2", "(5, 3)", numbers(halves)));
  std::vector<double> x;
  std::get<std::unique_ptr<PointCloud>>(source)->for_each(
      [&](const CloudPoint& point) { x.push_back(point.x); });
  CHECK(x == std::vector<double>{1, std::ldexp(1.0, -24), 65504, -2});
  CHECK(notes_hold(source, "1 point is not finite and is left out"));
  const std::string said =
      error_of(read_npy, npy("|u1", "(1" + thimble::tests::repeated(", 1", 64) + ")", "x"));
  CHECK(contains(said, "more than 64 dimensions"));
  CHECK(said.size() < 300);
}

TEST_CASE(
    "xyz: columns without names -> the colour is where its kind of file has it, and noted where that is a "
    "guess") {
  const Source seven = source_of(read_xyz, "0 0 0 17 255 0 0\n1 0 0 18 0 255 0\n");
  CHECK(colors_of(seven) == Colors{kRed, kGreen});
  CHECK(notes_hold(seven, "5 to 7 for colors"));
  const Source nine = source_of(read_xyz, "0 0 0 0 0 1 255 0 0\n1 0 0 0 -1 0 0 0 255\n");
  CHECK(colors_of(nine) == Colors{kRed, kBlue});
  const Source normals = source_of(read_xyz, "0 0 0 0.5 0 -1\n1 0 0 0 1 0\n");
  CHECK(colors_of(normals).empty());
  CHECK(notes_hold(normals, "none for colors"));
  CHECK(colors_of(source_of(read_xyz, "x,y,z,r,g,b\n0,0,0,1,0,0\n1,1,1,0,1,0\n")) == Colors{kRed, kGreen});
  CHECK(colors_of(source_of(read_xyz, "x,y,z,r,g,b\n0,0,0,1,0,0\n1,1,1,0,2,0\n")) ==
        Colors{{1, 0, 0}, {0, 2, 0}});
}

TEST_CASE("xyz: a molecule -> its atoms; points that are not finite -> left out and counted") {
  for (const char* comment : {"water", "", "3 atoms of it"}) {
    CAPTURE(comment);
    const Source water =
        source_of(read_xyz, "3\n" + std::string(comment) + "\nO 0 0 0.1\nH 0 0.7 -0.4\nH 0 -0.7 -0.4\n");
    CHECK(points_of(water) == 3);
    CHECK(notes_hold(water, "molecule"));
  }
  const Source holes = source_of(read_xyz, "0 0 0\nnan 1 1\n1 inf 1\n2 2 2\n");
  CHECK(points_of(holes) == 2);
  CHECK(notes_hold(holes, "2 points are not finite"));
  CHECK(contains(error_of(read_xyz, "nan 0 0\n"), "no point of the file is finite"));
}

TEST_CASE("off: colours of faces, and a count that stands right behind the keyword -> read") {
  const std::string square = " 4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const TriangleMesh bytes =
      read_mesh(read_off, "OFF" + square + "4 0 1 2 3 255 0 0\n3 0 1 2 0 0 255 128\n3 0 2 3\n");
  CHECK(bytes.face_colors == Colors{kRed, kRed, kBlue, Rgb{}});
  CHECK(read_mesh(read_off, "OFF" + square + "4 0 1 2 3\n3 0 1 2 0.0 0.0 1.0\n3 0 2 3 7\n").face_colors ==
        Colors{Rgb{}, Rgb{}, kBlue, Rgb{}});
  const Source listed = source_of(read_off, "OFF" + square + "4 0 1 2 3\n3 0 1 2 9\n3 0 2 3\n");
  CHECK(std::get<TriangleMesh>(listed).face_colors.empty());
  CHECK(notes_hold(listed, "places in a list that no file brings along"));
  CHECK(read_mesh(read_off, "OFF4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n").triangles.size() == 2);
  CHECK(find_reader("x.bin", "OFF4 1 0\n") != nullptr);
}

TEST_CASE("ply: points that are not finite, Gaussian splats, a picture without places -> as they are meant") {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const Source holes = source_of(read_ply, head + "end_header\n0 0 0\nnan 0 0\n1 1 1\n");
  CHECK(points_of(holes) == 2);
  CHECK(notes_hold(holes, "1 point is not finite"));
  const Source splats = source_of(
      read_ply,
      head + "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nproperty float opacity\n" +
          "end_header\n0 0 0 1.7725 -1.7725 0 9\n1 0 0 0 0 0 -9\n2 0 0 -9 -9 9 0\n");
  CHECK(colors_of(splats) == Colors{{255, 0, 128}, kBlue});
  CHECK(notes_hold(splats, "Gaussian splats are drawn as points; 1 of 3 are nearly clear"));
  const std::string face =
      "element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  CHECK(notes_of(source_of(read_ply, head + face)).empty());
  CHECK(notes_hold(source_of(read_ply, head + "comment TextureFile a b.jpg\n" + face),
                   "'a b.jpg' is not drawn"));
}

TEST_CASE(
    "stl: bytes say what is binary, not the first word; the count and the bytes may "
    "differ") {
  std::string binary = "solid exported by a program" + std::string(53, ' ') + std::string("\x01\0\0\0", 4);
  std::string triangle = numbers<float>({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + std::string(2, '\0');
  const Source tail = source_of(read_stl, binary + triangle + "xy");
  CHECK(std::get<TriangleMesh>(tail).triangles.size() == 1);
  CHECK(notes_hold(tail, "2 bytes behind the last of the 1 triangles"));
  CHECK(notes_hold(source_of(read_stl, binary + triangle + triangle), "50 bytes behind"));
  CHECK(contains(error_of(read_stl, binary), "counts 1 triangles, but the file has room for 0"));
  CHECK(contains(error_of(read_stl, std::string(84, '\0') + triangle), "counts no triangles, but 50 bytes"));
  triangle.back() = '\x80';
  CHECK(notes_hold(source_of(read_stl, binary + triangle), "1 triangle has attributes, which may be colors"));
  const std::string text =
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
      "0\nendloop\nendfacet\nendsolid\n";
  CHECK(read_mesh(read_stl, "\xEF\xBB\xBF" + text).triangles.size() == 1);
}

TEST_CASE(
    "ply: names in capitals, lines that hold more than the header says, text behind all -> read and noted") {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float X\nproperty float Y\nproperty float Z\n";
  const std::string faces = "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string wide = head + faces + "0 0 0 9\n1 0 0 9 9\n0 1 0\n3 0 1 2 7\n3 0 2 1\n";
  const Source mesh = source_of(read_ply, wide);
  CHECK(std::get<TriangleMesh>(mesh).triangles ==
        std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 1}});
  CHECK(notes_of(mesh) == Notes{"its lines hold more values than the header declares; those are not read"});
  CHECK(notes_hold(source_of(read_ply, wide + "made by a program\n"), "line 15: 'made' and what follows"));
  // Without a line each, the words count, and a list may take several lines.
  const Source words = source_of(read_ply, head + faces + "0 0 0 1 0 0\n0 1 0 3\n0 1 2 3 0 2 1\n");
  CHECK(std::get<TriangleMesh>(words).triangles == std::get<TriangleMesh>(mesh).triangles);
  CHECK(notes_of(words).empty());
  const Source points = source_of(read_ply, head + "end_header\n0 0 0 9\n1 0 0 9\n2 0 0 9\n");
  CHECK(points_of(points) == 3);
  CHECK(notes_hold(points, "more values than the header declares"));
}

TEST_CASE("ply: colours of faces -> theirs, where vertices and pictures have none") {
  const auto file = [](const std::string& of_vertices, const std::string& type, const std::string& body) {
    return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" +
           of_vertices + "element face 2\nproperty list uchar int vertex_indices\nproperty " + type +
           " red\nproperty " + type + " green\nproperty " + type + " blue\nend_header\n" + body;
  };
  const std::string places = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  CHECK(read_mesh(read_ply, file("", "uchar", places + "4 0 1 2 3 255 0 0\n3 0 1 2 0 0 255\n")).face_colors ==
        Colors{kRed, kRed, kBlue});
  CHECK(read_mesh(read_ply, file("", "float", places + "3 0 1 2 0 0.5 0\n3 0 1 2 1 0 0\n")).face_colors ==
        Colors{{0, 128, 0}, kRed});
  const std::string colored = "0 0 0 0 0 255\n1 0 0 0 0 255\n1 1 0 0 0 255\n0 1 0 0 0 255\n";
  const Source both =
      source_of(read_ply, file("property uchar red\nproperty uchar green\nproperty uchar blue\n", "uchar",
                               colored + "3 0 1 2 255 0 0\n3 0 1 2 255 0 0\n"));
  CHECK(std::get<TriangleMesh>(both).face_colors.empty());
  CHECK(std::get<TriangleMesh>(both).colors.front() == kBlue);
  CHECK(notes_hold(both, "the colors of its faces are not drawn, but those of its vertices"));
}

TEST_CASE("obj: lines, points, curves, and Tr without d -> noted") {
  const std::string face = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  CHECK(notes_of(source_of(read_obj, face)).empty());
  CHECK(notes_hold(source_of(read_obj, face + "l 1 2\np 1\ncurv 0 1 1 2\n"), "3 in all) are not drawn"));
  const TemporaryFolder folder;
  const auto notes = [&](const std::string& material) {
    folder.write("a.mtl", "newmtl a\nKd 1 0 0\n" + material);
    const std::string path = folder.write("a.obj", "mtllib a.mtl\nusemtl a\n" + face);
    return notes_of(read_obj(SharedBytes::own("mtllib a.mtl\nusemtl a\n" + face), {path}, {}));
  };
  CHECK(notes("Tr 1\n") == Notes{"1 material has Tr and no d: Tr is not read, since programs contradict each "
                                 "other in it"});
  CHECK(notes("Tr 1\nd 1\n").empty());
  CHECK(notes("d 0.5\n") == Notes{"1 material is partly clear (d) and drawn solid"});
  CHECK(notes("Tr 0\n").empty());
  // A library may be named where it lay on another machine.
  CHECK(std::get<TriangleMesh>(
            read_obj(SharedBytes::own("mtllib C:\\x\\a.mtl\nusemtl a\n" + face), {folder.path("b.obj")}, {}))
            .face_colors == Colors{kRed});
  CHECK(notes("map_Kd -s 1 1 1 -o 0 0 0 no.png\n").size() == 1);
  CHECK(notes("map_Kd -s 2 2 no.png\n").size() == 2);
  CHECK(
      contains(notes("map_Kd -o 0 0.5 no.png\n").back(), "1 material has a picture that is moved or scaled"));
  CHECK_THROWS_WITH_AS(notes("d 0\n"), "all of its triangles are wholly clear (d 0)", InputError);
  // Without faces all vertices are drawn.
  CHECK(notes_of(source_of(read_obj, "v 0 0 0\nv 1 1 1\np 1 2\n")).empty());
  CHECK(notes_hold(source_of(read_obj, "v 0 0 0\nv 1 1 1\np 1 2\nl 1 2\n"), "1 in all) are not drawn"));
}

TEST_CASE("xyz: what a header names and nothing is taken from, and one without x, y and z -> noted") {
  CHECK(notes_of(source_of(read_xyz, "x,y,z,intensity\n1,2,3,4\n")) ==
        Notes{"the column 'intensity' is not read"});
  CHECK(notes_hold(source_of(read_xyz, "x,y,z,r,g,b,a,nx\n1,2,3,4,5,6,7,8\n"),
                   "the column 'a' and 1 more are"));
  for (const char* rows : {",x,y,z\n0,1,2,3\n", "\"\",\"x\",\"y\",\"z\"\n\"1\",1,2,3\n"}) {
    CHECK(notes_of(source_of(read_xyz, rows)) == Notes{"the column without a name is not read"});
  }
  CHECK(notes_hold(source_of(read_xyz, "\xc3\x85,x,y,z\n9,1,2,3\n"), " is not read"));
  CHECK(notes_hold(source_of(read_xyz, "lon,lat,height\n1,2,3\n"), "line 1 names no columns x, y and z"));
  CHECK(notes_of(source_of(read_xyz, "X Y Z\n1 2 3\n")).empty());
  CHECK(colors_of(source_of(read_xyz, "//X Y Z Rf Gf Bf\n0 0 0 0.5 0 0\n1 1 1 1 0 0\n")) ==
        Colors{{128, 0, 0}, kRed});
}

TEST_CASE("pcd: names in capitals, and colours in three fields of bytes or floats -> read") {
  const std::string sizes = "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n";
  CHECK(points_of(source_of(read_pcd, "FIELDS X Y Z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n" + sizes +
                                          "0 0 0\n5 5 5\n")) == 2);
  for (const char* type : {"U U U", "F F F"}) {
    const std::string head = "FIELDS x y z r g b\nSIZE 4 4 4 4 4 4\nTYPE F F F " + std::string(type) + "\n";
    CHECK(colors_of(source_of(read_pcd, head + sizes + "0 0 0 255 0 0\n5 5 5 0 0 255\n")) ==
          Colors{kRed, kBlue});
  }
  for (const bool is_turned : {false, true}) {
    const Source cloud = source_of(read_pcd, "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nVIEWPOINT 0 0 " +
                                                 std::string(is_turned ? "2" : "0.0") + " 1 0 0 0\n" + sizes +
                                                 "0 0 0\n5 5 5\n");
    CHECK(notes_hold(cloud, "without the header's VIEWPOINT") == is_turned);
  }
  const std::string binary =
      "FIELDS x y z r g b\nSIZE 4 4 4 1 1 1\nTYPE F F F U U U\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary\n";
  CHECK(colors_of(source_of(read_pcd, binary + std::string(12, '\0') + std::string("\0\xFF\0", 3))) ==
        Colors{kGreen});
}

TEST_CASE("obj: polygons that are not convex -> ears, whose triangles cover the polygon and nothing else") {
  // A U, a comb, an arrow; seen along each axis, forwards and backwards.
  const std::vector<std::vector<std::array<double, 2>>> shapes{
      {{0, 0}, {9, 0}, {9, 9}, {6, 9}, {6, 3}, {3, 3}, {3, 9}, {0, 9}},
      {{0, 0}, {9, 0}, {9, 5}, {7, 5}, {7, 1}, {5, 1}, {5, 5}, {4, 5}, {4, 1}, {2, 1}, {2, 5}, {0, 5}},
      {{0, 0}, {4, 2}, {0, 4}, {1, 2}}};
  for (const auto& shape : shapes) {
    double area = 0;
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const auto& p = shape[i];
      const auto& q = shape[(i + 1) % shape.size()];
      area += p[0] * q[1] - p[1] * q[0];
    }
    for (std::size_t turned = 0; turned < 6; ++turned) {
      std::string text;
      std::string face = "f";
      for (std::size_t i = 0; i < shape.size(); ++i) {
        const auto& p = shape[turned < 3 ? i : shape.size() - 1 - i];
        std::array<double, 3> place{};
        place[turned % 3] = p[0];
        place[(turned + 1) % 3] = p[1];
        text += "v " + std::to_string(place[0]) + " " + std::to_string(place[1]) + " " +
                std::to_string(place[2]) + "\n";
        face += " " + std::to_string(i + 1);
      }
      for (const bool comes_first : {false, true}) {
        const TriangleMesh mesh = read_mesh(read_obj, comes_first ? face + "\n" + text : text + face + "\n");
        REQUIRE(mesh.triangles.size() == shape.size() - 2);
        double sum = 0;
        for (const auto& triangle : mesh.triangles) {
          const auto& a = mesh.positions[triangle[0]];
          const auto& b = mesh.positions[triangle[1]];
          const auto& c = mesh.positions[triangle[2]];
          const std::size_t u = turned % 3;
          const std::size_t v = (turned + 1) % 3;
          const double doubled = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
          CHECK((turned < 3 ? doubled : -doubled) >= 0);  // none is turned over: so none lies outside
          sum += std::fabs(doubled);
        }
        CHECK(sum == doctest::Approx(area));
      }
    }
  }
}

TEST_CASE("obj: materials beside it -> colours of faces; what is missing or not drawn is noted") {
  const TemporaryFolder folder;
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  folder.write("a b.mtl",
               "newmtl my red\nKd 1 0 0\nd 1\nnewmtl air\nKd 0 1 0\nd 0\nnewmtl photo\nmap_Kd p.jpg\nKd 0 0 "
               "1\nTr 1\n");
  const auto read = [&](const std::string& text) { return read_scene_file({folder.write("x.obj", text)}); };
  const Source source = read("mtllib a b.mtl\n" + square +
                             "f 1 2 3\nusemtl my red\nf 1 3 4\nusemtl air\nf 1 2 4\nusemtl photo\nf 2 3 4\n");
  const auto& mesh = std::get<TriangleMesh>(source);
  CHECK(mesh.face_colors == Colors{Rgb{}, kRed, kBlue});
  CHECK(mesh.triangles.size() == 3);
  CHECK(notes_hold(source, "1 triangle is wholly clear"));
  CHECK(notes_hold(source, "the picture 'p.jpg' is not drawn: it has no place"));
  CHECK(notes_hold(read("mtllib none.mtl\nusemtl red\n" + square + "f 1 2 3\n"), "'none.mtl'"));
  CHECK(notes_hold(read("usemtl red\n" + square + "f 1 2 3\n"), "no file is named"));
  CHECK(notes_hold(read("mtllib a b.mtl\nusemtl blue\n" + square + "f 1 2 3\n"),
                   "1 material has no description"));
  CHECK(notes_of(read(square + "f 1 2 3\n")).empty());
  std::string many = "mtllib a b.mtl\n" + square;
  for (int i = 0; i < 65535; ++i) {
    many += "usemtl " + std::to_string(i) + "\n";
  }
  const Source more = read(many + "usemtl my red\nf 1 2 3\nusemtl 7\nf 1 3 4\n");
  CHECK(notes_hold(more, "behind the first 65535"));
  CHECK(std::get<TriangleMesh>(more).face_colors.empty());
}

TEST_CASE("notes: many faults of a kind -> the first of them and how many more there are") {
  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nmtllib a.mtl\n";
  std::string library;
  for (const char* const name : {"a", "b", "c", "d", "e"}) {
    many += "usemtl " + std::string(name) + "\nf 1/1 2/1 3/1\n";
    library += "newmtl " + std::string(name) + "\nmap_Kd " + name + ".png\n";
  }
  const TemporaryFolder folder;
  folder.write("a.mtl", library);
  const std::string path = folder.write("a.obj", many);
  const Notes notes = notes_of(read_obj(SharedBytes::own(many), {path}, {}));
  REQUIRE(notes.size() == 4);
  CHECK(contains(notes[0], "'a.png' is not drawn"));
  CHECK(notes[3] == "2 more pictures are not drawn");
}

TEST_CASE("vox: models packed by zlib, a palette of sixteen entries -> read") {
  const std::string size = numbers<std::uint32_t>({2, 3, 2});
  const std::string packed = deflated(std::string("\1\0\0\0\0\2\0\0\0\0\0\3", 12), 15);
  const auto read = [&](const std::string& model) {
    return read_any({"a.vox"}, SharedBytes::own(vox_file(vox_chunk("SIZE", size) + vox_chunk("TDCZ", model) +
                                                         vox_chunk("RGBA", std::string(16 * 4, '\x40')))));
  };
  const Source source = read(size + packed);
  const auto& model = *std::get<std::unique_ptr<VoxelModel>>(source);
  std::vector<std::array<std::int32_t, 4>> seen;
  model.for_each([&](auto x, auto y, auto z, auto material) { seen.push_back({x, y, z, material}); });
  CHECK(seen == std::vector<std::array<std::int32_t, 4>>{{0, 0, 0, 1}, {1, 2, 0, 2}, {1, 2, 1, 3}});
  CHECK(model.palette()[16].color == Rgb{64, 64, 64});
  CHECK(model.palette()[17].color == vox_default_palette()[17].color);
  CHECK_THROWS_AS(read(size + packed.substr(0, 9)), InputError);
  CHECK_THROWS_AS(read(numbers<std::uint32_t>({2, 2, 2}) + packed), InputError);
}
