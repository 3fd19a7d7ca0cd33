/// @file wide_rays.h
/// Many rays at a time through a built scene, by vectors, where there is room for the map that they need.
#ifndef THIMBLE_TOOLS_SCENE_WIDE_RAYS_H
#define THIMBLE_TOOLS_SCENE_WIDE_RAYS_H

#include <memory>

#include "thimble/base/memory.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {

class BuiltScene;

class WideRays {
 public:
  /// Takes the map's bytes from the scene's arena. Null where they do not fit, where the structure is not a
  /// compact tree, and in a build without vectors: the core then traces.
  static std::unique_ptr<WideRays> make(BuiltScene* built);
  ~WideRays();

  /// What each ray enters first, as the core says; `visits` are steps of this engine. Any number of threads at
  /// a time. Status as `closest_hit`.
  Status first_hit(Span<const Ray> rays, Span<Hit> hits) const;

 private:
  struct Map;
  explicit WideRays(std::unique_ptr<Map> map);

  std::unique_ptr<Map> map_;
};

}  // namespace thimble::tools

#endif
