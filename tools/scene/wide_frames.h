/// The wide renderer as what draws for a simulated board, in memory of the host's own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "host/simulation.h"
#include "readers/input_error.h"
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
            Bytes pixels) override {
    if (!prepare(tree, camera)) {
      return leave("no room for --engine wide");
    }
    wide::Counts work;
    if (renderer_->render(camera, shading, {pixels, format, 0, 0, camera.height_px()}, nullptr, &work) !=
        Status::kOk) {
      return leave("--engine wide does not take the rays of this camera");
    }
    ++drawn_;
    return true;
  }

  /// Frames that it drew, and frames that it left to the core.
  std::uint32_t drawn() const { return drawn_; }
  std::uint32_t left() const { return left_; }

 private:
  bool prepare(const CompactTree& tree, const Camera& camera) {
    if (tree_ == tree.bytes() && width_px_ == camera.width_px() && height_px_ == camera.height_px()) {
      return renderer_ != nullptr;
    }
    tree_ = tree.bytes();
    width_px_ = camera.width_px();
    height_px_ = camera.height_px();
    renderer_.reset();
    const std::size_t bytes = WideRenderer::bytes(tree, width_px_, height_px_, threads_);
    if (bytes > most_bytes_) {
      return false;
    }
    memory_ = HostMemory(bytes);
    arena_ = Arena(memory_.bytes());
    renderer_ = WideRenderer::make(tree, &arena_, width_px_, height_px_, threads_);
    return renderer_ != nullptr;
  }
  bool leave(const char* why) {
    fail_if(insists_, why);
    ++left_;
    return false;
  }

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
