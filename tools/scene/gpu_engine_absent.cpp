// What a build without the GPU renderer has in its place: --engine gpu is refused before any is made.
#include "scene/gpu_engine.h"

namespace thimble::tools {

bool GpuEngine::is_in_build() {
  return false;
}

std::vector<std::string> GpuEngine::devices() {
  return {};
}

EffectSet GpuEngine::effects() {
  return Effect::kNone;
}

std::unique_ptr<GpuEngine> GpuEngine::make(const CompactTree& /*tree*/, Span<const Rgb8> /*palette*/,
                                           int /*threads*/) {
  return nullptr;
}

}  // namespace thimble::tools
