/// @file look_note.h
/// What a baked scene keeps of the scene that it was made from, so that its picture without another word is the one of
/// the scene itself: the section of kind `SectionKind::kLook` (src/FORMAT.md). The core never reads it.
#ifndef THIMBLE_TOOLS_SCENE_LOOK_NOTE_H
#define THIMBLE_TOOLS_SCENE_LOOK_NOTE_H

#include <cstdint>
#include <optional>
#include <vector>

#include "scene/lit_description.h"
#include "thimble/base/memory.h"

namespace thimble::tools {

struct SceneFacts;

struct LookNote {
  bool is_mesh = false;
  bool is_points = false;
  bool has_colors = false;
  bool has_own_light = false;    ///< lights, ambient and shadows are the scene's, not of default_look.h
  bool has_own_sky = false;      ///< so is the sky, if there is one
  EffectSet on = Effect::kNone;  ///< what the scene's author turned on and off
  EffectSet off = Effect::kNone;
};

/// Of a scene before anything of the rule's was added.
LookNote note_of(const SceneFacts& facts);

/// The section's 12 bytes, and back. What is not of this version and size says nothing.
std::vector<std::uint8_t> look_section(const LookNote& note);
std::optional<LookNote> read_look_note(ConstBytes section);

/// The lighting of a baked scene without what the rule added. What glows is to be looked for again.
LitDescription without_rule(const LookNote& note, LitDescription baked);

}  // namespace thimble::tools

#endif
