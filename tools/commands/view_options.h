/// --size, --projection, --eye and the rest that decides how a scene is seen; scene/framing.h makes a camera
/// of it.
#pragma once

#include <string>

namespace CLI {
class App;
}
namespace thimble {
enum class ShadeMode : unsigned char;
namespace platform {
struct BoardFacts;
}
}  // namespace thimble

namespace thimble::tools {

struct Quality;
struct ViewWishes;

/// All that `view` holds. `with_direction_bits`: --direction-bits too.
void add_view(CLI::App& app, ViewWishes* view, bool with_direction_bits = true);
/// The same for pictures that people keep: --view, --turn and --tilt too, and the view and the angle that they
/// start from.
void add_picture_view(CLI::App& app, ViewWishes* view, bool with_direction_bits = true);
/// --direction-bits, for subcommands that have no camera too.
void add_direction_bits(CLI::App& app, int* bits);
/// Without --size the picture is as large as the board's; `board` may be null.
void use_display(const platform::BoardFacts* board, ViewWishes* view);

/// --samples: auto, or squares up to 64; another number is taken as the next of them, and said so. `across` gets
/// the square's side; `of_what` says in the help how they lie, `usual` what is taken without the option.
void add_samples(CLI::App& app, int* across, bool* at_edges, const std::string& of_what,
                 const std::string& usual);
/// --samples, --cutoff and --max-depth.
void add_quality(CLI::App& app, Quality* quality);

/// The shade of displays of one bit (picture/ink.h).
inline constexpr const char* kInk = "ink";
/// --shade. `given` gets its word where it is given, and without it the scene's own look is drawn; null: depth is. With
/// `has_ink` ink is one of them, whose tones are palette colours.
void add_shade(CLI::App& app, ShadeMode* mode, const std::string& help, std::string* given = nullptr,
               bool has_ink = false);

}  // namespace thimble::tools
