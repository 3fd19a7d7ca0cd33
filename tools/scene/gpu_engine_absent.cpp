// What a build without the GPU renderer has in its place: --engine gpu is refused before any is made.
#include "scene/gpu_engine.h"

namespace thimble::tools {

struct GpuEngine::State {};

bool GpuEngine::is_in_build() {
  return false;
}

std::vector<std::string> GpuEngine::devices() {
  return {};
}

GpuEngine::GpuEngine(const BuiltScene& /*built*/) {}
GpuEngine::~GpuEngine() = default;

std::int32_t GpuEngine::most_rows(std::int32_t /*width_px*/) {
  return 1;
}

Status GpuEngine::draw(const Camera& /*camera*/, const Shading& /*shading*/, const Band& /*band*/,
                       RenderCounts* /*counts*/) {
  return Status::kBadArgument;
}

Status GpuEngine::trace(Span<const Ray> /*rays*/, Span<Hit> /*hits*/) {
  return Status::kBadArgument;
}

}  // namespace thimble::tools
