/// A particle world as text that machines read.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "output/image.h"
#include "particles/player.h"
#include "particles/populated_world.h"

namespace thimble::tools {

/// The columns of `state_csv`: centre and velocity in 2^-16 cells (a step), half the diameter likewise, 0
/// or 1.
inline constexpr const char* kStateColumns = "id,x_q16,y_q16,vx_q16,vy_q16,radius_q16,asleep";

/// A header line, then a line for each ball in order of number.
std::string state_csv(const ParticleWorld& world);

/// One JSON object; `step_seconds` is what the steps took.
std::string particle_stats(const PopulatedWorld& populated, const PlayedCounts& counts, double step_seconds);

/// What a run came to, for a person.
std::string particle_summary(const PopulatedWorld& populated, const PlayedCounts& counts,
                             double step_seconds);

// A particle world as a picture: a pixel a cell.

/// r, g, b of every cell, rows from the top: balls in their colours, walls grey, the rest nearly black.
void draw_world(const PopulatedWorld& populated, std::vector<std::uint8_t>* rgb);

/// Lines of text at the top left of such a picture, as large as a third of its width allows, at most three
/// pixels a dot.
void draw_figures(std::int32_t width_px, std::int32_t height_px, std::string_view text,
                  std::vector<std::uint8_t>* rgb);

/// The collision field itself: unlit where a cell is set, so that a PBM has a 1 there.
Image field_image(const BitField& field);

}  // namespace thimble::tools
