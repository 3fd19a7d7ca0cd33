/// What blocks of Minecraft and Minetest look like: one plain colour of this project's own a kind of block.
///
/// A name such as `minecraft:oak_leaves[persistent=true]` or `default:aspen_tree` is stripped of what stands
/// before the first colon and in brackets, and the first entry of a table whose word is part of it gives the
/// colour; a colour's name in front (`light_blue_wool`) gives that. Numbers of blocks from before names (0 to
/// 255) have a table of names.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "readers/source.h"

namespace thimble::tools {

/// The colour of a block by its name; nothing for air and what is as invisible. A name that says nothing is
/// grey.
std::optional<Rgb> block_color(std::string_view name);

/// The same by its number in files from before 2018. `data` tells the colour of wool, clay and glass.
std::optional<Rgb> block_color(unsigned number, unsigned data);

}  // namespace thimble::tools
