// What a build without the wide renderer has in its place: nothing of it is made, so that the core draws and traces.
#include "scene/lit_streams.h"
#include "scene/wide_renderer.h"

namespace thimble::tools {

std::vector<std::string> WideRenderer::instruction_sets() {
  return {};
}

std::size_t WideRenderer::bytes(const CompactTree& /*tree*/, std::int32_t /*width_px*/,
                                std::int32_t /*height_px*/, int /*threads*/) {
  return SIZE_MAX;
}

std::unique_ptr<WideRenderer> WideRenderer::make(const CompactTree& /*tree*/, Arena* /*arena*/,
                                                 std::int32_t /*width_px*/, std::int32_t /*height_px*/,
                                                 int /*threads*/) {
  return nullptr;
}

FirstHits wide_first_hits(BuiltScene* /*built*/) {
  return nullptr;
}

std::unique_ptr<LitStreams> LitStreams::make(const CompactTree& /*tree*/, Arena* /*arena*/,
                                             EffectSet /*effects*/, const LitScene& /*scene*/,
                                             int /*threads*/) {
  return nullptr;
}

}  // namespace thimble::tools
