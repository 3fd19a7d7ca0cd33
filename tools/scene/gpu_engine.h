/// The GPU renderer (platform/gpu) over a built scene. A build without it (-DTHIMBLE_GPU=OFF) has gpu_engine_absent.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "thimble/base/memory.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {

class BuiltScene;

class GpuEngine {
 public:
  static bool is_in_build();
  /// The devices of this machine, the one that is used first.
  static std::vector<std::string> devices();

  /// Copies the scene, a compact tree, to the device. Throws InputError: there is none, or the scene is too large.
  explicit GpuEngine(const BuiltScene& built);
  ~GpuEngine();

  /// What that took.
  double seconds() const { return seconds_; }
  /// Most rows of a band for `draw`.
  static std::int32_t most_rows(std::int32_t width_px);
  /// The pixels of `render_band`. Throws InputError when the device fails.
  Status draw(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts);
  /// As `closest_hit`, but that `visits` are steps of the kernel; by any number of threads. Throws InputError when the
  /// device fails.
  Status trace(Span<const Ray> rays, Span<Hit> hits);

 private:
  struct State;
  std::unique_ptr<State> state_;
  double seconds_ = 0;
};

}  // namespace thimble::tools
