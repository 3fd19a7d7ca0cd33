/// The wide renderer as what draws for a simulated board, in memory of the host's own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "host/simulation.h"
#include "scene/host_memory.h"
#include "scene/wide_renderer.h"
#include "thimble/base/memory.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/shading.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

class WideFrames final : public host::FramePainter {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{1} << 30;

  /// `insists`: what cannot be drawn is an InputError, not left to the core. `most_bytes`: for voxel lists
  /// and workspace.
  explicit WideFrames(bool insists, int threads = 1, std::size_t most_bytes = kMostBytes)
      : insists_(insists), threads_(threads), most_bytes_(most_bytes) {}

  bool draw(const CompactTree& tree, const Camera& camera, const Shading& shading, PixelFormat format,
            Bytes pixels) override;

  /// Frames that it drew, and frames that it left to the core.
  std::uint32_t drawn() const { return drawn_; }
  std::uint32_t left() const { return left_; }

 private:
  bool prepare(const CompactTree& tree, const Camera& camera);
  bool leave(const char* why);

  bool insists_;
  int threads_;
  std::size_t most_bytes_;
  std::uint32_t drawn_ = 0;
  std::uint32_t left_ = 0;
  // Made for this tree and pictures of this size.
  const std::uint8_t* tree_ = nullptr;
  std::int32_t width_px_ = 0;
  std::int32_t height_px_ = 0;
  HostMemory memory_;
  Arena arena_;
  std::unique_ptr<WideRenderer> renderer_;  // null where there was no room
};

}  // namespace thimble::tools
