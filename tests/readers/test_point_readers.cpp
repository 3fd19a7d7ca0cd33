// Readers of point clouds: .ply without faces, .xyz and .csv, Gadget-1 snapshots; and the table of readers.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <string>

#include "readers/formats.h"
#include "readers/read_any.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"

using namespace thimble::tools;
using namespace thimble::tools::test;

namespace {

std::string packed(std::uint64_t bits, std::size_t size, bool is_big) {
  return is_big ? thimble::tests::big(bits, size) : thimble::tests::little(bits, size);
}
std::string packed(float value, bool big) {
  return packed(std::bit_cast<std::uint32_t>(value), 4, big);
}
std::string packed(double value, bool big) {
  return packed(std::bit_cast<std::uint64_t>(value), 8, big);
}

std::string record(const std::string& data, bool big = false) {
  return packed(data.size(), 4, big) + data + packed(data.size(), 4, big);
}

/// A snapshot with as many particles of each type as asked for, at (i, i + 0.5, -i).
std::string snapshot(const std::array<std::uint32_t, 6>& counts, bool doubles = false, bool big = false) {
  std::string header;
  std::uint32_t total = 0;
  for (const std::uint32_t count : counts) {
    header += packed(count, 4, big);
    total += count;
  }
  header.resize(256);
  std::string positions;
  for (std::uint32_t i = 0; i < total; ++i) {
    const auto place = static_cast<double>(i);
    for (const double value : {place, place + 0.5, -place}) {
      positions += doubles ? packed(value, big) : packed(static_cast<float>(value), big);
    }
  }
  return record(header, big) + record(positions, big) + record(positions, big) + record("ids.", big);
}

bool is_at(const CloudPoint& point, double x, double y, double z) {
  return point.x == x && point.y == y && point.z == z;
}

}  // namespace

TEST_CASE(
    "xyz: a catalogue of stars by the names of its columns -> places; those without a distance are left "
    "out") {
  const auto near = [](const CloudPoint& point, double x, double y, double z) {
    return std::fabs(point.x - x) + std::fabs(point.y - y) + std::fabs(point.z - z) < 1e-9;
  };
  const auto notes = [](const std::string& text) { return notes_of(source_of(read_xyz, text)); };
  const std::string hours = "id,ra,dec,dist\n1,0,0,2\n2,6,0,3\n3,12,-90,4\n4,18,30,0\n5,24,0,1\n";
  const auto places = read_points(read_xyz, hours);
  REQUIRE(places.size() == 4);
  CHECK(near(places[0], 2, 0, 0));
  CHECK(near(places[1], 0, 3, 0));
  CHECK(near(places[2], 0, 0, -4));
  CHECK(near(places[3], 1, 0, 0));
  CHECK(contains(notes(hours)[0], "right ascensions are hours"));
  CHECK(contains(notes(hours)[0], "1 of 5 have none"));
  const std::string degrees =
      "source_id;RA_ICRS;DE_ICRS;Plx\n7;90;0;10\n8;0;60;1\n9;180;0;-3\n10;10;10;\n11;10;10;null\n12;10;;5\n";
  const auto far = read_points(read_xyz, degrees);
  REQUIRE(far.size() == 2);
  CHECK(near(far[0], 0, 100, 0));
  CHECK(near(far[1], 500, 0, 500 * std::sqrt(3)));
  CHECK(contains(notes(degrees)[0], "degrees, distances are 1000 / parallax; 4 of 6"));
  CHECK(near(read_points(read_xyz, "ra dec\n90 0\n270 0\n")[1], 0, -1, 0));
  const auto galaxy =
      read_points(read_xyz, "Name;RA;Dec;Const\nA;06:00:00;-90:00:00;x\nB;;;y\nC;00:30:00.0;+00:00:00;z\n");
  REQUIRE(galaxy.size() == 2);
  CHECK(near(galaxy[0], 0, 0, -1));
  CHECK(near(galaxy[1], std::cos(std::acos(-1.0) / 24), std::sin(std::acos(-1.0) / 24), 0));
  for (const char* word : {"1:2:3:4", "1:", ":1", "1:-2", "1:x", "--1:2"}) {
    CHECK(contains(error_of(read_xyz, std::string("ra,dec\n") + word + ",0\n"), "line 2"));
  }
  const std::string quoted = "ra;dec;note\n0;0;\"far; \"\"very; far\"\"\"\n\"90\";0;near\n";
  CHECK(contains(error_of(read_xyz, quoted), "line 3: x is '\"90\"'"));
  CHECK(read_points(read_xyz, quoted.substr(0, quoted.find("\"90"))).size() == 1);
  // Where there are places as well, they are what is meant.
  CHECK(near(read_points(read_xyz, "ra,dec,x,y,z\n90,0,1,2,3\n")[0], 1, 2, 3));
  CHECK(contains(error_of(read_xyz, "ra,dec,plx\n1,2,0\n"), "no point of the file is finite"));
  CHECK(contains(error_of(read_xyz, "ra,dec,plx\n1,2,x\n"), "line 2"));
}

TEST_CASE("xyz: blanks, tabs, commas and semicolons -> the same points") {
  for (const char* text :
       {"1 2.5 -3\n4 5 6e2\n", "1\t2.5\t-3\n4\t5\t6e2", "1,2.5,-3\r\n4,5,6e2\r\n", "1;2.5;-3\r4;5;6e2\r",
        " 1 , 2.5 ,\t-3 ,\n\n+4,+5, +6e+2 # six hundred\n", "1, 2.5, -3\n4, 5, 600\n",
        "1 ;2.5; -3;\n4;5;600\n", "  1.000,  2.500, -3.000\n  4.000,  5.000,600.000\n",
        "\xEF\xBB\xBF+1 2.5 -3\n# a comment\n4 5 600"}) {
    INFO(std::string(text));
    const auto points = read_points(read_xyz, text);
    REQUIRE(points.size() == 2);
    CHECK(is_at(points[0], 1, 2.5, -3));
    CHECK(is_at(points[1], 4, 5, 600));
    CHECK(points[0].color == Rgb{});
    CHECK(points[0].line == 1);
  }
}

TEST_CASE("xyz: lines -> points carry the line they stand on") {
  const auto points = read_points(read_xyz, "# head\n\nx y z\n1 2 3\n\n4 5 6\r\n7 8 9");
  REQUIRE(points.size() == 3);
  CHECK(points[0].line == 4);
  CHECK(points[1].line == 6);
  CHECK(points[2].line == 7);
}

TEST_CASE("xyz: six columns -> colours only when all of them are bytes") {
  const auto colored = read_points(read_xyz, "0 0 0 255 0 7\n1 1 1 0 128 255\n");
  CHECK(colored[0].color == Rgb{255, 0, 7});
  CHECK(colored[1].color == Rgb{0, 128, 255});
  CHECK(cloud_has_color(read_xyz, "0 0 0 255 0 7\n"));
  for (const char* text : {"0 0 0 255 0 7\n1 1 1 0 128 256\n", "0 0 0 255 0 7\n1 1 1 0.5 1 2\n",
                           "0 0 0 255 0 7\n1 1 1 -1 1 2\n", "0 0 0 a b c\n", "0 0 0 1 2\n"}) {
    INFO(std::string(text));
    CHECK_FALSE(cloud_has_color(read_xyz, text));
    CHECK(read_points(read_xyz, text)[0].color == Rgb{});
  }
}

TEST_CASE("xyz: decimal commas or mixed separators -> an error that names the line") {
  for (const char* text :
       {"x;y;z\n1,5;2;3\n", "x;y;z\n1,5;2,5;3,5\n", "x y z\n1,5 2,5 3,5\n", "x\ty\tz\n1,5\t2,5\t3,5\n",
        "x y z\n1,2,3\n", "x,y,z\n1;2;3\n", "x, y, z\n1,5, 2,5, 3,5\n", "1 2 3\n1,5 2,5 3,5\n",
        "1 2 3\n1,2,3\n", "1;2;3\n1,2;3\n", "1;2;3\n1;2,5;3\n", "1,2,3\n1;2;3\n", "1,2,3\n1,2;3\n",
        "1,2,3\n4,5 6\n", "a title\n1,5 2,5 3,5\n", "a;b;c\n1;2,5;3\n"}) {
    INFO(std::string(text));
    CHECK(contains(error_of(read_xyz, text), "line 2: "));
  }
  for (const char* text : {"1,5 2,5 3,5\n", "1,5\t2,5\t3,5\n", "1,5;2;3\n", "1;2;3,5\n", "1,5, 2,5, 3,5\n",
                           "-1,5, 2, 3\n", "1,2;3\n", "1,2 3\n"}) {
    INFO(std::string(text));
    CHECK(contains(error_of(read_xyz, text), "line 1: "));
  }
  CHECK(error_of(read_xyz, "x y z\n1,5 2,5 3,5\n") ==
        "line 2: x is '1,5', which is not a number with a decimal point (the columns of this file are "
        "separated "
        "by blanks)");
  CHECK(is_at(read_points(read_xyz, "// x, y, z\n1,2,3\n")[0], 1, 2, 3));
  CHECK(is_at(read_points(read_xyz, "1,2,3, 40,50,60\n")[0], 1, 2, 3));
  CHECK(is_at(read_points(read_xyz, "1,2, 3\n")[0], 1, 2, 3));
  CHECK(is_at(read_points(read_xyz, "x,y,z,i\n100,  2,113,  0\n")[0], 100, 2, 113));
}

TEST_CASE("xyz: a line with another number of columns -> an error that names both lines") {
  CHECK(error_of(read_xyz, "1 2 3 4\n\n1 2 3\n") == "line 3: 3 columns, but line 1 has 4");
  CHECK(error_of(read_xyz, "x,y,z\n1,2,3\n1,2,3,4\n") == "line 3: 4 columns, but line 1 has 3");
  CHECK(error_of(read_xyz, "x y z\n7 1 2 3\n") == "line 2: 4 columns, but line 1 has 3");
  CHECK(contains(error_of(read_xyz, "0 0 0 255 0 7\n1 1 1 1 2\n"), "line 2: 5 columns"));
  CHECK(read_points(read_xyz, "a title of five words\n1 2 3\n4 5 6\n").size() == 2);
  CHECK(read_points(read_xyz, "x,y,z,name\n1,2,3,\n4,5,6,big dog\n").size() == 2);
  CHECK(read_points(read_xyz, "x,y,z,\n1,2,3,\n4,5,6\n").size() == 2);
}

TEST_CASE("xyz: a header that names columns -> they are found wherever they are") {
  const auto points = read_points(read_xyz, "\"id\",B,G,R,\"Z\",'Y',X,name\nfirst,1,2,3,30,20,10,\n");
  REQUIRE(points.size() == 1);
  CHECK(is_at(points[0], 10, 20, 30));
  CHECK(points[0].color == Rgb{3, 2, 1});
  CHECK(read_points(read_xyz, "//X Y Z Red Green Blue\n1 2 3 9 8 7\n")[0].color == Rgb{9, 8, 7});
  CHECK(is_at(read_points(read_xyz, "// z y x\n1 2 3\n")[0], 3, 2, 1));
  CHECK(is_at(read_points(read_xyz, "east north height\n1 2 3\n")[0], 1, 2, 3));
  // Named normals are no colours, though they are bytes.
  CHECK_FALSE(cloud_has_color(read_xyz, "x,y,z,nx,ny,nz\n1,2,3,0,1,0\n"));
}

TEST_CASE("xyz: named colours -> bytes, fractions of 1 or 16 bits") {
  CHECK(read_points(read_xyz, "x y z r g b\n1 2 3 1 0.5 0\n")[0].color == Rgb{255, 128, 0});
  CHECK(read_points(read_xyz, "x y z r g b\n1 2 3 1 0 0\n")[0].color == Rgb{255, 0, 0});
  CHECK(read_points(read_xyz, "x y z r g b\n1 2 3 65535 0 257\n")[0].color == Rgb{255, 0, 1});
  CHECK(contains(error_of(read_xyz, "x y z r g b\n1 2 3 1 2 3\n1 2 3 1 2\n"), "line 3"));
  CHECK(contains(error_of(read_xyz, "x y z r g b\n1 2 3 1 -2 3\n"), "line 2"));
  CHECK(contains(error_of(read_xyz, "x y z r g b\n1 2 3 1 2 65536\n"), "65535"));
}

TEST_CASE("xyz: a first line that counts the points -> skipped, and held to its word") {
  CHECK(read_points(read_xyz, "2\n1 2 3\n4 5 6\n").size() == 2);
  CHECK(read_points(read_xyz, "1\nx y z\n1 2 3\n")[0].line == 3);
  CHECK(contains(error_of(read_xyz, "3\n1 2 3\n4 5 6\n"), "announces 3 points, but the file holds 2"));
  CHECK(contains(error_of(read_xyz, "353535235358\n1 2 3\n"), "announces 353535235358"));
  CHECK(contains(error_of(read_xyz, "2\n2\n1 2 3\n"), "line 2"));
  CHECK(contains(error_of(read_xyz, "1\nwater\nOxy 0 0 0\n"), "line 3: x is 'Oxy', which is not a number"));
}

TEST_CASE("xyz: what is no finite number -> an error that names the line") {
  CHECK(contains(error_of(read_xyz, "1 2 -inf\n"), "no point of the file is finite"));
  CHECK(contains(error_of(read_xyz, "1 2 1e999\n"), "no point of the file is finite"));
  CHECK(contains(
      error_of(read_xyz, "Name;Lon;Lat\nIC0001;0;27\n"),
      "line 2: x is 'IC0001', which is not a number (the first three columns are read, since line 1 names no "
      "columns x, y and z)"));
  CHECK(!contains(error_of(read_xyz, "Name;x;y;z\na;0;27;k\n"), "names no"));
  CHECK(contains(error_of(read_xyz, "1 2 3\n\n4 5x 6\n"), "line 3: y is '5x', which is not a number"));
  CHECK(contains(error_of(read_xyz, "1 2 3\n4 5\n"), "line 2: z is missing"));
  CHECK(contains(error_of(read_xyz, "1,,3\n"), "y is missing"));
  CHECK(contains(error_of(read_xyz, "1 2 0x10\n"), "not a number"));
  CHECK(contains(error_of(read_xyz, "1 2 1.#IND\n"), "'1.#IND', which is not a number"));
  CHECK(contains(error_of(read_xyz, "1 2 3\nx y z\n"), "line 2"));
  CHECK(contains(error_of(read_xyz, std::string("1 2 3\n4 5 6\0\n", 13)), "line 2"));
  CHECK(contains(error_of(read_xyz, ""), "no points"));
  CHECK(contains(error_of(read_xyz, "# nothing\n\n"), "no points"));
  CHECK(contains(error_of(read_xyz, "x y z\n"), "no points"));
}

TEST_CASE("xyz: numbers are read to the last bit, whatever their size") {
  const auto points =
      read_points(read_xyz, "0.1 600000.123456789 1e-999\n-1.7976931348623157e308 5e-324 .5\n");
  CHECK(is_at(points[0], 0.1, 600000.123456789, 0));
  CHECK(is_at(points[1], -1.7976931348623157e308, 5e-324, 0.5));
  const std::string tiny = "0." + std::string(400, '0') + "1";
  const std::string huge = std::string(400, '9');
  CHECK(is_at(read_points(read_xyz, tiny + " -" + tiny + " 1")[0], 0, 0, 1));
  CHECK(contains(error_of(read_xyz, "1 2 " + huge), "no point of the file is finite"));
}

TEST_CASE("xyz: every truncated length -> points or a sentence") {
  const std::string whole = "3\nx,y,z,r,g,b\n1,2.5,3e2,1,2,3\n-4,5,6,255,0,9 # end\n\n7,8, 9 ,1,2,3\n";
  CHECK(read_points(read_xyz, whole).size() == 3);
  for (const std::size_t length : accepted_lengths(read_xyz, whole)) {
    CHECK(length > whole.size() - 3);  // Only the last number and the line's end can be cut unnoticed.
  }
}

TEST_CASE("ply: ascii points -> positions, colours and lines") {
  const std::string head =
      "ply\nformat ascii 1.0\ncomment c\nobj_info o\nelement vertex 2\nproperty float x\n"
      "property float32 y\nproperty double z\n";
  const auto plain = read_points(read_ply, head + "end_header\n1 2 3\n\n4 5 6.5\n");
  REQUIRE(plain.size() == 2);
  CHECK(is_at(plain[1], 4, 5, 6.5));
  CHECK(plain[0].line == 9 + 1);
  CHECK(plain[1].line == 9 + 3);
  CHECK(plain[0].color == Rgb{});
  const std::string bytes = "property uchar red\nproperty uchar green\nproperty uint8 blue\nend_header\n";
  CHECK(read_points(read_ply, head + bytes + "1 2 3 255 0 7 4 5 6 1 2 300\n")[1].color == Rgb{1, 2, 255});
  const std::string reals =
      "property float diffuse_red\nproperty float diffuse_green\nproperty double diffuse_blue\nend_header\n";
  CHECK(read_points(read_ply, head + reals + "1 2 3 1 0 0.5\n4 5 6 0 -1 nan\n")[0].color == Rgb{255, 0, 128});
  CHECK(read_points(read_ply, head + reals + "1 2 3 1 0 0.5\n4 5 6 0 -1 nan\n")[1].color == Rgb{0, 0, 0});
  const std::string words = "property ushort r\nproperty ushort g\nproperty uint16 b\nend_header\n";
  CHECK(read_points(read_ply, head + words + "1 2 3 65535 0 257\n4 5 6 0 0 0")[0].color == Rgb{255, 0, 1});
  // Two of three are no colour.
  CHECK_FALSE(cloud_has_color(
      read_ply, head + "property uchar red\nproperty uchar blue\nend_header\n" + "1 2 3 4 5\n1 2 3 4 5\n"));
}

TEST_CASE("ply: header with CRLF or CR -> the same points") {
  const std::string lf =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int8 y\nproperty short z\n"
      "end_header\n-7 8 9\n";
  for (const char* end : {"\n", "\r\n", "\r"}) {
    std::string text;
    for (const char c : lf) {
      text += c == '\n' ? std::string(end) : std::string(1, c);
    }
    const auto points = read_points(read_ply, text);
    REQUIRE(points.size() == 1);
    CHECK(is_at(points[0], -7, 8, 9));
    CHECK(points[0].line == 8);
  }
}

TEST_CASE("ply: a binary body that begins with a line feed, after a header of CRs -> not eaten") {
  std::string text =
      "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty uchar x\rproperty uchar y\r"
      "property uchar z\rend_header\r";
  const auto points = read_points(read_ply, text + "\n\r\n");
  CHECK(is_at(points[0], 10, 13, 10));
}

TEST_CASE("ply: binary of both byte orders, every type, lists before, between and after -> read") {
  for (const bool big : {false, true}) {
    std::string text =
        std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
        " 1.0\nelement camera 1\nproperty list ushort double k\nproperty uchar flag\n"
        "element vertex 2\nproperty double x\nproperty list uchar int skip\nproperty short y\n"
        "property uchar red\nproperty char green\nproperty uint blue\nproperty float z\n"
        "element tail 1\nproperty list int float t\nelement empty 99999999999999\nend_header\n";
    text += packed(std::uint64_t{2}, 2, big) + packed(1.5, big) + packed(2.5, big) + "f";
    text += packed(600000.125, big) + std::string(1, '\2') + packed(std::uint64_t{7}, 4, big) +
            packed(std::uint64_t{8}, 4, big) + packed(static_cast<std::uint64_t>(-2), 2, big) + "\xff\x7f" +
            packed(std::uint64_t{9}, 4, big) + packed(0.25F, big);
    text += packed(-1.0, big) + std::string(1, '\0') + packed(std::uint64_t{513}, 2, big) + "\1\xff" +
            packed(std::uint64_t{0xFFFFFFFF}, 4, big) + packed(-0.5F, big);
    text += packed(std::uint64_t{1}, 4, big) + packed(3.0F, big);
    const auto points = read_points(read_ply, text);
    REQUIRE(points.size() == 2);
    CHECK(is_at(points[0], 600000.125, -2, 0.25));
    CHECK(is_at(points[1], -1, 513, -0.5));
    CHECK(points[0].color == Rgb{255, 127, 9});
    CHECK(points[1].color == Rgb{1, 0, 255});
    CHECK(points[1].line == 2);
    CHECK(accepted_lengths(read_ply, text).empty());
  }
}

TEST_CASE("ply: hostile headers -> a sentence, and no memory for what is only claimed") {
  const std::string begin = "ply\nformat binary_little_endian 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  CHECK(contains(error_of(read_ply, begin + "element vertex 353535235358\n" + xyz + "end_header\n" +
                                        std::string(24, '\0')),
                 "353535235358 of element 'vertex', but the file has room for 2"));
  CHECK(contains(error_of(read_ply, begin + "element vertex 99999999999999999999\n" + xyz + "end_header\n"),
                 "line 3"));
  CHECK(contains(error_of(read_ply, begin + "element vertex -1\n" + xyz + "end_header\n"), "count"));
  CHECK(contains(error_of(read_ply, begin + "element vertex 0\n" + xyz + "end_header\n"), "no vertices"));
  CHECK(contains(error_of(read_ply, begin + "end_header\n"), "no vertices"));
  CHECK(
      contains(error_of(read_ply, begin + "element vertex 9223372036854775807\nend_header\n"), "x, y or z"));
  CHECK(contains(
      error_of(read_ply, begin + "element a 9223372036854775807\nelement vertex 1\n" + xyz + "end_header\n"),
      "1 of element 'vertex', but the file has room for 0"));
  CHECK(contains(error_of(read_ply, begin + "property float x\n"), "before the first element"));
  CHECK(contains(error_of(read_ply, begin + "element vertex 1\nproperty half x\n"), "'half' is unknown"));
  CHECK(contains(error_of(read_ply, begin + "element vertex 1\nproperty list float int x\n"), "length"));
  CHECK(contains(error_of(read_ply, begin + "element vertex 1\n" + xyz + "property int x\n"), "twice"));
  CHECK(contains(error_of(read_ply, begin + "element vertex 1\nelement vertex 1\n"), "twice"));
  CHECK(contains(error_of(read_ply, begin + "element vertex 1\n" + xyz), "end_header"));
  CHECK(contains(error_of(read_ply, "ply\nelement vertex 1\n" + xyz + "end_header\n"), "format"));
  CHECK(contains(error_of(read_ply, "ply\nformat utf8 1.0\n"), "line 2"));
  CHECK(contains(error_of(read_ply, "plyx\n"), "'ply'"));
  CHECK(contains(error_of(read_ply, ""), "'ply'"));
  // A list that is longer than the file.
  CHECK(contains(
      error_of(read_ply, begin + "element vertex 1\n" + xyz + "property list uint double l\nend_header\n" +
                             std::string(12, '\0') + "\xff\xff\xff\xff" + std::string(16, '\0')),
      "4294967295 entries"));
  CHECK(contains(
      error_of(read_ply, begin + "element vertex 1\n" + xyz + "property list char double l\nend_header\n" +
                             std::string(12, '\0') + "\xff"),
      "length of a list"));
}

TEST_CASE("ply: coordinates that are not finite, text that is no number -> the place") {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property float w\nend_header\n";
  CHECK(contains(error_of(read_ply, head + "1 2 inf 4\n1 2 3e400 4\n"), "no vertex of the file is finite"));
  CHECK(contains(error_of(read_ply, head + "1 2 3 4\nabc 2 3 4\n"), "line 10: 'abc' is not a number"));
  CHECK(contains(error_of(read_ply, head + "1 2 3 4.5\n1 2 3.25\n"), "ends before"));
  const Notes notes = notes_of(read_ply(SharedBytes::own(head + "1 2 3 4\n1 2 3 4\n5\n"), {}, {}));
  CHECK(contains(notes.front(), "line 11: '5' and what follows comes after"));
  // What is not used may be anything.
  CHECK(read_points(read_ply, head + "1 2 3 nan\n1 2 3 -1.#IND\n").size() == 2);
  const std::string face = "element face 1\nproperty list uchar int vertex_index\nend_header\n";
  const std::string mesh = head.substr(0, head.find("end_header")) + face;
  CHECK(contains(error_of(read_ply, mesh + "1 2 3 4\n1 nan 3 4\n3 0 1 0\n"),
                 "line 12: a coordinate of vertex 1"));
}

// Gas, halo, disk, bulge, stars, boundary.
constexpr std::array<Rgb, 6> kGadgetColors{
    {{64, 160, 255}, {128, 96, 176}, {255, 208, 112}, {255, 128, 64}, {255, 255, 240}, {96, 208, 128}}};

TEST_CASE("gadget: particles of all types, float and double, both byte orders -> positions and colours") {
  for (const bool doubles : {false, true}) {
    for (const bool big : {false, true}) {
      const std::string file = snapshot({1, 2, 0, 1, 1, 3}, doubles, big);
      CHECK(looks_like_gadget(file));
      const auto points = read_points(read_gadget, file);
      REQUIRE(points.size() == 8);
      constexpr std::array<std::size_t, 8> kTypes{0, 1, 1, 3, 4, 5, 5, 5};
      for (std::size_t i = 0; i < 8; ++i) {
        const auto value = static_cast<double>(i);
        CHECK(is_at(points[i], value, value + 0.5, -value));
        CHECK(points[i].color == kGadgetColors[kTypes[i]]);
        CHECK(points[i].line == i + 1);
      }
    }
  }
}

TEST_CASE("gadget: every truncated length -> refused, but for the ends of whole records") {
  const std::string whole = snapshot({0, 1, 0, 1, 0, 0});
  const std::size_t positions_end = 264 + 2 * 12 + 8;
  CHECK(accepted_lengths(read_gadget, whole) ==
        std::vector<std::size_t>{positions_end, positions_end + 2 * 12 + 8});
}

TEST_CASE("gadget: damaged snapshots -> a sentence that names the place") {
  const std::string whole = snapshot({0, 2, 0, 0, 0, 0});
  const auto changed = [&](std::size_t at, const std::string& bytes) {
    return error_of(read_gadget, std::string(whole).replace(at, bytes.size(), bytes));
  };
  CHECK(contains(changed(4, "\x05"), "counts 7 particles"));  // Gas that is not there.
  CHECK(contains(changed(4, std::string(24, '\xff')), "counts 25769803770 particles"));
  CHECK(contains(changed(260, "\x01"), "its length is 256 before the data and 257 after it"));
  CHECK(contains(error_of(read_gadget, whole.substr(0, 264 + 4 + 24)),
                 "it takes 24 bytes and a marker of 4, but 24 bytes are left"));
  CHECK(contains(changed(268, packed(NAN, false)), "particle 1 is not finite"));
  CHECK(contains(error_of(read_gadget, snapshot({0, 0, 0, 0, 0, 0})), "no particles"));
  CHECK(contains(error_of(read_gadget, record("HEAD1234") + whole), "format 2"));
  CHECK(contains(error_of(read_gadget, "text"), "256"));
  CHECK_FALSE(looks_like_gadget("text"));
}

TEST_CASE("read_any: endings of any case, gz and contents -> the reader") {
  const auto name_of = [](std::string_view path, std::string text) -> std::string {
    const SharedBytes file = SharedBytes::own(std::move(text));
    const ReaderRow* row = find_reader(path, file.text());
    return row == nullptr ? "" : row->endings;
  };
  CHECK(name_of("a/b.PLY", "") == ".ply");
  CHECK(name_of("b.ply.gz", "") == ".ply");
  CHECK(name_of("b.csv", "ply\n") == ".ply");  // what it holds counts for more than its name
  CHECK(name_of("b.obj", "VOX \x96") == ".vox");
  CHECK(name_of("b.Xyz.GZ", "") == ".xyz .csv .txt .tsv .pts");
  CHECK(name_of("snapshot_000", snapshot({1, 0, 0, 0, 0, 0})) == ".dat");
  CHECK(name_of("-", "ply\nformat") == ".ply");
  CHECK(name_of("-", "# c\nCOFF 1 2 3") == ".off");
  CHECK(name_of("ply", "hello") == "");
  CHECK(name_of(".ply", "hello") == "");
  CHECK_THROWS_AS(read_any({"x.bin"}, SharedBytes::own("??")), InputError);
  CHECK_NOTHROW(read_any({"x.xyz"}, SharedBytes::own("1 2 3")));
}

TEST_CASE("progress: rises from 0 to 1, and what it throws stops the reading") {
  std::string text;
  for (int i = 0; i < 100000; ++i) {
    text += "1 2 3.5\n";
  }
  double last = 0;
  int calls = 0;
  read_any({"a.xyz"}, SharedBytes::own(text), [&](double done) {
    CHECK(done >= last);
    CHECK(done <= 1);
    last = done;
    ++calls;
  });
  CHECK(last == 1);
  CHECK(calls >= 3);
  CHECK_THROWS_AS(read_xyz(SharedBytes::own(text), {}, [](double) { throw 7; }), int);
}
