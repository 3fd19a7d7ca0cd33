// Every real file there is, good and hostile, is read or refused with a sentence, within limits of time and
// memory.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "readers/read_any.h"
#include "support/reader_inputs.h"
#include "support/run_command.h"

namespace {

using namespace thimble::tests;
using namespace thimble::tools;
using namespace thimble::tools::test;

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
  const std::filesystem::path root = data_folder();
  if (root.empty()) {
    return;
  }
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

TEST_CASE(
    "data: real and hostile files -> as many points, corners, triangles, voxels as they have, or none") {
  const std::filesystem::path data = data_folder();
  if (data.empty()) {
    return;
  }
  struct Expected {
    const char* file;
    long long count;  // of points, a mesh's corners or voxels; -1: refused, -2: some
    std::size_t triangles = 0;
  };
  for (const Expected& expected : {Expected{"cloud/b9_training.ply", 22300},
                                   {"cloud/ball.ply", 31374},
                                   {"cloud/building.ply", 100000},
                                   {"cloud/hippo1.ply", 6104},
                                   {"cloud/spheres.ply", 5969},
                                   {"cloud/kitten.xyz", 5210},  // their lines
                                   {"cloud/point_set_3.xyz", 8075},
                                   {"cloud/poste_france.xyz", 9031},
                                   {"cloud/radar.xyz", 20950},
                                   {"cloud/pcl_bun4.pcd", 361},
                                   {"cloud/pcl_chef.pcd", 5092},
                                   {"cloud/pcl_milk.pcd", 13704},
                                   {"cloud/pcl_rops_cloud.pcd", 32087},
                                   {"cloud/pdal_simple.las", 1065},
                                   {"cloud/pdal_1.2-with-color.las", 1065},
                                   {"cloud/urban.las", 13511},
                                   {"cloud/pdal_simple.laz", 1065},
                                   {"nbody/galaxy_littleendian.dat", 60000},
                                   {"mesh/ChineseDragon-10kv.off", 10000, 19994},
                                   {"mesh/armadillo.off", 26002, 52000},
                                   {"mesh/bunny00.off", 37706, 75408},
                                   {"mesh/camel.off", 9770, 19536},
                                   {"mesh/cow.off", 2904, 5804},
                                   {"mesh/elephant.off", 2775, 5558},
                                   {"mesh/fandisk.off", 6475, 12946},
                                   {"mesh/lion-head.off", 8356, 16674},
                                   {"mesh/triceratops.off", 2832, 5660},
                                   {"mesh/assimp_Wuson.ply", 11184, 3732},
                                   {"mesh/dragon_vrip_res2.ply.gz", 100250, 202520},
                                   {"mesh/dragon_vrip_res3.ply.gz", 22998, 47794},
                                   {"mesh/dragon_vrip_res4.ply.gz", 5205, 11102},
                                   {"mesh/happly_platonic_shelf.ply", 50, 80},
                                   {"mesh/npm_bunny.obj", 1839, 3674},
                                   {"mesh/npm_snowden.obj", 18743, 37629},
                                   {"mesh/npm_teapot.obj", 792, 992},
                                   {"mesh/trimesh_20mm-xyz-cube.stl", -2, 260},
                                   {"mesh/assimp_Spider_ascii.stl", -2, 1368},
                                   {"mesh/trimesh_Duck.glb", -2, 4212},
                                   {"mesh/trimesh_monkey.glb", -2, 968},
                                   {"mesh/trimesh_nested.glb", -2, 36},
                                   {"map/chair.binvox", -2},
                                   {"terrain/jacksboro_fault_dem.npz", -2},
                                   {"hostile/assimp_AllIndicesOutOfRange.gltf", -1},
                                   {"hostile/assimp_OutOfMemory.off", -1},
                                   {"hostile/assimp_RecursiveNodes.gltf", -1},
                                   {"hostile/assimp_empty.obj", -1},
                                   {"hostile/assimp_empty.off", -1},
                                   {"hostile/assimp_empty.ply", -1},
                                   {"hostile/assimp_float-color.ply", 3},
                                   {"hostile/assimp_invalid.off", -1},
                                   {"hostile/assimp_malformed.obj", -1},
                                   {"hostile/assimp_malformed2.obj", 8},
                                   {"hostile/assimp_number_formats.obj", -1},
                                   {"hostile/assimp_points.ply", 4},
                                   {"hostile/assimp_triangle_with_empty_solid.stl", -2, 1},
                                   {"hostile/dot_vox_not_a.vox", -1},
                                   {"hostile/ply_truncated_trimesh_bunny.ply", -1},
                                   {"hostile/tinyobj_issue-140-zero-face-idx.obj", -1},
                                   {"hostile/tinyobj_test-nan.obj", -1},
                                   {"hostile/trimesh_comments.off", 8},
                                   {"hostile/trimesh_negative_indices.obj", 8},
                                   {"hostile/vox_ogt59_voxel_outside_size.vox", -1},
                                   {"hostile/vox_xyzi_count_overrun.vox", -1}}) {
    INFO(std::string(expected.file));
    const ReaderRow* row = find_reader(expected.file, {});
    REQUIRE(row != nullptr);
    const std::string bytes = contents_of(data / expected.file);
    const long long count = outcome_of(row->read, bytes);
    CHECK((expected.count == -2 ? count > 0 : count == expected.count));
    if (expected.triangles > 0) {
      CHECK(read_mesh(row->read, bytes).triangles.size() == expected.triangles);
    }
  }
  for (const auto& entry : std::filesystem::directory_iterator(data / "map/mts")) {
    INFO(entry.path().filename().string());
    CHECK(outcome_of(find_reader("a.mts", {})->read, contents_of(entry.path())) > 0);
  }
  // Every reader stands every file, its own or not.
  for (const auto& entry : std::filesystem::directory_iterator(data / "hostile")) {
    const std::string bytes = contents_of(entry.path());
    for (const ReaderRow& row : reader_rows()) {
      INFO(entry.path().filename().string(), " as ", row.name);
      outcome_of(row.read, bytes);
    }
  }
}
