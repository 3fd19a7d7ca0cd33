// What plots write for words that may be anything: a scene's name is a file's name.
#include <doctest/doctest.h>

#include <string>

#include "output/plot.h"
#include "output/units.h"

namespace thimble::tools {
namespace {

TEST_CASE("svg words: markup is written otherwise, UTF-8 stays, what is neither becomes U+FFFD") {
  CHECK(xml_text("a<b & \"c\">d") == "a&lt;b &amp; &quot;c&quot;&gt;d");
  CHECK(xml_text("H\xC3\xB6he \xE2\x82\xAC \xF0\x9F\x98\x80") == "H\xC3\xB6he \xE2\x82\xAC \xF0\x9F\x98\x80");
  const std::string other = "\xEF\xBF\xBD";
  CHECK(xml_text("\xFF.scene") == other + ".scene");
  CHECK(xml_text("\xC3") == other);              // cut short
  CHECK(xml_text("\xC3(") == other + "(");       // not continued
  CHECK(xml_text("\xC0\xAF") == other + other);  // a longer form than needed
  CHECK(xml_text("\xE0\x80\xAF") == other + other + other);
  CHECK(xml_text("\xED\xA0\x80") == other + other + other);  // half of a pair of UTF-16
  CHECK(xml_text("\xF4\x90\x80\x80") == other + other + other + other);
  CHECK(xml_text(std::string("a\x01\0b", 4)) == "a" + other + other + "b");
  CHECK(label(1, 2, "middle", "<") == "<text x=\"1.0\" y=\"2.0\" text-anchor=\"middle\">&lt;</text>\n");
}

TEST_CASE("titles: a path -> the file's name; anything else as it is, printable") {
  CHECK(scene_title("/there/castle.vox") == "castle.vox");
  CHECK(scene_title("castle.vox") == "castle.vox");
  CHECK(scene_title("points:10,depth=3") == "points:10,depth=3");
  CHECK(scene_title("there/") == "there/");
  CHECK(scene_title("a/b\n.vox") == "b\\x0a.vox");
  CHECK(scene_title("").empty());
}

TEST_CASE("svg plot: decades far from 1 are powers in plain words, none of its markup is written out") {
  Plot plot;
  plot.title = "a < b";
  plot.x_label = "points";
  plot.y_label = "ms";
  plot.series.push_back({"one", false, {{1, 0.001}, {100000, 20000}}});
  const std::string text = log_plot_text(plot);
  for (const char* label : {">1<", ">1000<", ">0.1<", ">10\u2074<", ">10\u2075<", ">10\u207B\u00B3<"}) {
    CAPTURE(label);
    CHECK(text.find(label) != std::string::npos);
  }
  CHECK(text.find("a &lt; b") != std::string::npos);
  std::size_t written_out = 0;
  for (std::size_t at = text.find("&lt;"); at != std::string::npos; at = text.find("&lt;", at + 1)) {
    ++written_out;
  }
  CHECK(written_out == 1);  // the title's
}

}  // namespace
}  // namespace thimble::tools
