// What a build without the GPU renderer has in its place: --engine gpu is refused before any is made.
#include "scene/gpu_engine.h"

namespace thimble::tools {

struct GpuEngine::State {
  std::string device;
};

bool GpuEngine::is_in_build() {
  return false;
}

std::vector<std::string> GpuEngine::devices() {
  return {};
}

EffectSet GpuEngine::effects() {
  return Effect::kNone;
}

GpuEngine::GpuEngine(const CompactTree& /*tree*/, Span<const Rgb8> /*palette*/, int threads)
    : threads_(threads) {}
GpuEngine::~GpuEngine() = default;

const std::string& GpuEngine::device() const {
  return state_->device;
}
bool GpuEngine::is_software() const {
  return true;
}

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

Status GpuEngine::render(EffectSet /*effects*/, const Camera& /*camera*/, const Shading& /*shading*/,
                         const LitScene& /*scene*/, const Band& /*band*/, LitCounts* /*counts*/) {
  return Status::kBadArgument;
}

Status GpuEngine::render_before(const Ground& /*ground*/, EffectSet /*effects*/, const Camera& /*camera*/,
                                const Shading& /*shading*/, const LitScene& /*scene*/, const Band& /*band*/,
                                Bytes /*shares*/, LitCounts* /*counts*/) {
  return Status::kBadArgument;
}

Status GpuEngine::render_pixels(EffectSet /*effects*/, const Camera& /*camera*/, const Shading& /*shading*/,
                                const LitScene& /*scene*/, Span<const SamplePlace> /*places*/,
                                const Ground* /*ground*/, Bytes /*rgb*/, Bytes /*shares*/,
                                LitCounts* /*counts*/) {
  return Status::kBadArgument;
}

}  // namespace thimble::tools
