/// The command's own look (scene/default_look.h) and framing of a scene that was baked in a page.
#pragma once

#include <memory>

#include "scene/default_look.h"
#include "scene/scene_shape.h"
#include "scene/scene_source.h"
#include "thimble/bake/baked_scene.h"

namespace thimble::tools {

/// The shape to frame `tree` of `source` by: of another frame of the animation that is looked at, the one that is known.
SceneShape shape_to_frame(const SceneSource& source, const CompactTree& tree);
/// From now on the exports of looks.cpp are about this scene, baked from `source` and framed by `shape`.
void look_at_scene(std::unique_ptr<SceneSource> source, const BakedScene& scene, const SceneShape& shape);

/// What its looks are to have that the rule would choose; nothing of a page's own scenes.
void wish_of_looks(const LookWishes& wishes);

}  // namespace thimble::tools
