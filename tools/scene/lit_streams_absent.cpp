// What a build without the wide renderer has in its place: the core draws lit pictures.
#include "scene/lit_streams.h"

namespace thimble::tools {

std::unique_ptr<LitStreams> LitStreams::make(const CompactTree& /*tree*/, Arena* /*arena*/,
                                             EffectSet /*effects*/, const LitScene& /*scene*/,
                                             int /*threads*/) {
  return nullptr;
}

}  // namespace thimble::tools
