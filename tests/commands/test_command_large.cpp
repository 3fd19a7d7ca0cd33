// Scenes that are larger than the memory that the command may have of its own.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/check_command.h"
#include "support/counts.h"
#include "support/file_bytes.h"

namespace thimble::tests {
namespace {

// 122 MB, and 1.95 GB; the limits are what the command may have of its own.
const int kLevel = many_or_few(12, 11);
const std::uint64_t kChildren = many_or_few<std::uint64_t>(6, 3);  // of each child of the root
const int kLimitKiB = many_or_few(600, 60) * 1024;

// A baked scene of a voxel in each cube of 2 x 2 x 2 of a part of the world: below the root, which has two children, and
// these all nodes but those of level 1 have all children. Its checksums, which a file that is mapped is not read for, are
// 0. `first_mask`: of the world's root.
void write_scene(const std::string& path, unsigned first_mask) {
  constexpr std::uint64_t kTop = 3;  // nodes
  const std::uint64_t voxels = 2 * kChildren << (3 * (kLevel - 3));
  const std::uint64_t upper = kTop + (voxels - 2 * kChildren) / 7;  // nodes above level 1
  const std::uint64_t nodes = upper + voxels;
  const std::uint64_t masks_bytes = (nodes + 3) & ~std::uint64_t{3};
  const std::uint64_t blocks = (nodes + 63) / 64;
  const std::uint64_t tree_bytes = 56 + masks_bytes + 4 * blocks;
  const std::uint64_t side = std::uint64_t{1} << kLevel;
  std::ofstream file(path, std::ios::binary);
  file << "TMS" << little(1, 1) << little(28 + tree_bytes, 4) << little(0, 4) << little(1, 4);
  file << little(1, 4) << little(28, 4) << little(tree_bytes, 4);  // one section, a tree
  file << "TMB" << little(1, 1) << little(static_cast<std::uint64_t>(kLevel), 1) << little(6, 1)
       << little(0, 2) << little(tree_bytes, 4) << little(0, 4) << little(nodes, 4) << little(0, 4)
       << little(voxels, 4) << little(0, 6) << little(side - 1, 2) << little(side - 1, 2)
       << little(side - 1, 2) << little(voxels, 8) << little(0, 8);
  const auto fill = [&](std::uint64_t count, char byte) {
    const std::string piece(std::size_t{1} << 20, byte);
    for (; count > piece.size(); count -= piece.size()) {
      file << piece;
    }
    file << piece.substr(0, static_cast<std::size_t>(count));
  };
  const std::uint64_t mask = (std::uint64_t{1} << kChildren) - 1;
  file << little(first_mask, 1) << little(mask, 1) << little(mask, 1);
  fill(upper - kTop, '\xff');
  fill(voxels, '\1');
  fill(masks_bytes - nodes, '\0');
  std::string directory = little(0, 4);  // of the children before each 64th node
  for (std::uint64_t node = 64; node < nodes; node += 64) {
    const std::uint64_t full = 2 + 2 * kChildren + 8 * (std::min(node, upper) - kTop);
    directory += little(full + (node > upper ? node - upper : 0), 4);
  }
  file << directory;
}

}  // namespace

TEST_CASE("command on a scene larger than its memory: drawn from the file, as with all memory") {
  if (kSanitized) {
    return;  // it takes memory of its own
  }
  const TemporaryFolder folder;
  const std::string scene = folder.path("large.oct");
  const std::string command = std::string(THIMBLE_COMMAND_PATH) + " ";
  const std::string draw = command + "render " + scene + " --size 160x120 --quiet -o ";
  const std::string plain = " --shade depth --threads 1 --engine ray64";
  CommandLimits shell;
  shell.program = "/bin/sh";
  shell.seconds = 300;
  const std::string limit = "ulimit -d " + std::to_string(kLimitKiB) + " && ";
  write_scene(scene, 3);
  check_done({"-c", limit + draw + folder.path("a.pgm") + plain}, shell);
  check_done({"-c", draw + folder.path("b.pgm") + plain}, shell);
  const std::string picture = read_text(folder.path("a.pgm"));
  CHECK(picture == read_text(folder.path("b.pgm")));
  CHECK(picture.find_first_not_of(picture.back(), 20) != std::string::npos);
  // What takes lists, maps and copies of smaller scenes: it does without.
  check_done({"-c", limit + draw + folder.path("c.png")}, shell);
  check_done({"-c", limit + draw + folder.path("d.pgm") + " --shade depth"}, shell);
  CHECK(picture == read_text(folder.path("d.pgm")));
  // And with all memory, since to make them takes longer: from 1 GB on.
  check_done({"-c", draw + folder.path("e.pgm") + " --shade depth --stats " + folder.path("e.json")}, shell);
  CHECK(picture == read_text(folder.path("e.pgm")));
  const bool is_listed = read_text(folder.path("e.json")).find("\"engine\": \"wide\"") != std::string::npos;
  CHECK(is_listed == (std::filesystem::file_size(scene) < std::size_t{1} << 30));
  check_done({"-c", limit + command + "view " + scene + " --size 160x120 --bench 2"}, shell);

  write_scene(scene, 7);
  const CommandResult damaged = run_command({"-c", draw + folder.path("c.pgm")}, shell);
  CHECK(damaged.status == 1);
  CHECK(damaged.err.find("another number of nodes than the masks") != std::string::npos);

  write_scene(scene, 3);
  std::fstream(scene, std::ios::in | std::ios::out | std::ios::binary).seekp(-1, std::ios::end).put('\x7f');
  const CommandResult directory = run_command({"-c", draw + folder.path("d.pgm")}, shell);
  CHECK_MESSAGE(directory.status == 1, directory.describe());
}

TEST_CASE("bake: many points -> written from where their tree was built, without room for another") {
  if (kSanitized) {
    return;  // it takes memory of its own
  }
  const TemporaryFolder folder;
  const std::string scene = folder.path("points.oct");
  const CommandResult baked = check_done({"bake", "points:17e6,depth=11", "-o", scene, "--quiet"});
  const auto tree_kib = static_cast<long>(std::filesystem::file_size(scene) >> 10);
  CHECK(tree_kib > 40000);
  CHECK(baked.peak_kib < 2 * tree_kib);  // with a list of 17 million keys, or a copy: more than that
}

}  // namespace thimble::tests
