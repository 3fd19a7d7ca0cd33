#include "scene/wide_frames.h"

#include "readers/source.h"

namespace thimble::tools {
bool WideFrames::prepare(const CompactTree& tree, const Camera& camera) {
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

bool WideFrames::leave(const char* why) {
  fail_if(insists_, why);
  ++left_;
  return false;
}

bool WideFrames::draw(const CompactTree& tree, const Camera& camera, const Shading& shading,
                      PixelFormat format, Bytes pixels) {
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

}  // namespace thimble::tools
