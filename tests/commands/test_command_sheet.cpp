// `thimble sheet` and `thimble thumbnail`: small pictures of files that nobody vouches for. tests/web/test_share.js looks at
// the page of a sheet.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/check_command.h"
#include "support/file_bytes.h"
#include "support/run_command.h"

namespace {

using namespace thimble::tests;

constexpr const char* kCube = "2 2 2 255 0 0\n2 2 3 255 0 0\n2 3 2 255 0 0\n";

// Width and height of a .ppm.
std::vector<std::string> size_of(const std::string& path) {
  return split(lines_of(read_text(path))[1], ' ');
}

}  // namespace

TEST_CASE("thumbnail: a model -> the picture that render draws of it, a mesh by as many voxels as pixels") {
  const TemporaryFolder folder;
  const std::string model = folder.write("m.xyz", kCube);
  const std::string mesh = folder.write("m.obj", "v 0 0 0\nv 9 0 1\nv 0 5 7\nf 1 2 3\n");
  const auto same = [&](const std::string& scene, const Words& more) {
    check_done({"thumbnail", scene, folder.path("small"), "--size", "64"});
    check_done(Words{"render", scene, "--size", "64x64", "-o", folder.path("large.png")} + more);
    CHECK(read_text(folder.path("small")) == read_text(folder.path("large.png")));
  };
  same(model, {});
  same(mesh, {"--depth", "6"});
  // tumbler makes the file and reads it by its descriptor.
  const std::string made = folder.write("made.png", "");
  std::ifstream reader(made, std::ios::binary);
  check_done({"thumbnail", model, made, "--size", "64"});
  const std::string png(std::istreambuf_iterator<char>(reader), {});
  CHECK(png == read_text(made));
  CHECK(png.starts_with("\x89PNG"));
}

TEST_CASE("thumbnail: what is broken, endless or huge -> a sentence in time, and no file") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& scene, const char* named) {
    check_refused({"thumbnail", scene, folder.path("t.png")}, 1, {scene, named});
    const auto names = folder.names();
    CHECK(std::find(names.begin(), names.end(), "t.png") == names.end());
  };
  refused(folder.write("broken.vox", "VOX ?"), "truncated");
  refused(folder.path("nothing.vox"), "No such file");
  std::string slow = "depth 9\n";
  for (int i = 0; i < 2000; ++i) {
    slow += "model cluster:100000,depth=9\n";
  }
  refused(folder.write("slow.scene", slow), "longer");
  if (!kSanitized) {
    const std::string huge = folder.write("huge.kvx", "x");  // mapped, and so too large at once
    std::filesystem::resize_file(huge, std::uintmax_t{1} << 30);
    refused(huge, "memory");
  }
  check_refused({"thumbnail", folder.path("a")}, 2, {"picture"});
  const std::string same = folder.write("same.xyz", kCube);
  check_refused({"thumbnail", same, same}, 1, {"same.xyz"});
}

TEST_CASE("sheet: a folder -> a tile for each scene in it, what cannot be drawn counted; nothing else") {
  const TemporaryFolder folder;
  const TemporaryFolder out;
  check_refused({"sheet", folder.path(), "-o", out.path("s.ppm")}, 1, {"no file in it is a scene"});
  for (const char* const name : {"a.xyz", "b.xyz", "c.xyz", "d.xyz"}) {
    folder.write(name, kCube);
  }
  folder.write(".hidden.xyz", kCube);
  folder.write("notes.md", "no scene");
  folder.write("broken.vox", "VOX ?");
  const Words words{"sheet", folder.path(), "-o", out.path("s.ppm"), "--size", "96"};
  CHECK(check_done(words).err == "5 scenes, 1 of them could not be drawn\n");
  // Three in a row; 12 pixels between tiles, 38 for what is written below.
  CHECK(size_of(out.path("s.ppm")) == Words{std::to_string(3 * 108 + 12), std::to_string(2 * 146 + 12)});
  const std::string first = read_text(out.path("s.ppm"));
  CHECK(check_done(words + Words{"--columns", "1", "--threads", "1", "--quiet"}).err.empty());
  CHECK(size_of(out.path("s.ppm")) == Words{"120", std::to_string(5 * 146 + 12)});
  check_done(words + Words{"--threads", "64"});
  CHECK(read_text(out.path("s.ppm")) == first);
  check_refused({"sheet", folder.path(), "-o", out.path("s.gif")}, 2, {".png"});
  check_refused({"sheet", folder.path("none"), "-o", out.path("s.png")}, 1, {"none", "No such file"});
  CHECK(out.names() == Words{"s.ppm"});
}

TEST_CASE(
    "sheet: an .html -> a tile for each scene in order, with what is said or what opens; the same bytes "
    "again") {
  const TemporaryFolder folder;
  const TemporaryFolder out;
  ::setenv("THIMBLE_WEB", out.path().c_str(), 1);
  folder.write("a&b.xyz", kCube);
  folder.write("broken.vox", "VOX ?");
  const std::string page = out.path("s.html");
  const Words words{"sheet", folder.path(), "-o", page, "--size", "96"};
  check_refused(words, 1, {"make web"});
  out.write("share.html",
            "{{title}}|{{description}}|{{version}}{{colors}}{{turn}}{{background}}{{ground}}|{{preview}}|{{"
            "scenes}}|");
  CHECK(check_done(words).err == "2 scenes, 1 of them could not be drawn\n");
  const std::string first = read_text(page);
  const Words parts = split(first, '|');
  REQUIRE(parts.size() == 6);
  CHECK(parts[1].starts_with("2 scenes"));
  CHECK(parts[3] == "data:,");
  const Words lines = lines_of(parts[4]);
  REQUIRE(lines.size() == 6);
  CHECK(lines[0] == "<main>");
  CHECK(lines[1].starts_with("<figure data-name=\"a&amp;b.xyz\" data-colors=\"#"));
  CHECK(lines[1].find("<a><img alt=\"a&amp;b.xyz\" src=\"data:image/jpeg;base64,") != std::string::npos);
  CHECK(lines[1].find("<figcaption>a&amp;b.xyz<br>3 voxels<br>") != std::string::npos);
  CHECK(lines[1].find("data-scene>") != std::string::npos);
  CHECK(lines[3].starts_with("<figure><p>"));
  CHECK(lines[3].find("truncated") != std::string::npos);
  CHECK(lines[3].find("data-scene>") == std::string::npos);
  CHECK(lines[4] == "</main>");
  check_done(words + Words{"--threads", "1", "--columns", "3", "--quiet"});
  const std::string wide = read_text(page);
  CHECK(wide.find("<main style=\"grid-template-columns: repeat(3, 1fr)\">") != std::string::npos);
  CHECK(wide.substr(wide.find("<figure")) == first.substr(first.find("<figure")));
  ::unsetenv("THIMBLE_WEB");
}
