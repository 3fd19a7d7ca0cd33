#include "scene/gpu_engine.h"

#include <algorithm>
#include <chrono>
#include <mutex>

#include "gpu/renderer.h"
#include "readers/source.h"

namespace thimble::tools {
namespace {

// Turns a fault of the device into an InputError.
template <class Work>
auto told(Work&& work) {
  try {
    return work();
  } catch (const gpu::DeviceError& error) {
    throw InputError("--engine gpu: ", error.what());
  }
}

gpu::Backdrop backdrop_of(const Ground* given) {
  static_assert(kAroundCount == 32 && kAroundLength == 128);
  const Ground ground = given != nullptr ? *given : Ground{};
  return {ground.is_there, ground.z, ground.reach, ground.toward_sun, kAround};
}

class Device final : public GpuEngine {
 public:
  Device(const CompactTree& tree, Span<const Rgb8> palette, int threads)
      : start_(Clock::now()),
        renderer_(tree, palette, {}),
        threads_(threads),
        seconds_(std::chrono::duration<double>(Clock::now() - start_).count()) {}

  const std::string& device() const override { return renderer_.device().name; }
  bool is_software() const override { return renderer_.device().is_software; }
  int threads() const override { return threads_; }
  double seconds() const override { return seconds_; }
  std::int32_t most_rows(std::int32_t width_px) const override { return gpu::Renderer::most_rows(width_px); }

  Status draw(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts) override {
    return told([&] { return renderer_.draw(camera, shading, band, counts); });
  }
  Status trace(Span<const Ray> rays, Span<Hit> hits) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return told([&] { return renderer_.trace(rays, hits); });
  }
  Status render(const LitView& view, const Band& band, LitCounts* counts, Bytes shares) override {
    const gpu::Backdrop backdrop = backdrop_of(view.ground);
    return draw_lit(frame_of(view, backdrop), band, view.ground != nullptr ? shares : Bytes(), counts);
  }
  Status render_pixels(const LitView& view, Span<const SamplePlace> places, Bytes rgb, LitCounts* /*counts*/,
                       Bytes shares) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const gpu::Backdrop backdrop = backdrop_of(view.ground);
    words_.resize(places.size);
    std::transform(places.data, places.data + places.size, words_.begin(), [](const SamplePlace& place) {
      return static_cast<std::uint32_t>(place.x) | static_cast<std::uint32_t>(place.y) << 16;
    });
    const Status status = told([&] {
      return renderer_.draw_places(frame_of(view, backdrop), {words_.data(), words_.size()});
    });
    for (std::size_t i = 0; i < words_.size() && status == Status::kOk; ++i) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        rgb.data[3 * i + channel] = static_cast<std::uint8_t>(words_[i] >> (8 * channel));
      }
      if (view.ground != nullptr) {
        shares.data[i] = static_cast<std::uint8_t>(words_[i] >> 24);
      }
    }
    return status;
  }

 private:
  using Clock = std::chrono::steady_clock;

  static gpu::LitFrame frame_of(const LitView& view, const gpu::Backdrop& backdrop) {
    return {view.effects, view.camera, view.shading, view.scene,
            view.ground != nullptr ? &backdrop : nullptr};
  }
  Status draw_lit(const gpu::LitFrame& frame, Band band, Bytes shares, LitCounts* counts) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::int32_t width = frame.camera.width_px();
    const std::int32_t end = band.first_row + band.rows;
    Status status = Status::kOk;
    while (status == Status::kOk && band.first_row < end) {
      band.rows = std::min(most_rows(width), end - band.first_row);
      status = told([&] { return renderer_.draw_lit(frame, band, shares, counts); });
      const auto rows = static_cast<std::size_t>(band.rows);
      band.first_row += band.rows;
      band.pixels = band.pixels.subspan(rows * row_bytes(band.format, width));
      shares = shares.subspan(std::min(shares.size, rows * static_cast<std::size_t>(width)));
    }
    return status;
  }

  Clock::time_point start_;
  std::mutex mutex_;
  gpu::Renderer renderer_;
  int threads_;
  double seconds_;
  std::vector<std::uint32_t> words_;  // of single pixels
};

}  // namespace

bool GpuEngine::is_in_build() {
  return true;
}

std::vector<std::string> GpuEngine::devices() {
  std::vector<std::string> names;
  for (const gpu::DeviceInfo& device : gpu::devices()) {
    names.push_back(device.name + (device.is_software ? " (software)" : ""));
  }
  return names;
}

EffectSet GpuEngine::effects() {
  return gpu::kEffectsInKernels;
}

std::unique_ptr<GpuEngine> GpuEngine::make(const CompactTree& tree, Span<const Rgb8> palette, int threads) {
  return told([&] { return std::make_unique<Device>(tree, palette, threads); });
}

}  // namespace thimble::tools
