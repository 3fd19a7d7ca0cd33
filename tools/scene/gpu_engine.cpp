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
    throw InputError(std::string("--engine gpu: ") + error.what());
  }
}

}  // namespace

struct GpuEngine::State {
  Status draw(const gpu::LitFrame& frame, Band band, Bytes shares, LitCounts* counts);

  std::mutex mutex;
  gpu::Renderer renderer;
  std::vector<std::uint32_t> words;  // of single pixels
};

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

GpuEngine::GpuEngine(const CompactTree& tree, Span<const Rgb8> palette, int threads) : threads_(threads) {
  const auto start = std::chrono::steady_clock::now();
  state_ = told([&] { return std::unique_ptr<State>(new State{{}, {tree, palette, {}}, {}}); });
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

GpuEngine::~GpuEngine() = default;

const std::string& GpuEngine::device() const {
  return state_->renderer.device().name;
}
bool GpuEngine::is_software() const {
  return state_->renderer.device().is_software;
}

std::int32_t GpuEngine::most_rows(std::int32_t width_px) {
  return gpu::Renderer::most_rows(width_px);
}

Status GpuEngine::draw(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts) {
  return told([&] { return state_->renderer.draw(camera, shading, band, counts); });
}

Status GpuEngine::trace(Span<const Ray> rays, Span<Hit> hits) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return told([&] { return state_->renderer.trace(rays, hits); });
}

Status GpuEngine::State::draw(const gpu::LitFrame& frame, Band band, Bytes shares, LitCounts* counts) {
  const std::lock_guard<std::mutex> lock(mutex);
  const std::int32_t end = band.first_row + band.rows;
  Status status = Status::kOk;
  while (status == Status::kOk && band.first_row < end) {
    band.rows = std::min(most_rows(frame.camera.width_px()), end - band.first_row);
    status = told([&] { return renderer.draw_lit(frame, band, shares, counts); });
    const auto rows = static_cast<std::size_t>(band.rows);
    band.first_row += band.rows;
    band.pixels = band.pixels.subspan(rows * row_bytes(band.format, frame.camera.width_px()));
    shares = shares.subspan(std::min(shares.size, rows * static_cast<std::size_t>(frame.camera.width_px())));
  }
  return status;
}

Status GpuEngine::render(EffectSet effects, const Camera& camera, const Shading& shading,
                         const LitScene& scene, const Band& band, LitCounts* counts) {
  return state_->draw({effects, camera, shading, scene}, band, {}, counts);
}

namespace {

gpu::Backdrop backdrop_of(const Ground& ground) {
  static_assert(kAroundCount == 32 && kAroundLength == 128);
  return {ground.is_there, ground.z, ground.reach, ground.toward_sun, kAround};
}

}  // namespace

Status GpuEngine::render_before(const Ground& ground, EffectSet effects, const Camera& camera,
                                const Shading& shading, const LitScene& scene, const Band& band, Bytes shares,
                                LitCounts* counts) {
  const gpu::Backdrop backdrop = backdrop_of(ground);
  return state_->draw({effects, camera, shading, scene, &backdrop}, band, shares, counts);
}

Status GpuEngine::render_pixels(EffectSet effects, const Camera& camera, const Shading& shading,
                                const LitScene& scene, Span<const SamplePlace> places, const Ground* ground,
                                Bytes rgb, Bytes shares, LitCounts* /*counts*/) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  const gpu::Backdrop backdrop = backdrop_of(ground != nullptr ? *ground : Ground{});
  std::vector<std::uint32_t>& words = state_->words;
  words.resize(places.size);
  std::transform(places.data, places.data + places.size, words.begin(), [](const SamplePlace& place) {
    return static_cast<std::uint32_t>(place.x) | static_cast<std::uint32_t>(place.y) << 16;
  });
  const Status status = told([&] {
    return state_->renderer.draw_places(
        {effects, camera, shading, scene, ground != nullptr ? &backdrop : nullptr},
        {words.data(), words.size()});
  });
  for (std::size_t i = 0; i < words.size() && status == Status::kOk; ++i) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      rgb.data[3 * i + channel] = static_cast<std::uint8_t>(words[i] >> (8 * channel));
    }
    if (ground != nullptr) {
      shares.data[i] = static_cast<std::uint8_t>(words[i] >> 24);
    }
  }
  return status;
}

}  // namespace thimble::tools
