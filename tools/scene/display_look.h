/// @file display_look.h
/// What a display makes of a scene that somebody bakes for it: the scene's range of brightness becomes the display's,
/// and on one of few greys edges are dark, as faces of one grey would run together.
#ifndef THIMBLE_TOOLS_SCENE_DISPLAY_LOOK_H
#define THIMBLE_TOOLS_SCENE_DISPLAY_LOOK_H

#include <cstdint>

#include "scene/lit_description.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/picture/pixel.h"

namespace thimble::tools {

struct DisplayFacts {
  PixelFormat format = PixelFormat::kRgb888;
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
};

/// Displays of 1, 2 or 4 bits a pixel.
bool has_few_grays(PixelFormat format);

/// Brightens or dims the light of a scene by what a camera sees of it, at most 96 x 96 of the display's pixels. On few
/// greys the brightest twentieth becomes all but white, else the brightest tenth what it is in a picture of
/// `thimble render` (tone.h), both within limits. A function of its arguments, the same on every machine.
void suit_display(const DisplayFacts& display, const CompactTree& tree, const SceneCamera& camera,
                  Span<const Rgb8> palette, const UsedMaterials& used, EffectSet effects,
                  LitDescription* lit);

}  // namespace thimble::tools

#endif
