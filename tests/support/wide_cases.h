// Scenes and frames for the tests of the wide renderer, and the same picture by it and by the core.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "support/counts.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/tree/octree.h"
#include "wide/raster/renderer.h"

namespace thimble::tests {

// A tree and its lists, in exactly the bytes that it needs.
class WideScene {
 public:
  // Made when they are first asked for, which takes long for worlds of high levels.
  const wide::VoxelLists& lists() const;

  std::string what;
  int level = 0;
  std::unique_ptr<HeapBytes> bytes;
  CompactTree tree;
  wide::ListKind kind = wide::ListKind::kFastest;

 private:
  mutable std::unique_ptr<HeapBytes> list_bytes_;
  mutable wide::VoxelLists lists_;
};

// What `fill` puts into an octree of this level.
WideScene make_scene(int level, const std::function<void(Octree*)>& fill,
                     std::size_t pool_bytes = std::size_t{4} << 20,
                     wide::ListKind kind = wide::ListKind::kFastest);
WideScene random_scene(std::mt19937_64& random);
// A tree's bytes, copied.
WideScene scene_of(ConstBytes tree, const std::string& what);
Vec3i random_voxel(std::mt19937_64& random, std::int64_t low, std::int64_t high);

struct FrameCase {
  Camera camera;
  Shading shading;
  Band band;
  std::vector<Rgb8> palette;
};

// A frame of any kind; false where the core refuses the camera that was drawn.
bool random_frame(std::mt19937_64& random, const WideScene& scene, FrameCase* frame);
// Sets the depths between which greys are spread to those of the scene.
void set_depth_range(const WideScene& scene, FrameCase* frame);
std::size_t band_size(const FrameCase& frame);

// As wide::render, with a workspace of just enough bytes, which were used before.
Status render_wide(const WideScene& scene, const FrameCase& frame, const Band& band,
                   const wide::Options& options, RenderCounts* counts);
// The band by the wide renderer; nothing where it leaves the frame to the core.
std::optional<std::vector<std::uint8_t>> draw_wide(const WideScene& scene, const FrameCase& frame,
                                                   const wide::Options& options, std::uint64_t* hits);
std::vector<std::uint8_t> draw_core(const WideScene& scene, const FrameCase& frame, std::uint64_t* hits);

// Kept from frame to frame, as programs that draw films do.
wide::Threads* threads_of(int count);
int thread_count(const wide::Options& options);
wide::Options options_of(int threads, wide::Order order);
wide::Options random_options(std::mt19937_64& random);
// Takes one of those that this machine has.
void use_random_instruction_set(std::mt19937_64& random);

// Takes the best instruction set again in the end.
struct BestInstructionSet {
  ~BestInstructionSet() { wide::use_instruction_set(-1); }
};

}  // namespace thimble::tests
