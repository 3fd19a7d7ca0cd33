/// The knobs of the simulations: what each costs, and how far its world is after the same time from a finer
/// one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "instruments/timed_frames.h"
#include "output/tables.h"
#include "readers/progress.h"

namespace thimble::tools {

/// The worlds that are measured.
///
/// kParticles: the paper's 693 balls on 800 x 600 cells (seed 1), after kParticleSteps steps, against 16
/// substeps and the finest positions. Short on purpose: after a collision two runs part for good, which says
/// nothing about either. Error: distance of the centres, cells; the median ball's counts, as the few that met
/// others differently would drown it.
///
/// kWater: a square basin that is pressed down by a voxel round a point, after the time in which a wave
/// crosses half of it, undamped, against kWaterReference columns a side in as many steps as the slowest waves
/// take. The basin, the bowl and the time are the same, whatever columns and steps. Error: heights against
/// the means of the reference's columns, voxels; their root mean square counts.
enum class SimulationWorld : std::uint8_t { kParticles, kWater };
inline constexpr int kParticleSteps = 10;
inline constexpr int kWaterReference = 256;

struct SimulationRow : MedianTime {  ///< times: of all steps together
  int substeps = 0;                  ///< particles
  int subpixel_bits = 0;
  int columns = 0;        ///< water: a side
  int wave_speed_q6 = 0;  ///< columns a step: half of it takes twice the steps
  int steps = 0;
  std::uint64_t work = 0;  ///< displacements made, or columns worked out
  double error_rms = 0;
  double error_median = 0;
  double error_most = 0;
  bool front = false;  ///< no other row is both as fast and as near to the reference
};

/// Measures by turns, `rounds` times each.
std::vector<SimulationRow> study_simulation(SimulationWorld world, int rounds, const Progress& progress);

JsonRow simulation_objects(SimulationWorld world, const std::vector<SimulationRow>& rows);
std::string simulation_table(SimulationWorld world, const std::vector<SimulationRow>& rows);
std::string simulation_plot(SimulationWorld world, const std::vector<SimulationRow>& rows);

}  // namespace thimble::tools
