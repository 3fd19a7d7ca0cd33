// `thimble render SCENE -o F.html`: what the template of `make web` is filled in with. tests/web/test_share.js looks at the page.
#include <doctest/doctest.h>
#include <zlib.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "support/check_command.h"
#include "support/run_command.h"

namespace {

using namespace thimble::tests;

constexpr const char* kTemplate =
    "<title>{{title}}</title>\n{{description}}\n{{version}}\n{{colors}}\n{{turn}}\n{{background}}\n"
    "{{ground}}\n{{preview}}\n{{scenes}}end\n";

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  REQUIRE(text.size() % 4 == 0);
  std::string bytes;
  for (std::size_t at = 0; at < text.size(); at += 4) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t digit = digits.find(text[at + i]);
      word = word << 6 | static_cast<std::uint32_t>(digit == std::string::npos ? 0 : digit);
    }
    bytes +=
        {static_cast<char>(word >> 16), static_cast<char>(word >> 8 & 255U), static_cast<char>(word & 255U)};
  }
  const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with("=") ? 1 : 0;
  bytes.resize(bytes.size() - padding);
  return bytes;
}

std::string inflated(const std::string& packed) {
  std::string bytes(std::size_t{1} << 22, '\0');
  uLongf size = bytes.size();
  REQUIRE(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                     reinterpret_cast<const Bytef*>(packed.data()), packed.size()) == Z_OK);
  bytes.resize(size);
  return bytes;
}

}  // namespace

TEST_CASE(
    "render: an .html -> title, poster and a scene whose picture is the scene's own; the same bytes again") {
  const TemporaryFolder folder;
  const std::string page = folder.path("a.html");
  ::setenv("THIMBLE_WEB", folder.path("none").c_str(), 1);
  check_refused({"render", "castle", "-o", page}, 1, {"make web", folder.path("none")});
  ::setenv("THIMBLE_WEB", folder.path().c_str(), 1);
  folder.write("share.html", "no place for anything");
  check_refused({"render", "castle", "-o", page}, 1, {"{{scenes}}", "make web"});
  folder.write("share.html", kTemplate);
  const std::string scene =
      folder.write("two & <three> {{scenes}}.xyz", "2 2 2 255 0 0\n2 3 3 0 0 255\n3 3 3 0 255 0\n");
  const Words words{"render", scene, "--size", "64x48", "--turntable", "60", "-o", page};
  const Words more{"--background", "0a0b0c", "--ground", "off"};
  check_done(words + more);
  const std::string first = read_text(page);
  const Words lines = lines_of(first);
  REQUIRE(lines.size() == 11);
  CHECK(lines[0] == "<title>two &amp; &lt;three&gt; {{scenes}}</title>");
  CHECK(lines[1].starts_with("3 voxels"));
  CHECK(lines[3] == "#0a0b0c, #0a0b0c");
  CHECK(lines[4] == "6");
  CHECK(lines[5] == std::to_string(2 + 0x0a0b0c));
  CHECK(lines[6] == "0");
  CHECK(lines[7].starts_with("data:image/jpeg;base64,"));
  const std::string picture = "<img id=\"poster\" alt=\"" + lines[0].substr(7, lines[0].size() - 15) +
                              "\" src=\"data:image/jpeg;base64,";
  REQUIRE(lines[8].starts_with(picture));
  const std::string poster =
      from_base64(lines[8].substr(picture.size(), lines[8].size() - picture.size() - 2));
  CHECK(poster.starts_with("\xFF\xD8\xFF"));
  CHECK(poster.size() <= 60000);
  const std::string before = "<script type=\"application/octet-stream\" data-scene>";
  REQUIRE(lines[9].starts_with(before));
  const std::string packed = lines[9].substr(before.size(), lines[9].find("</script>") - before.size());
  const std::string baked = folder.write("baked.oct", inflated(from_base64(packed)));
  check_done({"render", baked, "--size", "64x48", "-o", folder.path("baked.ppm")});
  check_done({"render", scene, "--size", "64x48", "-o", folder.path("scene.ppm")});
  CHECK(read_text(folder.path("baked.ppm")) == read_text(folder.path("scene.ppm")));
  check_done(words + more);
  CHECK(read_text(page) == first);
  for (const Words& other : {Words{"--shade", "color"}, Words{"--effects", "all"}, Words{"--samples", "1"},
                             Words{"--bounces", "2"}, Words{"--normals", "face"},
                             Words{"--hits", folder.path("h.csv")}, Words{"--engine", "ray64"}}) {
    check_refused(Words{"render", scene, "-o", page} + other, 2, {other[0], ".html"});
  }
  check_refused({"render", scene, "-o", page, "--rows", "0:4"}, 2, {"a.html", "F.part"});
  check_refused({"render", scene, "-o", page, "--frames", "0:1"}, 1, {"--frames"});
  ::unsetenv("THIMBLE_WEB");
}
