// What a baked scene is called.
#include <doctest/doctest.h>

#include <string>

#include "scene/baking.h"

namespace {

using thimble::tools::scene_name;

const std::string kUnknown = "\xEF\xBF\xBD";  // U+FFFD

}  // namespace

TEST_CASE("scene name: a file's name, or the generator as it is written") {
  CHECK(scene_name("/some/where/castle.vox") == "castle.vox");
  CHECK(scene_name("points:100,seed=3") == "points:100,seed=3");
}

TEST_CASE("scene name: any bytes -> UTF-8, what is none of it replaced byte by byte") {
  // One, two, three and four bytes; the first and last characters of each length.
  for (const std::string good : {"a", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xEE\x80\x80",
                                 "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"}) {
    CHECK(scene_name("x" + good + "y") == "x" + good + "y");
    for (std::size_t bytes = 1; bytes < good.size(); ++bytes) {
      std::string expected = "x";
      for (std::size_t i = 0; i < bytes; ++i) {
        expected += kUnknown;
      }
      CHECK(scene_name("x" + good.substr(0, bytes)) == expected);
      CHECK(scene_name("x" + good.substr(0, bytes) + "y") == expected + "y");
    }
  }
  // Latin-1, a lone continuation, longer spellings, surrogates, beyond U+10FFFF.
  CHECK(scene_name("b\xE4r.vox") == "b" + kUnknown + "r.vox");
  CHECK(scene_name("\x80") == kUnknown);
  CHECK(scene_name("\xC0\xAF") == kUnknown + kUnknown);
  CHECK(scene_name("\xE0\x9F\xBF") == kUnknown + kUnknown + kUnknown);
  CHECK(scene_name("\xED\xA0\x80") == kUnknown + kUnknown + kUnknown);
  CHECK(scene_name("\xF0\x8F\xBF\xBF") == kUnknown + kUnknown + kUnknown + kUnknown);
  CHECK(scene_name("\xF4\x90\x80\x80") == kUnknown + kUnknown + kUnknown + kUnknown);
  CHECK(scene_name("\xFF") == kUnknown);
}
