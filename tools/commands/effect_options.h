/// @file effect_options.h
/// --effects, --normals and --bounces: what light does in a picture.
#ifndef THIMBLE_TOOLS_COMMANDS_EFFECT_OPTIONS_H
#define THIMBLE_TOOLS_COMMANDS_EFFECT_OPTIONS_H

#include <string>

#include "scene/lit_description.h"

namespace CLI {
class App;
}

namespace thimble::tools {

/// `more` ends the help of --effects; `usual` is what it says of the default.
void add_effect_options(CLI::App& app, EffectWishes* wishes, const std::string& more = {},
                        const std::string& usual = "auto");

/// --effects (auto, none, all or a list) and --normals alone.
/// `names_default`: the help ends with "(default: auto)".
void add_effect_list(CLI::App& app, EffectChoice* choice, const std::string& help, bool names_default = true);

}  // namespace thimble::tools

#endif
