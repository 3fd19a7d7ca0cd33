#include "scene/wide_frames.h"

#include <string>

#include "readers/source.h"
#include "thimble/base/memory.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kAlignment = 64;  // of the workspace

}  // namespace

bool WideFrames::prepare(const CompactTree& tree, const Camera& camera) {
  if (tree_ == tree.bytes() && width_px_ == camera.width_px() && height_px_ == camera.height_px()) {
    return is_ready_;
  }
  tree_ = tree.bytes();
  width_px_ = camera.width_px();
  height_px_ = camera.height_px();
  is_ready_ = false;
  const std::size_t list_bytes = wide::VoxelLists::bytes(tree);
  const std::size_t work_bytes = wide::workspace_bytes(width_px_, height_px_, threads_.count());
  if (list_bytes > most_bytes_ || work_bytes > most_bytes_ - list_bytes) {
    return false;
  }
  memory_ = HostMemory(list_bytes + kAlignment + work_bytes);
  Arena arena(memory_.bytes());
  if (wide::VoxelLists::make(tree, &arena, &lists_) == Status::kOk) {
    workspace_ = arena.take(work_bytes, kAlignment);
    is_ready_ = !workspace_.empty();
  }
  return is_ready_;
}

bool WideFrames::leave(const char* why) {
  if (insists_) {
    throw InputError(why);
  }
  ++left_;
  return false;
}

bool WideFrames::draw(const CompactTree& tree, const Camera& camera, const Shading& shading,
                      PixelFormat format, Bytes pixels) {
  if (!prepare(tree, camera)) {
    return leave("no room for --engine wide");
  }
  wide::Options options;
  options.threads = &threads_;
  if (wide::render(lists_, camera, shading, {pixels, format, 0, 0, camera.height_px()}, workspace_, nullptr,
                   options) != Status::kOk) {
    return leave("--engine wide does not take the rays of this camera");
  }
  ++drawn_;
  return true;
}

}  // namespace thimble::tools
