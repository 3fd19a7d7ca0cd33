#include "scene/wide_rays.h"

#include "scene/built_scene.h"
#include "wide/rays/ray_map.h"

namespace thimble::tools {

struct WideRays::Map {
  wide::RayMap map;
};

WideRays::WideRays(std::unique_ptr<Map> map) : map_(std::move(map)) {}
WideRays::~WideRays() = default;

std::unique_ptr<WideRays> WideRays::make(BuiltScene* built) {
  if (built->structure() != StructureKind::kCompact) {
    return nullptr;
  }
  auto map = std::make_unique<Map>();
  if (wide::RayMap::make(built->compact(), &built->arena(), &map->map) != Status::kOk) {
    return nullptr;
  }
  return std::unique_ptr<WideRays>(new WideRays(std::move(map)));
}

Status WideRays::first_hit(Span<const Ray> rays, Span<Hit> hits) const {
  return wide::first_hit(map_->map, rays, hits);
}

}  // namespace thimble::tools
