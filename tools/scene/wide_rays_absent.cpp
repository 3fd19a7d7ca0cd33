// What a build without vectors has in their place: no map is ever made, so that the core traces.
#include "scene/wide_rays.h"

namespace thimble::tools {

struct WideRays::Map {};

WideRays::WideRays(std::unique_ptr<Map> map) : map_(std::move(map)) {}
WideRays::~WideRays() = default;

std::unique_ptr<WideRays> WideRays::make(BuiltScene* /*built*/) {
  return nullptr;
}

Status WideRays::first_hit(Span<const Ray> /*rays*/, Span<Hit> /*hits*/) const {
  return Status::kBadArgument;
}

}  // namespace thimble::tools
