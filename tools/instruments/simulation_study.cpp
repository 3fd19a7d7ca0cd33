#include "instruments/simulation_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "output/plot.h"
#include "output/units.h"
#include "particles/populated_world.h"
#include "readers/source.h"
#include "thimble/light/water.h"

namespace thimble::tools {
namespace {

constexpr int kMostSubsteps = 16;
constexpr int kFinestBits = 15;

// --- Particles

struct Places {
  std::vector<double> x;
  std::vector<double> y;
  std::uint64_t moves = 0;
  double ms = 0;
};

Places run_particles(int substeps, int subpixel_bits) {
  WorldOptions options;
  options.subpixel_bits = subpixel_bits;
  options.substeps_log2 = 0;
  while ((1 << options.substeps_log2) < substeps) {
    ++options.substeps_log2;
  }
  PopulatedWorld populated(options, std::nullopt);
  ParticleWorld& world = populated.world();
  Places places;
  const FrameWatch watch;
  for (int step = 0; step < kParticleSteps; ++step) {
    world.step();
    places.moves += world.counters().moves;
  }
  places.ms = watch.ms();
  for_each_ball(world, [&](const Particle& ball) {
    places.x.push_back(ball.x_q16 / 65536.0);
    places.y.push_back(ball.y_q16 / 65536.0);
  });
  return places;
}

// --- Water

constexpr std::int32_t kRestVoxels = 64;
constexpr std::int32_t kPressedQ8 = 256;

struct Basin {
  int columns = 0;
  std::vector<double> heights;  // from the rest level, voxels
  std::uint64_t work = 0;
  double ms = 0;
};

int water_steps(int columns, int wave_speed_q6) {
  return columns * 32 / wave_speed_q6;
}

Basin run_water(int columns, int wave_speed_q6) {
  WaterConfig config;
  config.width = columns;
  config.depth = columns;
  config.rest_q8 = kRestVoxels * 256;
  config.greatest_q8 = 2 * config.rest_q8;
  config.wave_speed_q6 = wave_speed_q6;
  config.damping_q12 = 0;
  std::vector<std::uint8_t> bytes(water_bytes(columns, columns));
  Water water;
  const std::int32_t side_q8 = columns * 256;
  if (Water::make(config, {bytes.data(), bytes.size()}, &water) != Status::kOk ||
      water.touch(side_q8 * 3 / 8, side_q8 * 7 / 16, side_q8 / 8, kPressedQ8) != Status::kOk) {
    throw InputError("internal error: the basin cannot be set up");
  }
  Basin basin;
  basin.columns = columns;
  const FrameWatch watch;
  for (int step = 0; step < water_steps(columns, wave_speed_q6); ++step) {
    water.step();
  }
  basin.ms = watch.ms();
  basin.work = water.columns_updated();
  for (int y = 0; y < columns; ++y) {
    for (int x = 0; x < columns; ++x) {
      basin.heights.push_back(water.height_q16(x, y) / 65536.0 - kRestVoxels);
    }
  }
  return basin;
}

// The mean of the reference's columns where the coarse one stands.
double mean_height(const Basin& reference, int columns, int x, int y) {
  const int across = reference.columns / columns;
  double sum = 0;
  for (int j = y * across; j < (y + 1) * across; ++j) {
    for (int i = x * across; i < (x + 1) * across; ++i) {
      sum += reference.heights[static_cast<std::size_t>(j) * static_cast<std::size_t>(reference.columns) +
                               static_cast<std::size_t>(i)];
    }
  }
  return sum / (across * across);
}

// --- Both

void set_errors(std::vector<double> errors, SimulationRow* row) {
  double squares = 0;
  for (const double error : errors) {
    squares += error * error;
    row->error_most = std::max(row->error_most, error);
  }
  row->error_rms = std::sqrt(squares / static_cast<double>(errors.size()));
  row->error_median = quantile(std::move(errors), 0.5);
}

std::vector<SimulationRow> particle_rows() {
  std::vector<SimulationRow> rows;
  for (const int bits : {kFinestBits, 10, 8, 6}) {
    for (int substeps = 1; substeps <= kMostSubsteps; substeps *= 2) {
      SimulationRow row;
      row.substeps = substeps;
      row.subpixel_bits = bits;
      row.steps = kParticleSteps;
      rows.push_back(row);
    }
  }
  return rows;
}

std::vector<SimulationRow> water_rows() {
  std::vector<SimulationRow> rows;
  for (const int speed : {kMaxWaveSpeedQ6, kMaxWaveSpeedQ6 / 2, kMinWaveSpeedQ6}) {
    for (int columns = 16; columns < kWaterReference; columns *= 2) {
      SimulationRow row;
      row.columns = columns;
      row.wave_speed_q6 = speed;
      row.steps = water_steps(columns, speed);
      rows.push_back(row);
    }
  }
  return rows;
}

// The error that counts.
double counted_error(SimulationWorld world, const SimulationRow& row) {
  return world == SimulationWorld::kWater ? row.error_rms : row.error_median;
}

}  // namespace

std::vector<SimulationRow> study_simulation(SimulationWorld world, int rounds, const Progress& progress) {
  const bool is_water = world == SimulationWorld::kWater;
  std::vector<SimulationRow> rows = is_water ? water_rows() : particle_rows();
  const Places places = is_water ? Places{} : run_particles(kMostSubsteps, kFinestBits);
  const Basin basin = is_water ? run_water(kWaterReference, kMinWaveSpeedQ6) : Basin{};
  std::vector<std::vector<double>> milliseconds(rows.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      SimulationRow& row = rows[i];
      std::vector<double> errors;
      if (is_water) {
        const Basin coarse = run_water(row.columns, row.wave_speed_q6);
        milliseconds[i].push_back(coarse.ms);
        row.work = coarse.work;
        for (int y = 0; round == 0 && y < row.columns; ++y) {
          for (int x = 0; x < row.columns; ++x) {
            const double height =
                coarse.heights[static_cast<std::size_t>(y) * static_cast<std::size_t>(row.columns) +
                               static_cast<std::size_t>(x)];
            errors.push_back(std::abs(height - mean_height(basin, row.columns, x, y)));
          }
        }
      } else {
        const Places coarse = run_particles(row.substeps, row.subpixel_bits);
        milliseconds[i].push_back(coarse.ms);
        row.work = coarse.moves;
        for (std::size_t ball = 0; round == 0 && ball < places.x.size(); ++ball) {
          errors.push_back(std::hypot(coarse.x[ball] - places.x[ball], coarse.y[ball] - places.y[ball]));
        }
      }
      if (round == 0) {
        set_errors(std::move(errors), &row);
      }
      if (progress) {
        progress((static_cast<double>(round) + static_cast<double>(i) / static_cast<double>(rows.size())) /
                 rounds);
      }
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].set_times(milliseconds[i]);
  }
  for (SimulationRow& row : rows) {
    const double error = counted_error(world, row);
    row.front = std::none_of(rows.begin(), rows.end(), [&](const SimulationRow& other) {
      const double others = counted_error(world, other);
      return other.ms_median <= row.ms_median && others <= error &&
             (other.ms_median < row.ms_median || others < error);
    });
  }
  return rows;
}

JsonRow simulation_objects(SimulationWorld world, const std::vector<SimulationRow>& rows) {
  const bool is_water = world == SimulationWorld::kWater;
  const auto only = [](bool is_there, int value) { return is_there ? JsonRow(value) : JsonRow(nullptr); };
  JsonRow objects = JsonRow::array();
  for (const SimulationRow& row : rows) {
    JsonRow object;
    object["row"] = is_water ? "water" : "particles";
    object["substeps"] = only(!is_water, row.substeps);
    object["subpixel_bits"] = only(!is_water, row.subpixel_bits);
    object["columns"] = only(is_water, row.columns);
    object["wave_speed_q6"] = only(is_water, row.wave_speed_q6);
    object["steps"] = row.steps;
    object["work"] = row.work;
    row.add_to(&object);
    object["unit"] = is_water ? "voxels" : "cells";
    object["error_rms"] = row.error_rms;
    object["error_median"] = row.error_median;
    object["error_most"] = row.error_most;
    object["front"] = row.front ? 1 : 0;
    objects.push_back(object);
  }
  return objects;
}

std::string simulation_table(SimulationWorld world, const std::vector<SimulationRow>& rows) {
  const bool is_water = world == SimulationWorld::kWater;
  std::vector<Cells> table{{"", is_water ? "columns" : "substeps", is_water ? "wave speed" : "bits", "steps",
                            is_water ? "columns updated" : "moves", "ms", "+-%", "error RMS", "median",
                            "most"}};
  for (const SimulationRow& row : rows) {
    table.push_back({row.front ? "*" : "", std::to_string(is_water ? row.columns : row.substeps),
                     is_water ? fixed(row.wave_speed_q6 / 64.0, 3) : std::to_string(row.subpixel_bits),
                     std::to_string(row.steps), grouped(row.work), fixed(row.ms_median, 3), row.spread(),
                     fixed(row.error_rms, 4), fixed(row.error_median, 4), fixed(row.error_most, 3)});
  }
  const std::string head =
      is_water
          ? "a basin of water pressed down by a voxel, when a wave has crossed half of it: heights against\n"
            "those of 256 columns a side at a wave speed of 0.125, voxels; wave speed: columns a step\n"
          : "the paper's 693 balls after " + std::to_string(kParticleSteps) +
                " steps: distance of the centres from those with 16 substeps and\n"
                "positions of 2^-15 cells, cells; bits: positions are kept to 2^-bits cells\n";
  return head + "(*: no setting is both faster and nearer to the reference, by the " +
         (is_water ? "RMS" : "median") + ")\n" + columns_of(table, 1);
}

std::string simulation_plot(SimulationWorld world, const std::vector<SimulationRow>& rows) {
  const bool is_water = world == SimulationWorld::kWater;
  Plot plot;
  plot.title = is_water ? "Water: error against time, 16 to 128 columns a side"
                        : "Particles: error against time, 1 to 16 substeps";
  plot.x_label = is_water
                     ? "processor time until a wave has crossed half the basin, ms (median, this machine)"
                     : "processor time of 10 steps of 693 balls, ms (median, this machine)";
  plot.y_label = is_water ? "RMS error of heights, voxels" : "median error of positions, cells (0 not shown)";
  for (const SimulationRow& row : rows) {
    const std::string name = is_water ? fixed(row.wave_speed_q6 / 64.0, 3) + " columns a step"
                                      : "positions of 2^-" + std::to_string(row.subpixel_bits) + " cells";
    if (plot.series.empty() || plot.series.back().name != name) {
      plot.series.push_back({name, false, {}});
    }
    if (const double error = counted_error(world, row); error > 0 && row.ms_median > 0) {
      plot.series.back().points.emplace_back(row.ms_median, error);
    }
  }
  return log_plot_text(plot);
}

}  // namespace thimble::tools
