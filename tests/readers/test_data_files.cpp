// Every real file there is, good and hostile, is read or refused with a sentence, within limits of time and
// memory.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "support/run_command.h"

namespace {

using namespace thimble::tests;

bool ends_with_any(const std::string& path, const std::vector<std::string>& endings) {
  return std::any_of(endings.begin(), endings.end(),
                     [&](const std::string& ending) { return path.ends_with(ending); });
}

// Whether a file is of a format that is read, and sound.
bool must_be_read(const std::filesystem::path& root, const std::string& path) {
  const std::string inside = path.substr(root.string().size());
  if (inside.find("/hostile/") != std::string::npos || inside.ends_with("not_a.vox")) {
    return false;
  }
  if (inside.ends_with(".dat")) {
    // Gadget snapshots and other things; a snapshot's first record has 256 bytes.
    return inside.starts_with("/nbody/") && read_text(path).starts_with(std::string("\x00\x01\x00\x00", 4));
  }
  return ends_with_any(inside, {".vox", ".ply", ".ply.gz", ".obj", ".off", ".xyz", ".stl", ".glb", ".pcd",
                                ".las", ".binvox", ".npz", ".mts", ".schematic"});
}

}  // namespace

TEST_CASE("data: every file of THIMBLE_DATA -> read, or one sentence and status 1; in 20 s and 1 GiB") {
  const char* folder = std::getenv("THIMBLE_DATA");
  if (folder == nullptr) {
    MESSAGE("skipped: THIMBLE_DATA is not set");
    return;
  }
  const std::filesystem::path root(folder);
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (entry.is_regular_file()) {
      paths.push_back(entry.path().string());
    }
  }
  std::sort(paths.begin(), paths.end());
  CHECK(paths.size() > 50);
  CommandLimits limits;
  limits.seconds = 20;
  limits.address_space_bytes = std::uint64_t{1} << 30;
  int read = 0;
  int refused = 0;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::string& path = paths[i];
#ifdef __SANITIZE_ADDRESS__
    limits.seconds = 120;
    // A sample, and all that is hostile.
    if (path.find("/hostile/") == std::string::npos &&
        (i % 9 != 0 || std::filesystem::file_size(path) > 3'000'000)) {
      continue;
    }
#endif
    std::vector<std::string> words{"info", "--quiet", path};
    // Voxels that lie where they lie have the depth that they need.
    if (!ends_with_any(path, {".vox", ".binvox", ".npz", ".mts", ".schematic"})) {
      words.insert(words.end(), {"--depth", "6"});
    }
    const CommandResult result = run_command(words, limits);
    CAPTURE(path);
    CAPTURE(result.describe());
    CHECK(!result.timed_out);
    CHECK(result.signal == 0);
    const bool sound =
        result.status == 0 && result.err.empty() && result.out.find("compact tree") != std::string::npos;
    const bool told = result.status == 1 && result.out.empty() && is_one_sentence(result.err) &&
                      result.err.find(path) != std::string::npos;
    CHECK((sound || told));
    if (must_be_read(root, path)) {
      CHECK(sound);
    }
    read += sound ? 1 : 0;
    refused += told ? 1 : 0;
  }
  MESSAGE("read " << read << ", refused " << refused);
  CHECK(read > 0);
  CHECK(refused > 0);
}
