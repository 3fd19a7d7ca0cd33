// Pictures and text on a screen's pixels.
#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "host/canvas.h"

namespace {

using namespace thimble;
using namespace thimble::host;

}  // namespace

TEST_CASE(
    "canvas: a picture that fits -> magnified by a whole number in the middle; else made smaller in "
    "proportion") {
  const Placement large = place(128, 64, 1000, 600, 0);
  CHECK(large.scale == 7);
  CHECK(large.width_px == 896);
  CHECK(large.x_px == 52);
  CHECK(large.y_px == 76);
  CHECK(place(128, 64, 1000, 600, 4).scale == 4);
  const Placement small = place(800, 600, 80, 48, 0);
  CHECK(small.scale == 0);
  CHECK(small.width_px == 64);
  CHECK(small.height_px == 48);
  const Placement flat = place(800, 600, 40, 480, 0);
  CHECK(flat.width_px == 40);
  CHECK(flat.height_px == 30);
  CHECK(place(4000, 1, 10, 10, 0).height_px == 1);
  CHECK(place(128, 64, 0, 10, 0).width_px == 0);
  CHECK(to_picture(-1, 0, 8, 1) == -1);
  CHECK(to_picture(-8, 0, 8, 1) == -1);
  CHECK(to_picture(-9, 0, 8, 1) == -2);
  CHECK(to_picture(7, 0, 8, 1) == 0);
  CHECK(to_picture(8, 0, 8, 1) == 1);
}

TEST_CASE("canvas: a picture made smaller -> the mean of the light that each pixel covers") {
  // A value stands for its square: sqrt((0 + 100^2 + 50^2 + 50^2) / 4) = 61.2, sqrt(255^2 / 4) = 127.5.
  const std::vector<std::uint8_t> rgb{0, 0, 0, 100, 0, 0, 50, 0, 0, 50, 0, 255};
  Canvas canvas;
  canvas.resize(1, 1);
  draw_picture(&canvas, place(2, 2, 1, 1, 0), {rgb.data(), 2, 2}, {});
  CHECK(canvas.pixels[0] == Rgb8{61, 0, 128});
}

TEST_CASE("canvas: text -> every printable character has dots of its own, within its cell") {
  std::vector<std::vector<Rgb8>> glyphs;
  for (char character = 0x20; character < 0x7F; ++character) {
    Canvas canvas;
    canvas.resize(kGlyphWidthPx, kGlyphHeightPx);
    draw_text(&canvas, 0, 0, 1, {255, 255, 255}, std::string(1, character));
    CAPTURE(character);
    const bool is_blank = std::count(canvas.pixels.begin(), canvas.pixels.end(), Rgb8{}) ==
                          static_cast<std::ptrdiff_t>(canvas.pixels.size());
    CHECK(is_blank == (character == ' '));
    CHECK(std::find(glyphs.begin(), glyphs.end(), canvas.pixels) == glyphs.end());
    glyphs.push_back(canvas.pixels);
  }
  const TextSize size = text_size("ab\nabcd\n\nx");
  CHECK(size.columns == 4);
  CHECK(size.lines == 4);
}

TEST_CASE("canvas: a text is folded between words, and within one that is longer than a line") {
  CHECK(folded("the picture is saved as soon", 12) == "the picture\nis saved as\nsoon");
  CHECK(folded("twelve lette", 12) == "twelve lette");
  CHECK(folded("twelve lette rs", 12) == "twelve lette\nrs");
  CHECK(folded("aaaabbbbcccc dd", 4) == "aaaa\nbbbb\ncccc\ndd");
  CHECK(folded("one\ntwo three\n\nfour", 9) == "one\ntwo three\n\nfour");
  CHECK(folded("  indent", 4) == "  in\ndent");
  CHECK(folded("a   b", 2) == "a\nb");
  CHECK(folded("", 4).empty());
  const std::string words =
      "saved spheres-depth-5.png; the same picture by thimble render spheres,depth=5 -o a.png";
  for (std::size_t columns = 1; columns < 90; ++columns) {
    const std::string lines = folded(words, columns);
    CHECK(static_cast<std::size_t>(text_size(lines).columns) <= columns);
    std::string letters;
    std::string wanted;
    std::copy_if(lines.begin(), lines.end(), std::back_inserter(letters),
                 [](char c) { return c != ' ' && c != '\n'; });
    std::copy_if(words.begin(), words.end(), std::back_inserter(wanted), [](char c) { return c != ' '; });
    CHECK(letters == wanted);
  }
}
