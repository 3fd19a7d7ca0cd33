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

class GpuEngine final : public LitStreams {
 public:
  static bool is_in_build();
  /// The devices of this machine, the one that is used first.
  static std::vector<std::string> devices();

  /// The effects that its kernels draw.
  static EffectSet effects();

  /// Copies the scene to the device. `threads` finish what it has drawn. Throws InputError: there is none, or the scene
  /// is too large.
  GpuEngine(const CompactTree& tree, Span<const Rgb8> palette, int threads);
  ~GpuEngine() override;

  /// The device's name, and whether it is a software driver.
  const std::string& device() const;
  bool is_software() const;
  const char* name() const override { return "gpu"; }
  int threads() const override { return threads_; }
  /// What copying took.
  double seconds() const override { return seconds_; }
  /// Most rows of a band for `draw`.
  static std::int32_t most_rows(std::int32_t width_px);
  /// The pixels of `render_band`. Throws InputError when the device fails.
  Status draw(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts);
  /// As `closest_hit`, but that `visits` are steps of the kernel; by any number of threads. Throws InputError when the
  /// device fails.
  Status trace(Span<const Ray> rays, Span<Hit> hits);

  /// These throw InputError when the device fails.
  Status render(EffectSet effects, const Camera& camera, const Shading& shading, const LitScene& scene,
                const Band& band, LitCounts* counts) override;
  bool finds_shares() const override { return true; }
  Status render_before(const Ground& ground, EffectSet effects, const Camera& camera, const Shading& shading,
                       const LitScene& scene, const Band& band, Bytes shares, LitCounts* counts) override;
  Status render_pixels(EffectSet effects, const Camera& camera, const Shading& shading, const LitScene& scene,
                       Span<const SamplePlace> places, const Ground* ground, Bytes rgb, Bytes shares,
                       LitCounts* counts) override;

 private:
  struct State;
  std::unique_ptr<State> state_;
  int threads_;
  double seconds_ = 0;
};

}  // namespace thimble::tools
