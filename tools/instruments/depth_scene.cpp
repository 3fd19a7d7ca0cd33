#include "instruments/depth_scene.h"

#include <algorithm>
#include <string>

#include "readers/oct.h"
#include "readers/source.h"

namespace thimble::tools {

const char* structure_name(MemoryStructure structure) {
  constexpr std::array kNames{"dense", "pool", "compact", "dag"};
  return kNames[static_cast<std::size_t>(structure)];
}

std::vector<SolidBlock> solid_blocks(const CompactTree& tree) {
  std::vector<SolidBlock> blocks;
  for_each_block(tree, [&](const Vec3i& corner, int level, std::uint8_t material) {
    blocks.push_back({corner, static_cast<std::uint8_t>(level), material});
  });
  return blocks;
}

std::vector<SolidBlock> coarser(const std::vector<SolidBlock>& blocks, int levels) {
  std::vector<SolidBlock> result;
  std::array<std::uint64_t, 256> volume{};
  for (std::size_t first = 0; first < blocks.size();) {
    const SolidBlock& block = blocks[first];
    const Vec3i corner{block.corner.x >> levels, block.corner.y >> levels, block.corner.z >> levels};
    if (block.level >= levels) {
      result.push_back({corner, static_cast<std::uint8_t>(block.level - levels), block.material});
      ++first;
      continue;
    }
    // All blocks inside one voxel follow each other.
    std::size_t end = first;
    volume.fill(0);
    for (; end < blocks.size() && blocks[end].corner.x >> levels == corner.x &&
           blocks[end].corner.y >> levels == corner.y && blocks[end].corner.z >> levels == corner.z;
         ++end) {
      volume[blocks[end].material] += std::uint64_t{1} << (3 * blocks[end].level);
    }
    const auto most = std::max_element(volume.begin(), volume.end());  // the first of equals
    result.push_back({corner, 0, static_cast<std::uint8_t>(most - volume.begin())});
    first = end;
  }
  return result;
}

DepthScene::DepthScene(const std::vector<SolidBlock>& blocks, int world_level, int up, bool one_material)
    : pool_memory_(HostMemory::largest()) {
  if (Octree::make(world_level, pool_memory_.bytes(), &pool_) != Status::kOk) {
    throw InputError("a world of depth " + std::to_string(world_level) + " is beyond the limits");
  }
  for (const SolidBlock& block : blocks) {
    const Vec3i corner{block.corner.x << up, block.corner.y << up, block.corner.z << up};
    const Status status =
        pool_.insert_block(corner, block.level + up, one_material ? std::uint8_t{0} : block.material);
    if (status != Status::kOk) {
      throw InputError(std::string("the scene does not go into a pool of nodes: ") + status_text(status));
    }
  }
  shape_ = compact_shape(pool_);
  const std::size_t size = compact_bytes(shape_);
  compact_bytes_.resize(size);
  if (size == 0 || CompactTree::make(pool_, Bytes(compact_bytes_.data(), size), &compact_) != Status::kOk) {
    throw InputError("the scene does not go into a compact tree");
  }
  {
    const HostMemory work(thimble::shared_work_bytes(compact_.node_count()));
    Status status = SharedTree::make(compact_, {}, work.bytes(), nullptr, &shared_build_);
    if (status == Status::kOutOfMemory) {
      shared_bytes_.resize(shared_build_.bytes);
      status = SharedTree::make(compact_, Bytes(shared_bytes_.data(), shared_bytes_.size()), work.bytes(),
                                &shared_, &shared_build_);
    }
    if (status != Status::kOk) {
      throw InputError("the scene does not go into a shared tree");
    }
  }
  const VoxelBox& box = compact_.bounds();
  dense_size_ = {std::max(box.high.x, 1), std::max(box.high.y, 1), std::max(box.high.z, 1)};
  // The grid's world, which decides how rays are quantised, must be this one.
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    longest = dense_size_[axis] > dense_size_[longest] ? axis : longest;
  }
  dense_size_[longest] = std::max(dense_size_[longest], (std::int32_t{1} << (world_level - 1)) + 1);
}

std::uint64_t DepthScene::bytes(MemoryStructure structure) const {
  switch (structure) {
    case MemoryStructure::kDense:
      return dense_grid_bytes(dense_size_);
    case MemoryStructure::kPool:
      return pool_.used_bytes();
    case MemoryStructure::kCompact:
      return compact_.size_bytes();
    case MemoryStructure::kShared:
      return shared_.size_bytes();
  }
  return 0;
}

void DepthScene::make_dense(const std::vector<SolidBlock>& blocks) {
  dense_bytes_.resize(dense_grid_bytes(dense_size_));
  if (DenseGrid::make(dense_size_, Bytes(dense_bytes_.data(), dense_bytes_.size()), &dense_) != Status::kOk) {
    throw InputError("the scene does not go into a dense grid");
  }
  for (const SolidBlock& block : blocks) {
    const std::int32_t side = std::int32_t{1} << block.level;
    for (std::int32_t z = 0; z < side; ++z) {
      for (std::int32_t y = 0; y < side; ++y) {
        for (std::int32_t x = 0; x < side; ++x) {
          if (dense_.set({block.corner.x + x, block.corner.y + y, block.corner.z + z}) != Status::kOk) {
            throw InputError("internal error: a voxel outside the grid");
          }
        }
      }
    }
  }
  dense_made_ = true;
}

Status DepthScene::render(MemoryStructure structure, const Camera& camera, const Shading& shading,
                          const Band& band, RenderCounts* counts) const {
  TraceOptions options;
  options.width = Width::k64;
  switch (structure) {
    case MemoryStructure::kDense:
      return render_band(dense_, camera, shading, band, counts, options);
    case MemoryStructure::kPool:
      return render_band(pool_, camera, shading, band, counts, options);
    case MemoryStructure::kCompact:
      return render_band(compact_, camera, shading, band, counts, options);
    case MemoryStructure::kShared:
      return render_band(shared_, camera, shading, band, counts, options);
  }
  return Status::kBadArgument;
}

}  // namespace thimble::tools
