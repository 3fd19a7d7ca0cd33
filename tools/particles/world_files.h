/// @file world_files.h
/// A particle world as text that machines read.
#ifndef THIMBLE_TOOLS_PARTICLES_WORLD_FILES_H
#define THIMBLE_TOOLS_PARTICLES_WORLD_FILES_H

#include <string>

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

}  // namespace thimble::tools

#endif
