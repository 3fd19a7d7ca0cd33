/// The GPU renderer (platform/gpu) over a scene: its pictures without light, with the light that its kernels draw, and
/// rays. A build without it (-DTHIMBLE_GPU=OFF) has gpu_engine_absent.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/lit_streams.h"
#include "thimble/picture/render.h"

namespace thimble::tools {

class GpuEngine : public LitStreams {
 public:
  static bool is_in_build();
  /// The devices of this machine, the one that is used first.
  static std::vector<std::string> devices();

  /// The effects that its kernels draw.
  static EffectSet effects();

  /// Copies the scene to the device. `threads` finish what it has drawn. Throws InputError: there is none, or the scene
  /// is too large.
  static std::unique_ptr<GpuEngine> make(const CompactTree& tree, Span<const Rgb8> palette, int threads);

  /// The device's name, and whether it is a software driver.
  virtual const std::string& device() const = 0;
  virtual bool is_software() const = 0;
  const char* name() const override { return "gpu"; }
  bool finds_shares() const override { return true; }
  /// Most rows of a band for `draw`.
  virtual std::int32_t most_rows(std::int32_t width_px) const = 0;
  // These, and what it draws as LitStreams, throw InputError when the device fails.

  /// The pixels of `render_band`.
  virtual Status draw(const Camera& camera, const Shading& shading, const Band& band,
                      RenderCounts* counts) = 0;
  /// As `closest_hit`, but that `visits` are steps of the kernel; by any number of threads.
  virtual Status trace(Span<const Ray> rays, Span<Hit> hits) = 0;
};

}  // namespace thimble::tools
