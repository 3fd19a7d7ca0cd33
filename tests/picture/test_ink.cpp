// Ink: black, a pattern and white with outlines, of a picture of tones and one of depths.
#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "golden/scenes.h"
#include "support/formats.h"
#include "thimble/picture/ink.h"

namespace {

using namespace thimble;

/// What is drawn of two pictures, a letter a pixel: depths by '.' for nothing and digits, the higher the nearer.
class Drawing {
 public:
  Drawing(const std::vector<std::string>& tones, const std::vector<std::string>& depths)
      : width_(static_cast<std::int32_t>(tones[0].size())),
        height_(static_cast<std::int32_t>(tones.size())),
        memory_(ink_bytes(width_, height_)) {
    REQUIRE(InkPicture::make(width_, height_, {memory_.data(), memory_.size()}, &ink_) == Status::kOk);
    for (std::int32_t y = 0; y < height_; ++y) {
      for (std::int32_t x = 0; x < width_; ++x) {
        const auto row = static_cast<std::size_t>(y);
        const auto column = static_cast<std::size_t>(x);
        const std::size_t place = row * static_cast<std::size_t>(width_) + column;
        const char depth = depths[row][column];
        ink_.tones().pixels[place] = static_cast<std::uint8_t>((tones[row][column] - '0') * 28);
        ink_.depths().pixels[place] =
            depth == '.' ? std::uint8_t{0} : static_cast<std::uint8_t>(40 + (depth - '0') * 20);
      }
    }
    ink_.finish();
  }

  std::vector<std::string> rows() const {
    std::vector<std::uint8_t> shown(band_bytes(PixelFormat::kGray8, width_, height_));
    REQUIRE(ink_.store({{shown.data(), shown.size()}, PixelFormat::kGray8, 0, 0, height_}) == Status::kOk);
    std::vector<std::string> rows(static_cast<std::size_t>(height_));
    for (std::size_t i = 0; i < shown.size(); ++i) {
      REQUIRE((shown[i] == 0 || shown[i] == 255));
      rows[i / static_cast<std::size_t>(width_)] += shown[i] == 0 ? '.' : '#';
    }
    return rows;
  }
  const InkPicture& ink() const { return ink_; }

 private:
  std::int32_t width_;
  std::int32_t height_;
  std::vector<std::uint8_t> memory_;
  InkPicture ink_;
};

}  // namespace

TEST_CASE("ink limits: one dark face among others, lines round what stands before black") {
  // A bright, a middling and a dark face, four pixels wide each, all as far away.
  const std::vector<std::string> tones(6, "99999955550000");
  const std::vector<std::string> depths{"..............", ".555555555555.", ".555555555555.",
                                        ".555555555555.", ".555555555555.", ".............."};
  const auto rows = Drawing(tones, depths).rows();
  CHECK(rows[0] == "..............");
  CHECK(rows[1] == ".############.");
  CHECK(rows[2].substr(0, 6) == ".#####");  // white
  CHECK(rows[2].substr(6, 4) == "#.#.");    // the checker of even rows
  CHECK(rows[3].substr(6, 4) == ".#.#");    // and of odd ones
  CHECK(rows[2].substr(10, 4) == "..#.");   // black within its outline
  CHECK(rows[5] == "..............");
}

TEST_CASE("ink limits: what stands before something else is parted from it by a line each") {
  // A square far in front of a wall, both of one tone; the least jump is a sixteenth of the depth that is seen.
  const std::vector<std::string> tones(9, "999999999");
  std::vector<std::string> depths(9, "111111111");
  for (std::size_t y = 3; y < 6; ++y) {
    depths[y].replace(3, 3, "888");
  }
  const auto rows = Drawing(tones, depths).rows();
  CHECK(rows[1] == "#########");
  CHECK(rows[2] == "###...###");  // the wall's side of the line
  CHECK(rows[4] == "##.###.##");
}

TEST_CASE("ink limits: a slope is no jump, however steep") {
  const std::vector<std::string> tones(5, "999999999");
  const std::vector<std::string> depths(5, "123456789");
  for (const std::string& row : Drawing(tones, depths).rows()) {
    CHECK(row == "#########");
  }
}

TEST_CASE("ink limits: nothing is black, and one tone is white") {
  CHECK(Drawing({"999", "000"}, {"...", "..."}).rows() == std::vector<std::string>{"...", "..."});
  CHECK(Drawing({"000", "000"}, {"555", "555"}).rows() == std::vector<std::string>{"###", "###"});
}

TEST_CASE("ink limits: single pixels of another tone are no faces") {
  std::vector<std::string> tones(7, "9999990000000");
  tones[3][3] = '0';
  tones[2][9] = '9';
  const auto rows = Drawing(tones, std::vector<std::string>(7, "5555555555555")).rows();
  CHECK(rows[3] == rows[1]);
  CHECK(rows[2] == rows[4]);
}

TEST_CASE("ink is the same in every format and in bands of any height, and refuses others") {
  std::vector<std::string> tones;
  std::vector<std::string> depths;
  for (int y = 0; y < 19; ++y) {
    tones.emplace_back();
    depths.emplace_back();
    for (int x = 0; x < 27; ++x) {
      tones.back() += static_cast<char>('0' + (x * 7 + y * y) % 10);
      depths.back() += (x - 13) * (x - 13) + (y - 9) * (y - 9) < 70 ? static_cast<char>('1' + x / 4) : '.';
    }
  }
  const Drawing drawing(tones, depths);
  const auto rows = drawing.rows();
  for (const PixelFormat format : testing::kFormats) {
    std::vector<std::uint8_t> whole(band_bytes(format, 27, 19));
    REQUIRE(drawing.ink().store({{whole.data(), whole.size()}, format, 0, 0, 19}) == Status::kOk);
    for (std::int32_t y = 0; y < 19; ++y) {
      for (std::int32_t x = 0; x < 27; ++x) {
        const std::uint8_t* const row = whole.data() + row_place(format, y) * row_bytes(format, 27);
        CHECK(gray_of(load_pixel(row, x, y, format)) ==
              (rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] == '#' ? 255 : 0));
      }
    }
    std::vector<std::uint8_t> parts;
    for (std::int32_t first = 0; first < 19; first += 8) {
      const std::int32_t count = first + 8 < 19 ? 8 : 19 - first;
      std::vector<std::uint8_t> part(band_bytes(format, 27, count), 0xA5);
      REQUIRE(drawing.ink().store({{part.data(), part.size()}, format, 0, first, count}) == Status::kOk);
      parts.insert(parts.end(), part.begin(), part.end());
    }
    CHECK(parts == whole);
  }
  std::vector<std::uint8_t> bytes(27 * 19);
  CHECK(drawing.ink().store({{bytes.data(), bytes.size()}, PixelFormat::kGray8, 0, 1, 19}) ==
        Status::kBadArgument);
  CHECK(drawing.ink().store({{bytes.data(), bytes.size()}, PixelFormat::kGray8, 26, 0, 19}) ==
        Status::kBadArgument);
  CHECK(drawing.ink().store({{bytes.data(), bytes.size() - 1}, PixelFormat::kGray8, 0, 0, 19}) ==
        Status::kOutOfMemory);
  InkPicture ink;
  CHECK(InkPicture::make(0, 4, {bytes.data(), bytes.size()}, &ink) == Status::kBadArgument);
  CHECK(InkPicture::make(4, kMaxPicturePx + 1, {bytes.data(), bytes.size()}, &ink) == Status::kBadArgument);
  CHECK(InkPicture::make(16, 16, {bytes.data(), ink_bytes(16, 16) - 1}, &ink) == Status::kOutOfMemory);
  CHECK(ink.store({{bytes.data(), 0}, PixelFormat::kGray8, 0, 0, 0}) == Status::kBadArgument);  // never made
}
