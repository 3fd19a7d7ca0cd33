/// A picture on disk, and the command that makes the same one.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scene/framing.h"
#include "scene/scene_arguments.h"

namespace thimble::tools::viewer {

/// A word as a shell takes it: in single quotes where it has anything but letters, digits and `_-.,:/=+@%`.
std::string quoted_for_shell(std::string_view word);

/// `thimble render SCENE ...`: the scene's and the view's options where they are not the defaults, `look`,
/// and `-o output`. An eye, a target and the like are written in the digits that they have.
std::string render_command(const SceneArguments& scene, const ViewWishes& view,
                           const std::vector<std::string>& look, const std::string& output);

/// The first of castle.png, castle-2.png, castle-3.png ... in the current folder that is not there, for
/// models/castle.vox; for points:1000 points-1000.png. Throws OutputError when none of 9,999 is free.
std::string free_picture_name(const std::string& scene);

/// Writes r, g, b bytes as a PNG of a name that is free; another file never loses its name to it. Returns the
/// name. Throws OutputError.
std::string save_picture(const std::string& scene, std::int32_t width_px, std::int32_t height_px,
                         const std::vector<std::uint8_t>& rgb);

}  // namespace thimble::tools::viewer
