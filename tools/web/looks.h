/// The command's own look (scene/default_look.h) and framing of a scene that was baked in a page.
#pragma once

#include <memory>

#include "scene/scene_source.h"
#include "thimble/bake/baked_scene.h"

namespace thimble::tools {

/// From now on the exports of looks.cpp are about this scene, baked from `source`.
void look_at_scene(std::unique_ptr<SceneSource> source, const BakedScene& scene);

}  // namespace thimble::tools
