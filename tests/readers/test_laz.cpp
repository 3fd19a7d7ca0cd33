// `.laz`: points as LASzip packs them. The bytes were written by an encoder of its own, after LASzip's specification;
// the real file of the shared data is compared with its `.las` where it is there.
#include <doctest/doctest.h>

#include <string>

#include "readers/formats.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"

namespace thimble::tools::test {
namespace {

constexpr int kPoints = 30;

// From the record that says how they are packed to the end: format 3 with two more bytes a point, chunks of 20.
const char* const kPointwise =
    "00006c61737a697020656e636f6465640000bc563a00000000000000000000000000000000000000000000000000000000000000"
    "000002000000030403000000000014000000ffffffffffffffffffffffffffffffff040006001400020007000800020008000600"
    "02000000020002008103000000000000000000000cfeffff00000000000009020000010000000000000000000000000000000000"
    "d047ad36dfe7fec120f3abc05106d6daa70619eb852bc60a9d01256d7cd4bdb86059d883a283b35bf393fb4c5bf931237ef25251"
    "327cd78b922c1ec074e6e7bdd88fb1a3b23042aac06d29d17b0a20936ca46d9c14555da0390fc0f0fd592757cb9ae7ac7883e1e9"
    "a3f46274b267db07cd9ca89ad1c6fdebc1e37512a3ed56c5804e4890d583b8cdb9958e7f34ad879b7ce49b158619e279fd067a08"
    "18a6874820efadf1482e7d24bc09f1e31217b5210cda2fa636f3483b50f9806d12031cf6babbf429a6b36599c1c1c99ca0d217f1"
    "5aa4f17827cbd35e5db78d1e940b0256ee1b652348acb8240b83e0c880bb34ceeb0206eafa3674ebebc0196e0d69a163055afb4d"
    "9e5df97e21cb36601e972b7639e57b6c15d4acd32edd8c0357022a2c102460a12d80182fdb92328ca4969ea14c1f7a0d214a990c"
    "415d4348d60000006100000016feffff0000000002001b02000201007017000000000000401f000064003c009023b83b2a5e72e5"
    "b5845144ee7a783a1fd380eac5ffa357ffd531c452cebef55ee14891af5e83850b9354aeda781f18e4d682f2d42c3835a773c272"
    "7ca5afa7d2778a62bd7bc3d3191e63847d34afb0529cc840a624b4b515dc01485b7a615daa90608a4cea309ded218d57a3a4c801"
    "99dfab57586a6ee06ad4c266ee526dc0a9d53436c225d8b435a3748ff80f4ccf7b1068033049023059850d000000000000000200"
    "00004b3182db000000";

// Format 7 with layers, two scanners, chunks of 17 and 13.
const char* const kLayered =
    "00006c61737a697020656e636f6465640000bc562e00000000000000000000000000000000000000000000000000000000000000"
    "0000030000000304030000000000ffffffffffffffffffffffffffffffffffffffff02000a001e0003000b000600030000040000"
    "00000000000000000cfeffff00000000000011000200000001000000000000000000000000000000110000004a00000014000000"
    "000000001000000005000000000000000000000000000000060000005a0000001a40845f3a55c74fdaf3a53cb6053b09f54d5cec"
    "1be4bfb047236ea1da0407b9e758d2a5e2f466290318cb169b7d2143611aebd9ed821e1831647aa3e8bf8f53e4f85245673f0a00"
    "000003ef2e32f6ff5acce088b809a6925f6c2c0000000000000000000ffe000000000100000007070707075c395c395c39bf1f5c"
    "387fadfde077fe2bebfec0ef9fef1ff381eeb59f680303a97f7e0fabcb005907e1006d1fb81dffa8ec81703d18a795c92cc7b10d"
    "c0f7208ebbe94f8829887cf8179806074d23ae70a418d34061ffb81edb99d8c50000005700000002000000010000000200331002"
    "01010001008813000000000000901aec1355000d0000003800000016000000000000000d00000005000000000000000000000000"
    "00000006000000440000003e224c6362b0561a4c28eb01ef5b7f0cbe3970de8d4d0abf1ff88bdea7902e100957f82463881e8627"
    "285f3de94f2fb1440fbfb378000000918c885859fee61bdbb8a98e8a6e47fb4ad0c9000000003ff8000000000004000000000707"
    "0707075c395c395c393f056d0b18d836030102c0effefe862781d0c2bfbf9303da773960ae075906bf0e0089c3a83249d7e2ffb0"
    "3a4935538ce07a91078bdec0e8067ce63781efbffef400000000000000020000002abaa8cb83c5000000";

std::string laz(bool is_layered) {
  const std::uint32_t header_bytes = is_layered ? 375 : 227;
  const std::string hex = is_layered ? kLayered : kPointwise;
  std::string out = "LASF" + little(0, 20) + little(1, 1) + little(is_layered ? 4 : 2, 1) + little(0, 68) +
                    little(header_bytes, 2) + little(header_bytes + (is_layered ? 100 : 112), 4) +
                    little(1, 4) + little(is_layered ? 0x87 : 0x83, 1) + little(36, 2) +
                    little(is_layered ? 0 : kPoints, 4) + little(0, 20) + little(0.5) + little(0.5) +
                    little(0.5);
  out.resize(247);
  out += little(kPoints, 8);
  out.resize(header_bytes);
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    out += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  }
  return out;
}

}  // namespace

TEST_CASE("laz: points of both packings -> each where it was, in its colour, without what is withheld") {
  for (const bool is_layered : {false, true}) {
    CAPTURE(is_layered);
    const auto points = read_points(read_las, laz(is_layered));
    REQUIRE(points.size() == 27);
    std::size_t next = 0;
    for (int i = 0; i < kPoints; ++i) {
      if (i % 10 == 9) {
        continue;  // withheld
      }
      CAPTURE(i);
      const CloudPoint& point = points[next++];
      CHECK(point.x == 0.5 * (i * i % 101 * (i % 8 == 0 ? 9000 : 1)));
      CHECK(point.y == 0.5 * (7 * i % 13 - (i % 5 == 0 ? 500 : 0)));
      CHECK(point.z == 0.5 * (i % 4 * (i % 9 == 0 ? 100000 : 1)));
      const auto byte = [](int component) {
        return static_cast<std::uint8_t>((component * 255 + 32767) / 65535);
      };
      CHECK(point.color == (i % 6 == 0 ? Rgb{byte(i), byte(i), byte(i)}
                                       : Rgb{byte(i * 400), byte(i * (i % 2) * 300), byte(i * 5)}));
    }
  }
}

TEST_CASE("laz: cut off, damaged, hostile -> a sentence, or other points; never a crash") {
  for (const bool is_layered : {false, true}) {
    CAPTURE(is_layered);
    const std::string whole = laz(is_layered);
    // What is cut off of the table behind the points is not missed where chunks have one size.
    const auto accepted = accepted_lengths(read_las, whole);
    CHECK((accepted.empty() || (!is_layered && accepted.front() + 40 > whole.size())));
    for (std::size_t at = 227; at < whole.size(); ++at) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
      static_cast<void>(error_of(read_las, damaged));
    }
    std::string many = whole;
    many.replace(is_layered ? 247 : 107, 4, little(0x20000000, 4));
    CHECK(contains(error_of(read_las, many), "believed"));
  }
  std::string old = laz(false);
  old[227 + 54 + 34 + 4] = 1;  // the version of the first item
  CHECK(contains(error_of(read_las, old), "item 6 of version 1"));
}

TEST_CASE("laz: a file that LAStools wrote -> the points of its .las") {
  const std::filesystem::path folder = data_folder();
  if (folder.empty()) {
    return;
  }
  const auto points_of = [&](const char* name) {
    return read_points(read_las, contents_of(folder / "cloud" / name));
  };
  const auto packed = points_of("pdal_simple.laz");
  const auto plain = points_of("pdal_simple.las");
  REQUIRE(packed.size() == plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    CHECK((packed[i].x == plain[i].x && packed[i].y == plain[i].y && packed[i].z == plain[i].z));
    CHECK(packed[i].color == plain[i].color);
  }
}

}  // namespace thimble::tools::test
