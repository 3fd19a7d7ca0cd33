// Readers of meshes: .obj, .off, and .ply with faces.
#include <doctest/doctest.h>

#include <array>
#include <string>

#include "readers/formats.h"
#include "readers/read_any.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"

using namespace thimble::tools;
using namespace thimble::tools::test;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

const std::string kPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kPlySquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::string kObjSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

}  // namespace

TEST_CASE("ply mesh: polygons -> fans; fewer than three corners -> nothing") {
  const std::string head = kPlyHead +
                           "element face 4\nproperty uchar flag\nproperty list uchar int vertex_indices\n" +
                           "property list uchar float texcoord\nend_header\n" + kPlySquare;
  const TriangleMesh mesh =
      read_mesh(read_ply, head + "9 4 0 1 2 3 2 0.5 0.5\n9 2 0 1 0\n9 0 0\n9 3 3 2 1 0\n");
  CHECK(mesh.positions.size() == 4);
  CHECK(mesh.positions[2] == std::array<double, 3>{1, 1, 0});
  CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 2, 3}, {3, 2, 1}});
  CHECK(mesh.colors.empty());
}

TEST_CASE("ply mesh: faces before vertices, vertex_index, colours -> read") {
  const std::string text =
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar uint vertex_index\nelement vertex 3\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n3 2 1 0\n1 2 3 0 0 0\n4 5 6 1 0 0\n7 8 9 0 1 0\n";
  const TriangleMesh mesh = read_mesh(read_ply, text);
  CHECK(mesh.triangles == Triangles{{2, 1, 0}});
  REQUIRE(mesh.colors.size() == 3);
  CHECK(mesh.colors[1] == Rgb{4, 5, 6});
}

TEST_CASE("ply mesh: tristrips -> triangles with one winding, -1 begins a new strip") {
  const std::string text = kPlyHead +
                           "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" +
                           kPlySquare + "11 0 1 2 3 -1 3 1 0 0 2 1\n";
  CHECK(read_mesh(read_ply, text).triangles == Triangles{{0, 1, 2}, {2, 1, 3}, {3, 1, 0}, {2, 0, 1}});
}

TEST_CASE("ply mesh: an index that is no vertex -> an error that names the face") {
  const std::string head =
      kPlyHead + "element face 2\nproperty list uchar int vertex_indices\nend_header\n" + kPlySquare;
  CHECK(contains(error_of(read_ply, head + "3 0 1 2\n3 0 1 4\n"), "line 15: face 1 has an index"));
  CHECK(contains(error_of(read_ply, head + "3 0 1 -1\n3 0 1 2\n"), "face 0"));
  CHECK(contains(error_of(read_ply, head + "3 0 1 1.5\n3 0 1 2\n"), "face 0"));
  CHECK(contains(error_of(read_ply, head + "3 0 1 nan\n3 0 1 2\n"), "face 0"));
  CHECK(contains(error_of(read_ply, head + "3 0 1 2\n3 0 1\n"), "ends before"));
  CHECK(contains(error_of(read_ply, head + "3 0 1 2\n-3 0 1 2\n"), "length of a list"));
  CHECK(contains(error_of(read_ply, head + "3 0 1 2\n1e300 0 1 2\n"), "longer than the rest"));
}

TEST_CASE("ply mesh: no faces in an element of faces -> points") {
  CHECK(read_points(
            read_ply,
            kPlyHead + "element face 0\nproperty list uchar int vertex_indices\nend_header\n" + kPlySquare)
            .size() == 4);
}

TEST_CASE("ply mesh: every truncated length -> refused") {
  const std::string text = kPlyHead + "element face 2\nproperty list uchar int vertex_indices\nend_header\n" +
                           kPlySquare + "4 0 1 2 3\n3 3 2 1\n";
  // Without its line's end the last number is still whole.
  CHECK(accepted_lengths(read_ply, text) == std::vector<std::size_t>{text.size() - 1});
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\n"
      "property uchar z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
  binary += std::string(9, '\1') + std::string("\3\0\1\2", 4);
  CHECK(read_mesh(read_ply, binary).triangles == Triangles{{0, 1, 2}});
  CHECK(accepted_lengths(read_ply, binary).empty());
}

TEST_CASE("obj: faces in all notations, relative indices, continued lines -> triangles") {
  const std::string text = "# c\r\nmtllib none.mtl\no thing\n" + kObjSquare +
                           "vt 0 0\nvn 0 0 1\nusemtl x\ns off\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf 1//1 2//1 3//1\n"
                           "f 1/1 2/1 3/1 # end\nf -4 \\\n  -3 -2\n\tf\t2 3 4\nf 1 2\nf\nl 1 2\np 1\n";
  const TriangleMesh mesh = read_mesh(read_obj, text);
  CHECK(mesh.positions.size() == 4);
  CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {1, 2, 3}});
  CHECK(mesh.colors.empty());
}

TEST_CASE("obj: colours -> kept when every vertex has one") {
  const TriangleMesh mesh = read_mesh(read_obj, "v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0\nv 1 1 0 1 -1 0\nf 1 2 3\n");
  REQUIRE(mesh.colors.size() == 3);
  CHECK(mesh.colors[0] == Rgb{255, 0, 128});
  CHECK(mesh.colors[2] == Rgb{255, 0, 0});
  CHECK(read_mesh(read_obj, "v 0 0 0 1 0 0.5\nv 1 0 0\nv 1 1 0 2 -1 0\nf 1 2 3\n").colors.empty());
  CHECK(read_mesh(read_obj, "v 0 0 0 1\nv 1 0 0 1\nv 1 1 0 1\nf 1 2 3\n").colors.empty());
}

TEST_CASE("obj: coordinates -> exact doubles") {
  const TriangleMesh mesh =
      read_mesh(read_obj, "v 0.1 600000.123456789 -1e-7\nv +1. .5 2E2\nv 0 0 0\nf 1 2 3\n");
  CHECK(mesh.positions[0] == std::array<double, 3>{0.1, 600000.123456789, -1e-7});
  CHECK(mesh.positions[1] == std::array<double, 3>{1, 0.5, 200});
}

TEST_CASE("obj: a face before its vertices -> allowed, as long as they come") {
  CHECK(read_mesh(read_obj, "f 1 2 3\n" + kObjSquare).triangles == Triangles{{0, 1, 2}});
  CHECK(contains(error_of(read_obj, "f 1 2 3\nf 1 2 5\n" + kObjSquare),
                 "line 2: the face has the index 5, but there are 4 vertices in the file"));
}

TEST_CASE("obj: what is wrong -> an error that names the line") {
  CHECK(contains(error_of(read_obj, kObjSquare + "f 0 1 2\n"), "line 5: the face has the index 0"));
  CHECK(contains(error_of(read_obj, kObjSquare + "f -5 1 2\n"), "line 5: the face has the index -5"));
  CHECK(contains(error_of(read_obj, kObjSquare + "\r\nf 1 2 5\r\n"), "line 6: the face has the index 5"));
  CHECK(contains(error_of(read_obj, kObjSquare + "f 1 2 4294967297\n"), "'4294967297'"));
  CHECK(contains(error_of(read_obj, kObjSquare + "f 1 2 99999999999999999999\n"), "line 5"));
  CHECK(contains(error_of(read_obj, kObjSquare + "f 1 2 x\n"), "'x' of a face is not an index"));
  CHECK(contains(error_of(read_obj, kObjSquare + "f 1 2 3/4/5/6\n"), "'3/4/5/6'"));
  CHECK(contains(error_of(read_obj, kObjSquare + "f 1 2 /4\n"), "'/4'"));
  CHECK(contains(error_of(read_obj, "v 1 2 nan\n"), "line 1: z is 'nan', which is not finite"));
  CHECK(contains(error_of(read_obj, "v 0 0 0\nv 1 2\n"), "line 2: z is missing"));
  CHECK(contains(error_of(read_obj, "v\n"), "line 1: x is missing"));
  CHECK(contains(error_of(read_obj, "v 1 2 1.#IND\n"), "line 1: z is '1.#IND', which is not a number"));
  CHECK(contains(error_of(read_obj, "v 1,5 2 3\n"), "x is '1,5', which is not a number"));
  CHECK(contains(error_of(read_obj, std::string("v 1 2 3\0 4\n", 11)), "line 1: z"));
  CHECK(contains(error_of(read_obj, ""), "no vertices"));
  CHECK(contains(error_of(read_obj, "f 1 2 3\n"), "there are 0 vertices"));
}

TEST_CASE("obj: statements that ask for memory or files -> ignored") {
  CHECK(read_mesh(read_obj, kObjSquare + "t crease 2000000000/2000000000/2000000000 1\nmtllib /dev/zero\n" +
                                "vw 0 1 2 3\ng\ncurv 0 1\nf 1 2 3\n")
            .triangles.size() == 1);
}

TEST_CASE("obj: no faces -> points; CR alone ends lines too") {
  const auto points = read_points(read_obj, "v 1 2 3 0 1 0\rv 4 5 6 1 1 1\r");
  REQUIRE(points.size() == 2);
  CHECK(points[1].z == 6);
  CHECK(points[0].color == Rgb{0, 255, 0});
  CHECK(points[1].line == 2);
}

TEST_CASE("obj: every truncated length -> read or refused, never more than the whole") {
  const std::string text = "# c\n" + kObjSquare + "vn 0 0 1\nf 1//1 2//1 3//1 4//1\nf -1 -2 -3\n";
  for (std::size_t length = 0; length < text.size(); ++length) {
    CHECK(outcome_of(read_obj, text.substr(0, length)) <= 4);
  }
}

TEST_CASE("obj: progress is reported, and what it throws arrives") {
  const std::string text = thimble::tests::repeated(kObjSquare, 20000) + "f 1 2 3\n";
  int calls = 0;
  read_obj(SharedBytes::own(text), {}, [&](double) { ++calls; });
  CHECK(calls >= 1);
  CHECK_THROWS_AS(read_obj(SharedBytes::own(text), {}, [](double) { throw 7; }), int);
}

TEST_CASE("off: counts after the keyword or on a later line, comments, blank lines -> the same mesh") {
  const std::string body = "0 0 0\n1 0 0 # corner\n\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n3 0 1 2\n2 0 1\n0\n";
  for (const char* head :
       {"OFF 4 4 0\n", "OFF\n4 4 0\n", "# c\nOFF # d\n# e\n\n4 4\n0\n", "OFF\r\n4 4 0\r\n", "OFF\r4 4 0\r"}) {
    INFO(std::string(head));
    const TriangleMesh mesh = read_mesh(read_off, head + body);
    CHECK(mesh.positions.size() == 4);
    CHECK(mesh.positions[1] == std::array<double, 3>{1, 0, 0});
    CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}});
    CHECK(mesh.colors.empty());
  }
}

TEST_CASE("off: several vertices and faces on a line, or all -> by their words") {
  for (const char* text : {"OFF 4 2 0 0 0 0 1 0 0 1 1 0 0 1 0 4 0 1 2 3 3 0 1 2",
                           "OFF\n4 2 0\n0 0 0 1 0 0\n1 1 0 0 1 0 # corners\n4 0 1 2 3 3 0 1 2\n",
                           "NOFF 4 2 0 0 0 0 0 0 1 1 0 0 0 0 1 1 1 0 0 0 1 0 1 0 0 0 1 4 0 1 2 3 3 0 1 2",
                           "OFF\n4 2 0\n0 0\n0\n1 0 0\n1 1\n0\n0 1 0\n4 0 1\n2 3\n3\n0 1 2\n"}) {
    INFO(std::string(text));
    const TriangleMesh mesh = read_mesh(read_off, text);
    CHECK(mesh.positions[3] == std::array<double, 3>{0, 1, 0});
    CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}});
  }
  for (const char* more :
       {"OFF 3 1 0 0 0 0 1 0 0 1 1 0 3 0 1 2 7", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n7"}) {
    CHECK(
        contains(read_mesh(read_off, more).notes.front(), "'7' and what follows comes after the last face"));
  }
}

TEST_CASE("off: colours of vertices -> bytes, or fractions of 1") {
  const std::string face = "3 0 1 2 1 1 1\n";
  const auto colors = [&](const std::string& text) { return read_mesh(read_off, text + face).colors; };
  CHECK(colors("COFF\n3 1 0\n0 0 0 255 0 7 255\n1 0 0 1 2 3 4\n1 1 0 0 0 0 0\n") ==
        std::vector<Rgb>{{255, 0, 7}, {1, 2, 3}, {0, 0, 0}});
  CHECK(colors("COFF\n3 1 0\n0 0 0 1.0 0 0.5 1\n1 0 0 0 1 0 1\n1 1 0 0 0 0 0\n") ==
        std::vector<Rgb>{{255, 0, 128}, {0, 255, 0}, {0, 0, 0}});
  CHECK(colors("COFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 0 1 0\n1 1 0 0 0 1\n") ==
        std::vector<Rgb>{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}});
  CHECK(
      colors(
          "STCNOFF\n3 1 0\n0 0 0 0 0 1 9 8 7 255 0 0\n1 0 0 0 0 1 1 2 3 4 0 0\n1 1 0 0 0 1 3 2 1 0 0 0\n") ==
      std::vector<Rgb>{{9, 8, 7}, {1, 2, 3}, {3, 2, 1}});
  CHECK(colors("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n").empty());
  CHECK(contains(error_of(read_off, "COFF\n3 1 0\n0 0 0 a b c\n1 0 0\n1 1 0\n"), "the color of vertex 0"));
}

TEST_CASE("off: what is wrong -> an error that names the place") {
  const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  CHECK(contains(error_of(read_off, "OFF\n353535235358 6 0\n" + square),
                 "353535235358 vertices, the limit is 4294967296"));
  CHECK(contains(error_of(read_off, "OFF\n4000000000 6 0\n" + square), "declares 4000000000 vertices"));
  CHECK(contains(error_of(read_off, "OFF\n4 353535235358 0\n" + square), "declares 353535235358 faces"));
  CHECK(contains(error_of(read_off, "OFF\n-4 1 0\n" + square), "line 2: the number of vertices is '-4'"));
  CHECK(contains(error_of(read_off, "OFF\n4 1.5 0\n" + square), "number of faces"));
  CHECK(contains(error_of(read_off, "OFF BINARY\n"), "binary OFF"));
  CHECK(contains(error_of(read_off, "4OFF\n4 1 0\n"), "'4OFF'"));
  CHECK(contains(error_of(read_off, "off\n"), "line 1"));
  CHECK(contains(error_of(read_off, ""), "empty"));
  CHECK(contains(error_of(read_off, "OFF\n0 0 0\n"), "no vertices"));
  CHECK(
      contains(error_of(read_off, "OFF\n4 1 0\n" + square + "3 0 1 4\n"), "line 7: face 0 has the index 4"));
  CHECK(contains(error_of(read_off, "OFF\n4 1 0\n" + square + "3 0 1 -1\n"), "face 0 has the index -1"));
  CHECK(contains(error_of(read_off, "OFF\n4 1 0\n" + square + "-3 0 1 2\n"), "-3 corners"));
  CHECK(contains(error_of(read_off, "OFF\n4 1 0\n" + square + "3 0 1 b\n"), "'b' in face 0"));
  CHECK(contains(error_of(read_off, "OFF\n4 1 0\n" + square + "9223372036854775807 0 1 2\n"),
                 "ends in face 0"));
  CHECK(contains(error_of(read_off, "OFF\n4 2 0\n" + square + "3 0 1 2\n"), "ends in face 1 of 2"));
  CHECK(contains(error_of(read_off, "OFF\n4 1 0\n0 0 0\n1 0 inf\n1 1 0\n0 1 0\n"),
                 "line 4: a coordinate of vertex 1 is 'inf', which is not finite"));
  CHECK(contains(error_of(read_off, "OFF\n4 1 0\n0 0 0\n1 x 0\n1 1 0\n0 1 0\n"), "line 4"));
}

TEST_CASE("off: no faces -> points; every truncated length of a mesh -> refused") {
  CHECK(read_points(read_off, "OFF 2 0 0\n1 2 3\n4 5 6\n").size() == 2);
  const std::string text =
      "COFF\n# c\n4 2 0\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n4 0 1 2 3\n3 0 1 2\n";
  CHECK(accepted_lengths(read_off, text) == std::vector<std::size_t>{text.size() - 1});
}
