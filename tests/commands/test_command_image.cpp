// `thimble image`: a scene behind a program that is there, or a sentence that says why not.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <string>

#include "images/image_file.h"
#include "images/scene_mark.h"
#include "support/check_command.h"
#include "support/file_bytes.h"
#include "thimble/bake/baked_scene.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// The programs of microbit, which hold nothing but their marks, as `make images` leaves them.
class Programs {
 public:
  explicit Programs(const TemporaryFolder& folder) : folder_(folder) {}

  void add(const std::string& name, std::uint32_t effects, std::uint32_t room,
           const std::string& board = "microbit") {
    platform::SceneMark mark{};
    std::memcpy(mark.magic, platform::kSceneMarkMagic, sizeof mark.magic);
    mark.baked_version = kBakedVersion;
    mark.effects = effects;
    mark.end = 0x40000;
    mark.place = mark.end - room;
    board.copy(mark.board, sizeof mark.board - 1);
    platform::Program program;
    program.segments = {{0, 0, 0, std::string(reinterpret_cast<const char*>(&mark), sizeof mark)}};
    folder_.write(name + ".elf.gz", deflated(platform::elf_of(program), kGzip));
  }
  Words image(const Words& words) const {
    return Words{"image"} + words +
           Words{"--board", "microbit", "--images", folder_.path(""), "-o", folder_.path("o.bin")};
  }
  // What lies behind the program; whose room is that.
  std::string behind(std::uint32_t room) const {
    const std::string bin = read_text(folder_.path("o.bin"));
    return bin.size() < 0x40000 - room ? std::string() : bin.substr(0x40000 - room);
  }

 private:
  const TemporaryFolder& folder_;
};

}  // namespace

TEST_CASE("image: a scene -> the bytes of bake behind the smallest program that draws it") {
  const TemporaryFolder folder;
  Programs programs(folder);
  programs.add("microbit-demo-plain", 0, 0x20000);
  programs.add("microbit-demo-sun", 0x3f0b, 0x10000);
  programs.add("microbit-demo-all", 0x7fff, 0x8000);
  const auto baked = [&](const Words& words) {
    check_done(Words{"bake"} + words + Words{"--board", "microbit", "-o", folder.path("s.oct"), "--quiet"});
    return read_text(folder.path("s.oct"));
  };
  const std::string scene =
      folder.write("mirror.scene",
                   "depth 4\nsun toward 6 -5 9\nmaterial steel metal color 120 160 226\n"
                   "box steel from 2 2 2 to 9 9 9\n");
  for (const auto& [words, room] :
       {std::pair{Words{"spheres,depth=4", "--effects", "none"}, 0x20000U},
        std::pair{Words{"spheres,depth=4", "--effects", "direct-light,shadows"}, 0x10000U},
        std::pair{Words{scene}, 0x8000U},
        std::pair{Words{scene, "--effects", "direct-light,shadows"}, 0x10000U}}) {
    check_done(programs.image(words));
    CHECK(programs.behind(room) == baked(words));
  }
  check_refused(programs.image({scene, "--effects", "direct-light"}), 1,
                {"which no image for microbit draws together"});
}

TEST_CASE("image: light that no program draws -> left out where nobody asked for it, else a sentence") {
  const TemporaryFolder folder;
  Programs programs(folder);
  programs.add("microbit-demo-plain", 0, 0x20000);
  const std::string vox = folder.write("dot.xyz", "0 0 0\n1 2 3\n4 1 2\n");
  CHECK(check_done(programs.image({"castle"})).err.find("without light") != std::string::npos);
  check_refused(programs.image({vox, "--effects", "glass"}), 1, {"calls for glass, which no image"});
  // What shows no light takes a scene with any.
  programs.add("microbit-dig-plain", 0, 0x20000);
  check_done(programs.image({vox, "--effects", "glass", "--app", "dig"}));
  programs.add("microbit-water-all", 0x7fff, 0x20000);
  check_refused(programs.image({vox, "--app", "water"}), 1, {"no `water` statement"});
}

TEST_CASE("image: a scene too large -> how many bytes fit and what makes it fit; with that it does") {
  const TemporaryFolder folder;
  Programs programs(folder);
  programs.add("microbit-demo-plain", 0, 2048);
  const Words plain = programs.image({"spheres,depth=6", "--effects", "none"});
  check_refused(plain, 1,
                {"microbit has 2,048 bytes of flash for a scene behind the image",
                 "--coarsen makes the finest tree that fits"});
  check_done(plain + Words{"--coarsen"});
  CHECK(programs.behind(2048).size() <= 2048);
  check_done(plain + Words{"--coarsen", "--memory", "1000"});
  CHECK(programs.behind(2048).size() <= 1000);
}

TEST_CASE("image: no programs, another board's, no program, another ending -> a sentence, and no file") {
  const TemporaryFolder folder;
  Programs programs(folder);
  const Words scene{"spheres,depth=4", "--effects", "none"};
  check_refused(programs.image(scene), 1, {"make images builds them"});
  check_refused(programs.image(scene + Words{"--app", "none"}), 2, {"--app"});
  programs.add("microbit-demo-plain", 0, 0x20000, "gba");
  check_refused(programs.image(scene), 1, {"another board"});
  folder.write("microbit-demo-plain.elf.gz", "text");
  check_refused(programs.image(scene), 1, {"microbit-demo-plain.elf.gz"});
  CHECK_FALSE(std::filesystem::exists(folder.path("o.bin")));
  check_refused({"image", "spheres", "--board", "microbit", "-o", folder.path("o.uf2")}, 2, {"--output"});
  check_refused({"image", "spheres", "-o", folder.path("o.bin")}, 2, {"--board"});
}
