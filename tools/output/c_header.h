/// A baked scene as a C and C++ header: bytes for flash, and the facts that a program can choose by when it
/// is compiled.
#pragma once

#include <string>
#include <string_view>

#include "thimble/bake/baked_scene.h"

namespace thimble::tools {

/// What the array is called where nobody says.
inline constexpr const char* kDefaultIdentifier = "thimble_scene";

/// Whether `text` can name a variable in C and in C++: letters, digits and _, no keyword, no leading _ or
/// digit, no two _ in a row, at most 63 characters.
bool is_identifier(std::string_view text);

/// The header: macros IDENTIFIER_BYTES, _DEPTH, ... (the identifier in capitals: THIMBLE_SCENE_... by
/// default; _EFFECTS is the set of scene.h that the scene was baked for, 0 for none, _LAMPS how many of its
/// lights are points), then `static const uint8_t identifier[IDENTIFIER_BYTES]`, aligned to 4 bytes. It
/// includes <stdint.h> and nothing else.
std::string c_header_text(const BakedScene& scene, std::string_view identifier);

}  // namespace thimble::tools
