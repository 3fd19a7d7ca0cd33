/// @file effect_options.h
/// --effects, --normals and --bounces: what light does in a picture.
#ifndef THIMBLE_TOOLS_COMMANDS_EFFECT_OPTIONS_H
#define THIMBLE_TOOLS_COMMANDS_EFFECT_OPTIONS_H

#include <cstdint>
#include <optional>
#include <string>

#include "scene/lit_description.h"

namespace CLI {
class App;
}

namespace thimble::tools {

class SceneSource;

struct EffectOptions {
  EffectChoice choice;
  bool given = false;  ///< --effects
  std::optional<std::uint8_t> bounces;

  /// `more` ends the help of --effects.
  void add_to(CLI::App& app, const std::string& more = {});
  /// Whether effects were asked for by name.
  bool named() const {
    return (!choice.automatic && choice.effects != Effect::kNone) || choice.smooth == true;
  }
  /// The scene's lighting with --bounces for its own.
  LitDescription lighting(const SceneSource& source) const;
};

/// --effects (auto, none, all or a list) and --normals alone.
/// `names_default`: the help ends with "(default: auto)".
void add_effect_list(CLI::App& app, EffectChoice* choice, const std::string& help, bool names_default = true);

}  // namespace thimble::tools

#endif
