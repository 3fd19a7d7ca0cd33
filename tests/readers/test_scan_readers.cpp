// Readers of point scans and meshes in binary forms: .pcd, .las, .stl, .gltf and .glb.
#include <doctest/doctest.h>

#include <draco/compression/encode.h>
#include <sys/stat.h>

#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "readers/formats.h"
#include "readers/gltf_file.h"
#include "readers/read_any.h"
#include "readers/texture.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"
#include "support/run_command.h"

using namespace thimble::tools;
using namespace thimble::tools::test;
using thimble::tests::glb;
using thimble::tests::little;

namespace {

std::string pcd_head(const std::string& data, int points = 2) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 8 4 4\nTYPE F F I U\nCOUNT 1 1 1 1\nWIDTH " +
         std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) +
         "\nDATA " + data + "\n";
}

/// LZF of literals alone, then of one copy.
std::string packed_lzf(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size(); at += 32) {
    const std::string part = text.substr(at, 32);
    out += static_cast<char>(part.size() - 1) + part;
  }
  return out;
}

struct LasPoint {
  std::int32_t x, y, z;
  std::uint16_t r = 0, g = 0, b = 0;
  bool withheld = false;
};

std::string las(unsigned minor, unsigned format, const std::vector<LasPoint>& points) {
  constexpr std::array<std::uint16_t, 11> kBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  constexpr std::array<std::uint16_t, 11> kColor{0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};
  const std::uint16_t header_bytes = minor == 4 ? 375 : 227;
  std::string out = "LASF" + little(0, 20) + little(1, 1) + little(minor, 1) + little(0, 68) +
                    little(header_bytes, 2) + little(header_bytes, 4) + little(0, 4) + little(format, 1) +
                    little(kBytes[format], 2) + little(minor == 4 ? 0 : points.size(), 4) + little(0, 20) +
                    little(0.5) + little(0.5) + little(2.0) + little(100.0) + little(0.0) + little(-1.0);
  out.resize(247);
  out += little(points.size(), 8);
  out.resize(header_bytes);
  for (const LasPoint& point : points) {
    std::string record = little(static_cast<std::uint32_t>(point.x), 4) +
                         little(static_cast<std::uint32_t>(point.y), 4) +
                         little(static_cast<std::uint32_t>(point.z), 4);
    record.resize(kBytes[format]);
    record[15] = static_cast<char>(point.withheld ? (format >= 6 ? 0x04 : 0x80) : 0);
    if (kColor[format] != 0) {
      record.replace(kColor[format], 6, little(point.r, 2) + little(point.g, 2) + little(point.b, 2));
    }
    out += record;
  }
  return out;
}

std::string stl_triangle(const std::array<float, 9>& numbers) {
  std::string out = little(0, 12);
  for (const float number : numbers) {
    out += little(number);
  }
  return out + little(0, 2);
}
std::string stl(const std::string& title, std::uint32_t count, const std::string& triangles) {
  std::string head = title;
  head.resize(80);
  return head + little(count, 4) + triangles;
}

/// Three corners and their indices, in a buffer of 48 bytes.
std::string triangle_buffer() {
  std::string out;
  for (const float number : {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 2.0F, 0.0F}) {
    out += little(number);
  }
  return out + little(0, 2) + little(1, 2) + little(2, 2) + little(0, 6);
}
constexpr const char* kTriangleData =
    "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAAAAABAAIAAAAAAAAA";

/// A scene of one triangle; `nodes` and `material` are JSON.
std::string gltf_json(const std::string& buffer, const std::string& nodes, const std::string& material = "{}",
                      const std::string& primitive = "") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0)" + primitive +
         R"(}]}],"materials":[)" + material +
         R"(],"accessors":[)"
         R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
         R"({"bufferView":0,"byteOffset":36,"componentType":5123,"count":3,"type":"SCALAR"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":48}],"buffers":[{"byteLength":48)" +
         (buffer.empty() ? "" : ",\"uri\":\"" + buffer + "\"") + "}]}";
}

/// The same with accessors and views behind its own, and what belongs before the asset.
std::string gltf_with(const std::string& head, const std::string& accessors, const std::string& views,
                      const std::string& node) {
  std::string json = gltf_json("", node);
  const auto put_behind = [&](const std::string& place, const std::string& added) {
    json.insert(json.find(place) + place.size(), added);
  };
  put_behind(R"("count":3,"type":"SCALAR"})", accessors);
  put_behind(R"("byteLength":48})", views);
  return json.insert(1, head);
}

/// A grid of 2 x `columns` unit squares in the plane z = 0, 4 * `columns` triangles, as Draco's bytes; places have the
/// id 0, colours, which are the bytes of the places, 1.
std::string draco_grid(std::uint32_t columns, int speed) {
  draco::Mesh mesh;
  draco::GeometryAttribute places;
  places.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  draco::GeometryAttribute colors;
  colors.Init(draco::GeometryAttribute::COLOR, nullptr, 3, draco::DT_UINT8, true, 3, 0);
  const std::uint32_t points = 3 * (columns + 1);
  mesh.set_num_points(points);
  const int place = mesh.AddAttribute(places, true, points);
  const int color = mesh.AddAttribute(colors, true, points);
  for (std::uint32_t i = 0; i < points; ++i) {
    const std::array<float, 3> xyz{static_cast<float>(i / 3), static_cast<float>(i % 3), 0};
    const std::array<std::uint8_t, 3> rgb{static_cast<std::uint8_t>(i / 3), static_cast<std::uint8_t>(i % 3),
                                          255};
    mesh.attribute(place)->SetAttributeValue(draco::AttributeValueIndex(i), xyz.data());
    mesh.attribute(color)->SetAttributeValue(draco::AttributeValueIndex(i), rgb.data());
  }
  for (std::uint32_t i = 0; i < 2 * columns; ++i) {
    const std::uint32_t corner = i / 2 * 3 + i % 2;
    const draco::PointIndex a(corner), b(corner + 3), c(corner + 4), d(corner + 1);
    mesh.AddFace({a, b, c});
    mesh.AddFace({a, c, d});
  }
  draco::Encoder encoder;
  encoder.SetSpeedOptions(speed, speed);  // 10: one face after the other
  draco::EncoderBuffer buffer;
  REQUIRE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

/// A scene of one triangle's two accessors, both of `packed`, and a third for colours.
std::string draco_glb(const std::string& packed, std::uint32_t columns, const std::string& indices = "",
                      const std::string& mode = "") {
  const std::string points = std::to_string(3 * (columns + 1));
  const std::string corners = indices.empty() ? std::to_string(12 * columns) : indices;
  return glb(
      R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"],)"
      R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1},"indices":2)" +
          mode +
          R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":)"
          R"({"POSITION":0,"COLOR_0":1}}}}]}],"accessors":[{"componentType":5126,"count":)" +
          points + R"(,"type":"VEC3"},{"componentType":5121,"normalized":true,"count":)" + points +
          R"(,"type":"VEC3"},{"componentType":5125,"count":)" + corners +
          R"(,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(packed.size()) +
          R"(}],"buffers":[{"byteLength":)" + std::to_string(packed.size()) + "}]}",
      packed + std::string(3 - (packed.size() + 3) % 4, '\0'));
}

}  // namespace

TEST_CASE(
    "gltf: meshes that Draco compressed, in both of its ways -> as they were; damaged ones -> a sentence") {
  for (const int speed : {0, 5, 10}) {
    CAPTURE(speed);
    const std::string packed = draco_grid(50, speed);
    const TriangleMesh mesh = read_mesh(read_gltf, draco_glb(packed, 50));
    CHECK(mesh.notes.empty());
    REQUIRE(mesh.triangles.size() == 200);
    REQUIRE(mesh.colors.size() == 153);
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto& [from, to, other] = std::tie(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
      area += (to[0] - from[0]) * (other[1] - from[1]) - (to[1] - from[1]) * (other[0] - from[0]);
    }
    CHECK(area == doctest::Approx(200).epsilon(0.01));  // all the same way round; places are rounded
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const Rgb wanted{screen_byte(std::round(mesh.positions[i][0]) / 255.0),
                       screen_byte(std::round(mesh.positions[i][1]) / 255.0), 255};
      CHECK(mesh.colors[i] == wanted);
    }
    CHECK(read_mesh(read_gltf, draco_glb(packed, 50, "", ",\"mode\":5")).triangles.size() == 200);
    CHECK(contains(error_of(read_gltf, draco_glb(packed, 49)), "accessor 2: it has 588 values"));
    CHECK(contains(error_of(read_gltf, draco_glb(packed, 50, "603")), "accessor 2: it has 603 values"));
    for (std::size_t i = 0; i < packed.size(); ++i) {
      CAPTURE(i);
      CHECK_FALSE(error_of(read_gltf, draco_glb(packed.substr(0, i), 50)).empty());
      std::string damaged = packed;
      damaged[i] = static_cast<char>(damaged[i] ^ (i % 2 == 0 ? 0x81 : 0x7f));
      const std::string said = error_of(read_gltf, draco_glb(damaged, 50));  // or it says other things
      CHECK(said.size() < 300);
    }
  }
  const std::string many =
      std::string("DRACO\2\2\1\1\0\0\0", 12) + "\xff\xff\xff\xff\x0f\xff\xff\xff\xff\x0f";
  CHECK(contains(error_of(read_gltf, draco_glb(many, 50)), "claims 4294967295 triangles"));
  CHECK(contains(error_of(read_gltf, draco_glb(std::string("DRACO\1\3\1\1\0\0", 11), 50)), "version 1.3"));
}

TEST_CASE("pcd: text, binary and compressed -> the same points; not finite ones are left out") {
  const std::string text = pcd_head("ascii", 3) + "1.5 2.5 -3 255\nnan 1 2 0\n4 5 6 16711680\n";
  const auto x = [](float value) { return little(value); };
  const std::string binary = pcd_head("binary", 3) + x(1.5F) + little(2.5) + little(0xFFFFFFFD, 4) +
                             little(255, 4) + x(NAN) + little(1.0) + little(2, 4) + little(0, 4) + x(4) +
                             little(5.0) + little(6, 4) + little(0xFF0000, 4);
  const std::string apart = x(1.5F) + x(NAN) + x(4) + little(2.5) + little(1.0) + little(5.0) +
                            little(0xFFFFFFFD, 4) + little(2, 4) + little(6, 4) + little(255, 4) +
                            little(0, 4) + little(0xFF0000, 4);
  const std::string packed = packed_lzf(apart);
  const std::string compressed =
      pcd_head("binary_compressed", 3) + little(packed.size(), 4) + little(apart.size(), 4) + packed;
  for (const std::string& file : {text, binary, compressed}) {
    CHECK(looks_like_pcd(file));
    const auto points = read_points(read_pcd, file);
    REQUIRE(points.size() == 2);
    CHECK(points[0].x == 1.5);
    CHECK(points[0].y == 2.5);
    CHECK(points[0].z == -3);
    CHECK(points[0].color == Rgb{0, 0, 255});
    CHECK(points[1].color == Rgb{255, 0, 0});
    CHECK(cloud_has_color(read_pcd, file));
  }
  // The last line of a text may be cut so that its numbers are still some.
  for (const std::size_t length : accepted_lengths(read_pcd, text)) {
    CHECK(length > text.size() - 9);
  }
  CHECK(accepted_lengths(read_pcd, binary).empty());
  CHECK(accepted_lengths(read_pcd, compressed).empty());
}

TEST_CASE("pcd: LZF copies, also of what they make -> the bytes") {
  // Twelve zero bytes: one literal, a copy of eleven from one byte back; y is a double, so 24 a point.
  const std::string packed = std::string("\0\0", 2) + std::string("\xE0\x0E\0", 3);
  const auto points = read_points(
      read_pcd, "FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA binary_compressed\n" +
                    little(packed.size(), 4) + little(24, 4) + packed);
  REQUIRE(points.size() == 1);
  CHECK(points[0].x == 0);
  CHECK(
      contains(error_of(read_pcd, "FIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nPOINTS 1\nDATA binary_compressed\n" +
                                      little(2, 4) + little(24, 4) + "\x20\x05"),
               "before the beginning"));
  CHECK(contains(error_of(read_pcd, "FIELDS x y z\nPOINTS 357913941\nDATA binary_compressed\n" +
                                        little(2, 4) + little(4294967292, 4) + "\x20\x05"),
                 "cannot hold"));
}

TEST_CASE("pcd: damage -> a sentence that names the place") {
  CHECK(contains(error_of(read_pcd, "289814.15 4320978.61 170.76\n"), "line 1: '289814.15'"));
  CHECK(contains(error_of(read_pcd, "VERSION .7\nFIELDS x y\nPOINTS 1\nDATA ascii\n1 2\n"), "named z"));
  CHECK(contains(error_of(read_pcd, "VERSION .7\nPOINTS 1\nDATA ascii\n1 2\n"), "FIELDS"));
  CHECK(contains(error_of(read_pcd, "FIELDS x y z\nDATA ascii\n1 2 3\n"), "POINTS"));
  CHECK(contains(error_of(read_pcd, "FIELDS x y z\nSIZE 3 4 4\n"), "line 2"));
  CHECK(contains(error_of(read_pcd, "FIELDS x y z\nTYPE X F F\n"), "'X'"));
  CHECK(contains(error_of(read_pcd, "FIELDS x y z\nDATA zip\n"), "'zip'"));
  CHECK(contains(error_of(read_pcd, pcd_head("ascii", 9) + "1 2 3 4\n"), "room for"));
  CHECK(contains(error_of(read_pcd, pcd_head("ascii", 1) + "1 2 3\n          "), "3 values"));
  CHECK(contains(error_of(read_pcd, pcd_head("ascii", 1) + "1 2 3x 4\n"), "line 12: '3x'"));
  CHECK(contains(error_of(read_pcd, pcd_head("binary", 2000000000)), "room for 0"));
  CHECK(contains(error_of(read_pcd, pcd_head("ascii", 1) + "nan 1 2 3\n"), "finite"));
  CHECK(contains(error_of(read_pcd, pcd_head("ascii", 0)), "no points"));
}

TEST_CASE("las: all versions and formats -> positions and colours") {
  for (unsigned minor = 0; minor <= 4; ++minor) {
    for (unsigned format = 0; format <= 10; ++format) {
      CAPTURE(minor);
      CAPTURE(format);
      const std::string file =
          las(minor, format, {{2, 4, -6, 65535, 0, 32768}, {1, 1, 1, 1, 2, 3, true}, {7, 8, 9}});
      CHECK(find_reader("", file) != nullptr);
      const auto points = read_points(read_las, file);
      REQUIRE(points.size() == 2);
      CHECK(points[0].x == 101);
      CHECK(points[0].y == 2);
      CHECK(points[0].z == -13);
      CHECK(points[1].line == 3);
      const bool has_color =
          format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
      CHECK(points[0].color == (has_color ? Rgb{255, 0, 128} : Rgb{}));
      CHECK(cloud_has_color(read_las, file) == has_color);
    }
  }
  CHECK_FALSE(cloud_has_color(read_las, las(2, 2, {{0, 0, 0}})));
  CHECK(accepted_lengths(read_las, las(2, 3, {{2, 4, 6}, {1, 2, 3}})).empty());
}

TEST_CASE(
    "las: colours of 8, 12 and 16 bits -> bytes by the greatest of the file; what is guessed is noted") {
  for (const auto& [each_red, green, wanted] :
       std::vector<std::tuple<std::uint16_t, std::uint16_t, Rgb>>{{255, 128, {255, 128, 0}},
                                                                  {4080, 2040, {255, 128, 0}},
                                                                  {4095, 0, {255, 0, 0}},
                                                                  {65535, 4080, {255, 16, 0}}}) {
    const auto& red = each_red;
    CAPTURE(red);
    const std::string file = las(2, 2, {{0, 0, 0, red, green, 0}});
    CHECK(read_points(read_las, file)[0].color == wanted);
    CHECK(notes_hold(source_of(read_las, file), "12 bits") == (red == 4080 || red == 4095));
    CHECK((red != 65535 || notes_of(source_of(read_las, file)).empty()));
    const auto of_bytes = [](const SharedBytes& bytes, const ReadOptions& options, const Progress& progress) {
      ReadOptions stated = options;
      stated.full_color = 255;
      return read_las(bytes, stated, progress);
    };
    CHECK(read_points(of_bytes, file)[0].color.r == 255);  // what is above is full
  }
}

TEST_CASE("las: compressed, damaged, hostile -> a sentence") {
  const auto changed = [](std::size_t at, const std::string& bytes) {
    return error_of(read_las, las(2, 3, {{2, 4, 6}}).replace(at, bytes.size(), bytes));
  };
  CHECK(contains(changed(104, "\x83"), "no record says how"));
  CHECK(contains(changed(104, "\x0B"), "format 11"));
  CHECK(contains(changed(107, little(0xFFFFFFFF, 4)),
                 "4294967295 points, but from byte offset 227 on the file has room for 1"));
  CHECK(contains(changed(105, little(20, 2)), "at least 34"));
  CHECK(contains(changed(131, little(std::nan(""))), "point 1 is not finite"));
  CHECK(contains(error_of(read_las, las(4, 6, {{2, 4, 6}}).replace(247, 8, little(UINT64_MAX, 8))),
                 "room for 1"));
  CHECK(contains(error_of(read_las, las(2, 0, {})), "no points"));
  CHECK(contains(error_of(read_las, las(2, 0, {{1, 1, 1, 0, 0, 0, true}})), "withheld"));
  CHECK(contains(error_of(read_las, "text"), "LASF"));
}

TEST_CASE("stl: text and binary -> the same triangles, z up") {
  const std::string text =
      "solid a b\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 0.5\n"
      "  endloop\n endfacet\nendsolid\nsolid empty\nendsolid\n";
  const std::string binary = stl("a box", 1, stl_triangle({0, 0, 0, 1, 0, 0, 0, 1, 0.5F}));
  const std::string named_solid =
      stl("solid, says the exporter", 1, stl_triangle({0, 0, 0, 1, 0, 0, 0, 1, 0.5F}));
  CHECK(looks_like_stl(text));
  CHECK_FALSE(looks_like_stl(binary));
  for (const std::string& file : {text, binary, named_solid}) {
    const TriangleMesh mesh = read_mesh(read_stl, file);
    CHECK(mesh.is_z_up);
    REQUIRE(mesh.triangles.size() == 1);
    CHECK(mesh.positions[mesh.triangles[0][2]] == std::array<double, 3>{0, 1, 0.5});
  }
  CHECK(accepted_lengths(read_stl, binary).empty());
  for (const std::size_t length : accepted_lengths(read_stl, text)) {
    CHECK(length >= text.find("endfacet") + 8);
  }
  CHECK(contains(error_of(read_stl, stl("x", 0xFFFFFFFF, "")),
                 "4294967295 triangles, but the file has room for 0"));
  CHECK(contains(error_of(read_stl, stl("x", 0, "")), "no triangles"));
  CHECK(contains(error_of(read_stl, stl("x", 1, stl_triangle({NAN, 0, 0, 1, 0, 0, 0, 1, 0}))), "triangle 0"));
  CHECK(contains(error_of(read_stl, "solid\nfacet\nvertex 1 2 3\nendfacet\n"),
                 "line 4: the facet has 1 corners"));
  CHECK(contains(error_of(read_stl, "solid\nfacet\nvertex 1 2 x\n"), "line 3: z is 'x'"));
  CHECK(contains(error_of(read_stl, "solid\nvertex 1 2 3\n"), "outside of any facet"));
}

TEST_CASE("gltf: embedded, binary and beside -> the same triangle with its transforms and colour") {
  const std::string nodes = R"([{"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[2,3,1],)"
                            R"("rotation":[0,0,0.7071067811865476,0.7071067811865476]}])";
  const std::string red = R"({"pbrMetallicRoughness":{"baseColorFactor":[1,0,0.21404114,1]}})";
  const std::string embedded = gltf_json(kTriangleData, nodes, red);
  const std::string binary = glb(gltf_json("", nodes, red), triangle_buffer());
  for (const std::string& file : {embedded, binary}) {
    CHECK(looks_like_gltf(file));
    const TriangleMesh mesh = read_mesh(read_gltf, file);
    REQUIRE(mesh.triangles.size() == 1);
    CHECK(mesh.colors[0] == Rgb{255, 0, 127});
    // (1,0,0) scaled by 2, turned a quarter about z, moved by 10.
    CHECK(std::fabs(mesh.positions[1][0] - 10) < 1e-12);
    CHECK(std::fabs(mesh.positions[1][1] - 2) < 1e-12);
    CHECK(std::fabs(mesh.positions[2][0] - 4) < 1e-12);
  }
  for (const std::size_t length : accepted_lengths(read_gltf, binary)) {
    CHECK(length > binary.size() - 7);  // the buffer's padding
  }
  CHECK(accepted_lengths(read_gltf, embedded).empty());

  const thimble::tests::TemporaryFolder folder;
  folder.write("a b.bin", triangle_buffer());
  const std::string path = folder.write("scene.gltf", gltf_json("a%20b.bin", nodes));
  const Source source = read_scene_file({path});
  CHECK(std::get<TriangleMesh>(source).triangles.size() == 1);
  CHECK(std::get<TriangleMesh>(source).colors.empty());
}

TEST_CASE("gltf: what leaves its place, is not there or comes round again -> a sentence") {
  const std::string node = R"([{"mesh":0}])";
  for (const char* uri : {"../a.bin", "/etc/passwd", "http://a/b.bin", "a/../../b.bin"}) {
    INFO(std::string(uri));
    CHECK(contains(error_of([](const SharedBytes& file, const ReadOptions&,
                               const Progress& p) { return read_gltf(file, {"/tmp/x.gltf"}, p); },
                            gltf_json(uri, node)),
                   "no file in the folder"));
  }
  CHECK(contains(error_of(read_gltf, gltf_json("data:;base64,AAAA", node)), "not in its buffer of 3"));
  CHECK(contains(error_of(read_gltf, gltf_json("data:;base64,!!!!", node)), "base64"));
  CHECK(contains(error_of(read_gltf, gltf_json(kTriangleData, R"([{"children":[0],"mesh":0}])")), "node"));
  CHECK(contains(error_of(read_gltf, gltf_json(kTriangleData, R"([{"children":[7]}])")), "node 0"));
  CHECK(contains(error_of(read_gltf, gltf_json(kTriangleData, R"([{"mesh":4}])")), "no entry 4"));
  CHECK(contains(error_of(read_gltf, gltf_json(kTriangleData, R"([{}])")), "neither triangles nor points"));
  CHECK(contains(error_of(read_gltf, gltf_json(kTriangleData, node, "{}", R"(,"mode":"x")")), "mode"));
  CHECK(contains(error_of(read_gltf, gltf_json(kTriangleData, R"([{"mesh":0,"matrix":[1,2]}])")),
                 "16 numbers"));
  CHECK(contains(
      error_of(read_gltf,
               gltf_json(kTriangleData, R"([{"mesh":0,"scale":[1e308,1e308,1],"translation":[1e999,0,0]}])")),
      "JSON"));
  CHECK(contains(error_of(read_gltf, "{\"asset\":{}}"), "neither"));
  CHECK(contains(error_of(read_gltf, "{\"asset\":"), "broken at its byte"));
  CHECK(contains(error_of(read_gltf, "{" + std::string(1000, '[')), "deeper"));
  CHECK(contains(error_of(read_gltf, "{\"a\":[" + std::string(600000, ',')), "values"));
  CHECK(contains(error_of(read_gltf, "text"), "glTF"));
  CHECK(contains(error_of(read_gltf, "glTF" + little(1, 4) + little(0, 4)), "version 1"));
  // A mesh placed very often costs few bytes in the file and is limited by them.
  std::string many = "[{\"children\":[";
  std::string rest;
  for (int i = 1; i <= 150000; ++i) {
    many += (i > 1 ? "," : "") + std::to_string(i);
    rest += ",{\"mesh\":0}";
  }
  CHECK(outcome_of(read_gltf, gltf_json(kTriangleData, many + "]}" + rest + "]")) == 450000);
}

TEST_CASE(
    "gltf: an extension that is required and not known -> refused by its name; looks alone are no reason") {
  const auto file = [](const std::string& names) {
    return glb(gltf_with("\"extensionsRequired\":[" + names + "],", "", "", R"([{"mesh":0}])"),
               triangle_buffer());
  };
  CHECK(contains(error_of(read_gltf, file(R"("KHR_texture_transform","EXT_none")")), "extension 'EXT_none'"));
  CHECK(contains(error_of(read_gltf, file("7")), "extension ''"));
  CHECK(error_of(read_gltf, file("\"" + std::string(5000, 'x') + "\"")).size() < 300);
  const auto notes = [&](const std::string& names) {
    const TriangleMesh mesh = read_mesh(read_gltf, file(names));
    CHECK(mesh.triangles.size() == 1);
    return mesh.notes;
  };
  CHECK(notes(R"("KHR_materials_unlit","KHR_mesh_quantization")").empty());
  CHECK(contains(error_of(read_gltf, file(R"("KHR_materials_none")")), "extension 'KHR_materials_none'"));
  CHECK(notes(R"("KHR_lights_punctual")") ==
        Notes{"what it says by the extension 'KHR_lights_punctual' is not drawn"});
  CHECK(notes(R"("KHR_texture_basisu","KHR_materials_clearcoat","KHR_lights_punctual")") ==
        Notes{"what it says by the extension 'KHR_lights_punctual' and 2 more is not drawn"});
}

TEST_CASE("gltf: what a file has and is not drawn -> a note each; another version -> refused") {
  const auto notes = [](const std::string& more, const std::string& accessors, const std::string& from,
                        const std::string& to) {
    std::string json = gltf_with(more, accessors, "", R"([{"mesh":0}])");
    REQUIRE(contains(json, from));
    json.replace(json.find(from), from.size(), to);
    return read_mesh(read_gltf, glb(json, triangle_buffer())).notes;
  };
  const std::string part = R"("primitives":[)";
  CHECK(notes("", "", part, part).empty());
  CHECK(notes(R"("extensionsUsed":["KHR_materials_transmission"],)", "", part, part) ==
        Notes{"what it says by the extension 'KHR_materials_transmission' is not drawn"});
  CHECK(notes("", "", part, part + R"({"mode":1,"attributes":{"POSITION":0}},)") ==
        Notes{"the lines of 1 primitive are not drawn"});
  CHECK(notes("", "", part, part + R"({"mode":0,"attributes":{"POSITION":0}},)") ==
        Notes{"the points beside triangles of 1 primitive are not drawn"});
  CHECK(notes("", "", part, part + R"({"targets":[{}],"attributes":{"POSITION":0}},)") ==
        Notes{"the morph targets of 1 primitive are not drawn"});
  const std::string two = R"(,{"bufferView":0,"componentType":5126,"count":2,"type":"VEC3"})";
  CHECK(notes("", two, R"("POSITION":0)", R"("POSITION":0,"COLOR_0":2)") ==
        Notes{"the colors, which not all vertices have, of 1 primitive are not drawn"});
  const std::string four = R"(,{"bufferView":0,"componentType":5121,"count":4,"type":"SCALAR"})";
  CHECK(notes("", four, R"("indices":1)", R"("indices":2)") ==
        Notes{"the last corners, too few for a triangle, of 1 primitive are not drawn"});
  CHECK(contains(error_of(read_gltf, R"({"asset":{"version":"1.0"},"meshes":{"a":{}}})"), "version '1.0'"));
}

TEST_CASE("gltf: instances of a mesh -> all of them, each in its place") {
  std::string binary = triangle_buffer();
  for (const float number : {0.0F, 0.0F, 5.0F, 1.0F, 0.0F, 0.0F, 2.0F, 2.0F, 2.0F, 1.0F, 1.0F, 1.0F}) {
    binary += little(number);
  }
  const std::string accessors =
      R"(,{"bufferView":1,"componentType":5126,"count":2,"type":"VEC3"},)"
      R"({"bufferView":1,"byteOffset":24,"componentType":5126,"count":2,"type":"VEC3"})";
  const std::string views = R"(,{"buffer":0,"byteOffset":48,"byteLength":48})";
  const auto node = [](const std::string& attributes) {
    return R"([{"mesh":0,"translation":[10,0,0],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":)" +
           attributes + "}}}]";
  };
  const auto file = [&](const std::string& attributes) {
    return glb(
        gltf_with(R"("extensionsRequired":["EXT_mesh_gpu_instancing"],)", accessors, views, node(attributes)),
        binary);
  };
  const TriangleMesh mesh = read_mesh(read_gltf, file(R"({"TRANSLATION":2,"SCALE":3})"));
  REQUIRE(mesh.triangles.size() == 2);
  CHECK(mesh.positions[1] == std::array<double, 3>{12, 0, 5});
  CHECK(mesh.positions[2] == std::array<double, 3>{10, 4, 5});
  CHECK(mesh.positions[4] == std::array<double, 3>{12, 0, 0});
  CHECK(
      contains(error_of(read_gltf, file(R"({"ROTATION":2})")), "ROTATION of its instances has 3 components"));
  CHECK(contains(error_of(read_gltf, file(R"({"TRANSLATION":0,"SCALE":3})")), "3 and 2 values"));
}

TEST_CASE("gltf: sparse accessors, and those without bytes -> their values; hostile ones -> a sentence") {
  const std::string binary = triangle_buffer() + little(2, 2) + little(1, 2) + little(7.0F) + little(8.0F) +
                             little(9.0F) + little(4.0F) + little(5.0F) + little(6.0F);
  const auto file = [&](const std::string& base, const std::string& count, const std::string& changed = "2") {
    std::string json = gltf_with(
        "",
        ",{" + base + R"("componentType":5126,"count":)" + count + R"(,"type":"VEC3","sparse":{"count":)" +
            changed +
            R"(,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":1,"byteOffset":4}}})",
        R"(,{"buffer":0,"byteOffset":48,"byteLength":28})", R"([{"mesh":0}])");
    json.replace(json.find(R"("POSITION":0)"), 12, R"("POSITION":2)");
    return glb(json, binary);
  };
  using Place = std::array<double, 3>;
  const TriangleMesh mesh = read_mesh(read_gltf, file(R"("bufferView":0,)", "3"));
  CHECK(mesh.positions == std::vector<Place>{{0, 0, 0}, {4, 5, 6}, {7, 8, 9}});
  CHECK(read_mesh(read_gltf, file("", "3")).positions == mesh.positions);  // of zeros
  CHECK(contains(error_of(read_gltf, file("", "2")), "sparse value 0 has the index 2"));
  CHECK(contains(error_of(read_gltf, file("", "3", "3")), "not in its buffer view"));
  CHECK(
      contains(error_of(read_gltf, file("", "999999999999")), "sparse or compressed values take more than"));
}

TEST_CASE(
    "gltf: a file that is named many times -> read and counted once; one that is none -> not waited for") {
  const thimble::tests::TemporaryFolder folder;
  folder.write("a.bin", std::string(1000, 'a'));
  std::string json = R"({"asset":{},"bufferViews":[)";
  for (int i = 0; i < 100; ++i) {
    json += (i > 0 ? "," : "") + (R"({"buffer":)" + std::to_string(i) + R"(,"byteLength":1000})");
  }
  json += "],\"buffers\":[";
  for (int i = 0; i < 100; ++i) {
    json += std::string(i > 0 ? "," : "") + R"({"uri":")" + (i % 2 == 0 ? "a.bin" : "./a.bin") + "\"}";
  }
  GltfFile file(SharedBytes::own(json + "]}"), folder.path("x.gltf"));
  for (std::uint64_t i = 0; i < 100; ++i) {
    CHECK(file.buffer_view(i).data() == file.buffer_view(0).data());
  }
  CHECK(file.most_bytes() == 3 * (json.size() + 2 + 1000) + (64U << 20));
  REQUIRE(mkfifo(folder.path("pipe").c_str(), 0600) == 0);
  SharedBytes bytes;
  CHECK(file.link("pipe", "buffer 0", bytes).ends_with(" is no regular file"));
  CHECK(file.link("none/.././a.bin", "buffer 0", bytes).empty());
  for (const char* const outside :
       {"", ".", "a/..", "../x/a.bin", "a/../../x", "/a.bin", "file://a.bin", "%2e%2e/a"}) {
    CHECK(file.link(outside, "buffer 0", bytes).ends_with(" is no file in the folder of this one"));
  }
}
