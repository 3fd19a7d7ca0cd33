#include "scene/gpu_engine.h"

#include <chrono>
#include <mutex>

#include "gpu/renderer.h"
#include "readers/source.h"
#include "scene/built_scene.h"

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
  std::mutex mutex;
  gpu::Renderer renderer;
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

GpuEngine::GpuEngine(const BuiltScene& built) {
  const auto start = std::chrono::steady_clock::now();
  const Span<const Rgb8> palette(built.palette().data(), built.palette().size());
  state_ = told([&] { return std::unique_ptr<State>(new State{{}, {built.compact(), palette, {}}}); });
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

GpuEngine::~GpuEngine() = default;

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

}  // namespace thimble::tools
