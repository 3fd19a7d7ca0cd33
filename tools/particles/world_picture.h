/// @file world_picture.h
/// A particle world as a picture: a pixel a cell.
#ifndef THIMBLE_TOOLS_PARTICLES_WORLD_PICTURE_H
#define THIMBLE_TOOLS_PARTICLES_WORLD_PICTURE_H

#include <cstdint>
#include <string_view>
#include <vector>

#include "output/image.h"
#include "particles/populated_world.h"

namespace thimble::tools {

/// r, g, b of every cell, rows from the top: balls in their colours, walls grey, the rest nearly black.
void draw_world(const PopulatedWorld& populated, std::vector<std::uint8_t>* rgb);

/// Lines of text at the top left of such a picture, as large as a third of its width allows, at most three
/// pixels a dot.
void draw_figures(std::int32_t width_px, std::int32_t height_px, std::string_view text,
                  std::vector<std::uint8_t>* rgb);

/// The collision field itself: unlit where a cell is set, so that a PBM has a 1 there.
Image field_image(const BitField& field);

}  // namespace thimble::tools

#endif
