/// Worlds and cameras on which the wide renderer's orders are compared with each other and with the core:
/// the generators' scenes, files, and worlds made to mislead a choice that goes by means.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/built_scene.h"
#include "thimble/picture/camera.h"
#include "wide/raster/voxel_lists.h"

namespace thimble::tests {

/// A compact tree and the wide renderer's lists of it.
class TrialWorld {
 public:
  /// One of the worlds below, L being the world's level, else a SCENE of the command's (a file's depth behind
  /// an `@`). Throws tools::InputError.
  ///
  ///     solid:L    full                                inset:L    full but for the outermost voxels
  ///     noise:L    every second voxel, at random       checker:L  every second voxel
  ///     sponge:L   Menger's, of as many thirds as fit  voxel:L    a single voxel in the middle
  ///     wall:L     one voxel thick, along y            slant:L    a diagonal plane, two voxels thick
  ///     columns:L  one voxel wide, every eighth        islands:L  noise in two far corners, dust between
  ///     screen:L   a solid wall before single voxels   ball:L     single voxels in a ball's hull
  ///     globe:L    a ball, full                        terrain:L  hills on thick ground
  ///     city:L     houses, full
  explicit TrialWorld(const std::string& name);

  const std::string& name() const { return name_; }
  const CompactTree& tree() const { return tree_; }
  const wide::VoxelLists& lists() const { return lists_; }
  /// The lists of boxes alone, which are those drawn where a budget does not hold the others.
  const wide::VoxelLists& box_lists() const { return box_lists_; }
  std::uint64_t list_bytes() const { return list_bytes_.size(); }
  std::uint64_t box_list_bytes() const { return box_list_bytes_.size(); }
  /// What making each took.
  double list_seconds() const { return list_seconds_; }
  double box_list_seconds() const { return box_list_seconds_; }

 private:
  std::string name_;
  std::unique_ptr<tools::BuiltScene> built_;  // or `bytes_`
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint8_t> list_bytes_;
  std::vector<std::uint8_t> box_list_bytes_;
  CompactTree tree_;
  wide::VoxelLists lists_;
  wide::VoxelLists box_lists_;
  double list_seconds_ = 0;
  double box_list_seconds_ = 0;
};

struct TrialView {
  std::string name;
  Camera camera;
};

/// Cameras from outside and inside, near and far, wide and narrow, along axes and grazing, perspective and
/// parallel: those of them that the core takes.
std::vector<TrialView> trial_views(const CompactTree& tree, std::int32_t width_px, std::int32_t height_px);

}  // namespace thimble::tests
