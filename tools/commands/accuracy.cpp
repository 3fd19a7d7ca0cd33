// thimble accuracy: what each knob that trades a picture's error for time gives, and what a given time or
// error calls for.
#include <cmath>

#include "commands/commands.h"
#include "instruments/accuracy_study.h"
#include "instruments/hard_cases.h"
#include "instruments/timed_frames.h"
#include "output/plot.h"
#include "particles/populated_world.h"
#include "thimble/light/water.h"

namespace thimble::tools {
namespace {

/// The worlds that are measured:
///
/// The paper's 693 balls on 800 x 600 cells (seed 1), after kParticleSteps steps, against 16
/// substeps and the finest positions. Short on purpose: after a collision two runs part for good, which says
/// nothing about either. Error: distance of the centres, cells; the median ball's counts, as the few that met
/// others differently would drown it.
///
/// A square basin of water that is pressed down by a voxel round a point, after the time in which a wave
/// crosses half of it, undamped, against kWaterReference columns a side in as many steps as the slowest waves
/// take. The basin, the bowl and the time are the same, whatever columns and steps. Error: heights against
/// the means of the reference's columns, voxels; their root mean square counts.
inline constexpr int kParticleSteps = 10;
inline constexpr int kWaterReference = 256;

struct SimulationRow : MedianTime {  ///< times: of all steps together
  int parts = 0;                     ///< substeps, or columns a side
  /// Bits of positions, or the speed of waves in 1/64 column a step: half of it takes twice the steps.
  int fineness = 0;
  int steps = 0;
  std::uint64_t work = 0;  ///< displacements made, or columns worked out
  double error_rms = 0;
  double error_median = 0;
  double error_most = 0;
  bool front = false;  ///< no other row is both as fast and as near to the reference
};

constexpr int kMostSubsteps = 16;
constexpr int kFinestBits = 15;

using Values = std::vector<std::array<double, 2>>;

/// What a run came to.
struct Outcome {
  Values values;  ///< centres of the balls, cells; or heights from the rest level, voxels, and 0
  std::uint64_t work = 0;
  double ms = 0;
};

Outcome run_particles(int substeps, int subpixel_bits) {
  WorldOptions options;
  options.subpixel_bits = subpixel_bits;
  options.substeps_log2 = 0;
  while ((1 << options.substeps_log2) < substeps) {
    ++options.substeps_log2;
  }
  PopulatedWorld populated(options, std::nullopt);
  ParticleWorld& world = populated.world();
  Outcome outcome;
  const FrameWatch watch;
  for (int step = 0; step < kParticleSteps; ++step) {
    world.step();
    outcome.work += world.counters().moves;
  }
  outcome.ms = watch.ms();
  for_each_ball(world, [&](const Particle& ball) {
    outcome.values.push_back({ball.x_q16 / 65536.0, ball.y_q16 / 65536.0});
  });
  return outcome;
}

constexpr std::int32_t kRestVoxels = 64;
constexpr std::int32_t kPressedQ8 = 256;

int water_steps(int columns, int wave_speed_q6) {
  return columns * 32 / wave_speed_q6;
}

Outcome run_water(int columns, int wave_speed_q6) {
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
  fail_if(Water::make(config, {bytes.data(), bytes.size()}, &water) != Status::kOk ||
              water.touch(side_q8 * 3 / 8, side_q8 * 7 / 16, side_q8 / 8, kPressedQ8) != Status::kOk,
          "internal error: the basin cannot be set up");
  Outcome basin;
  const FrameWatch watch;
  for (int step = 0; step < water_steps(columns, wave_speed_q6); ++step) {
    water.step();
  }
  basin.ms = watch.ms();
  basin.work = water.columns_updated();
  for (int y = 0; y < columns; ++y) {
    for (int x = 0; x < columns; ++x) {
      basin.values.push_back({water.height_q16(x, y) / 65536.0 - kRestVoxels, 0});
    }
  }
  return basin;
}

// The heights of the reference, as the means that so many columns a side stand for.
Values mean_heights(const Values& reference, int columns) {
  const int across = kWaterReference / columns;
  Values means;
  for (int y = 0; y < columns; ++y) {
    for (int x = 0; x < columns; ++x) {
      double sum = 0;
      for (int j = y * across; j < (y + 1) * across; ++j) {
        for (int i = x * across; i < (x + 1) * across; ++i) {
          const int at = j * kWaterReference + i;
          sum += reference[static_cast<std::size_t>(at)][0];
        }
      }
      means.push_back({sum / (across * across), 0});
    }
  }
  return means;
}

void set_errors(std::vector<double> errors, SimulationRow* row) {
  double squares = 0;
  for (const double error : errors) {
    squares += error * error;
    row->error_most = std::max(row->error_most, error);
  }
  row->error_rms = std::sqrt(squares / static_cast<double>(errors.size()));
  row->error_median = quantile(std::move(errors), 0.5);
}

std::vector<SimulationRow> settings_of(bool is_water) {
  const std::vector<int> finenesses = is_water
                                          ? std::vector{kMaxWaveSpeedQ6, kMaxWaveSpeedQ6 / 2, kMinWaveSpeedQ6}
                                          : std::vector{kFinestBits, 10, 8, 6};
  std::vector<SimulationRow> rows;
  for (const int fineness : finenesses) {
    const int most = is_water ? kWaterReference / 2 : kMostSubsteps;
    for (int parts = is_water ? 16 : 1; parts <= most; parts *= 2) {
      SimulationRow& row = rows.emplace_back();
      row.parts = parts;
      row.fineness = fineness;
      row.steps = is_water ? water_steps(parts, fineness) : kParticleSteps;
    }
  }
  return rows;
}

// The error that counts.
double counted_error(bool is_water, const SimulationRow& row) {
  return is_water ? row.error_rms : row.error_median;
}

/// Measures by turns, `rounds` times each.
std::vector<SimulationRow> study_simulation(bool is_water, int rounds, const Progress& progress) {
  std::vector<SimulationRow> rows = settings_of(is_water);
  const auto run = is_water ? run_water : run_particles;
  const Outcome finest = is_water ? run(kWaterReference, kMinWaveSpeedQ6) : run(kMostSubsteps, kFinestBits);
  std::vector<std::vector<double>> milliseconds(rows.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      SimulationRow& row = rows[i];
      const Outcome coarse = run(row.parts, row.fineness);
      milliseconds[i].push_back(coarse.ms);
      row.work = coarse.work;
      if (round == 0) {
        const Values expected = is_water ? mean_heights(finest.values, row.parts) : finest.values;
        std::vector<double> errors;
        for (std::size_t k = 0; k < expected.size(); ++k) {
          const auto& [x, y] = coarse.values[k];
          errors.push_back(std::hypot(x - expected[k][0], y - expected[k][1]));
        }
        set_errors(std::move(errors), &row);
      }
      progress((static_cast<double>(round) + static_cast<double>(i) / static_cast<double>(rows.size())) /
               rounds);
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].set_times(milliseconds[i]);
  }
  for (SimulationRow& row : rows) {
    const double error = counted_error(is_water, row);
    row.front = std::none_of(rows.begin(), rows.end(), [&](const SimulationRow& other) {
      const double others = counted_error(is_water, other);
      return other.ms_median <= row.ms_median && others <= error &&
             (other.ms_median < row.ms_median || others < error);
    });
  }
  return rows;
}

JsonRow simulation_objects(bool is_water, const std::vector<SimulationRow>& rows) {
  const auto only = [](bool is_there, int value) { return is_there ? JsonRow(value) : JsonRow(nullptr); };
  return objects_of(rows, [&](const SimulationRow& row) {
    JsonRow object;
    put_all(&object, "row", is_water ? "water" : "particles", "substeps", only(!is_water, row.parts),
            "subpixel_bits", only(!is_water, row.fineness), "columns", only(is_water, row.parts),
            "wave_speed_q6", only(is_water, row.fineness), "steps", row.steps, "work", row.work);
    row.add_to(&object);
    put_all(&object, "unit", is_water ? "voxels" : "cells", "error_rms", row.error_rms, "error_median",
            row.error_median, "error_most", row.error_most, "front", row.front ? 1 : 0);
    return object;
  });
}

std::string simulation_table(bool is_water, const std::vector<SimulationRow>& rows) {
  const Cells names =
      cells_of("", is_water ? "columns" : "substeps", is_water ? "wave speed" : "bits", "steps",
               is_water ? "columns updated" : "moves", "ms", "+-%", "error RMS", "median", "most");
  const auto cells = [&](const SimulationRow& row) {
    return cells_of(row.front ? "*" : "", row.parts,
                    is_water ? fixed(row.fineness / 64.0, 3) : std::to_string(row.fineness), row.steps,
                    grouped(row.work), fixed(row.ms_median, 3), row.spread(), fixed(row.error_rms, 4),
                    fixed(row.error_median, 4), fixed(row.error_most, 3));
  };
  const std::string head =
      is_water
          ? "a basin of water pressed down by a voxel, when a wave has crossed half of it: heights against\n"
            "those of 256 columns a side at a wave speed of 0.125, voxels; wave speed: columns a step\n"
          : "the paper's 693 balls after " + std::to_string(kParticleSteps) +
                " steps: distance of the centres from those with 16 substeps and\n"
                "positions of 2^-15 cells, cells; bits: positions are kept to 2^-bits cells\n";
  return head + "(*: no setting is both faster and nearer to the reference, by the " +
         (is_water ? "RMS" : "median") + ")\n" + table_of(names, 1, rows, cells);
}

std::string simulation_plot(bool is_water, const std::vector<SimulationRow>& rows) {
  Plot plot;
  plot.title = is_water ? "Water: error against time, 16 to 128 columns a side"
                        : "Particles: error against time, 1 to 16 substeps";
  plot.x_label = is_water
                     ? "processor time until a wave has crossed half the basin, ms (median, this machine)"
                     : "processor time of 10 steps of 693 balls, ms (median, this machine)";
  plot.y_label = is_water ? "RMS error of heights, voxels" : "median error of positions, cells (0 not shown)";
  for (const SimulationRow& row : rows) {
    const std::string name = is_water ? fixed(row.fineness / 64.0, 3) + " columns a step"
                                      : concat("positions of 2^-", row.fineness, " cells");
    if (plot.series.empty() || plot.series.back().name != name) {
      plot.series.push_back({name, false, {}});
    }
    if (const double error = counted_error(is_water, row); error > 0 && row.ms_median > 0) {
      plot.series.back().points.emplace_back(row.ms_median, error);
    }
  }
  return log_plot_text(plot);
}

// Of each operation, however few --rays there are.
constexpr std::uint64_t kLeastCases = 1000;

struct AccuracyCommand {
  SceneOptions scene;
  AccuracyOptions study;
  std::optional<bool> simulation;  ///< of water, else of particles
  bool hard_cases = false;
  std::uint64_t hard_rays = 1000000;
  std::uint64_t seed = 1;
  std::optional<double> for_ms;
  std::optional<double> for_error;
  ReportPaths files;
};

void run_scene(const AccuracyCommand& command) {
  ReportFiles files(command.files, command.scene.arguments.scene);
  const auto source = command.scene.open();
  BuiltScene built = command.scene.build(*source);
  const AccuracyStudy study = with_progress("measuring", command.scene.quiet, [&](const Progress& progress) {
    return study_accuracy(*source, &built, command.study, progress);
  });
  // Before anything is written: no answer is an error.
  const std::string answer = command.for_ms      ? answer_for_ms(study, *command.for_ms)
                             : command.for_error ? answer_for_error(study, *command.for_error)
                                                 : std::string();
  const std::string& scene = command.scene.arguments.scene;
  files.write(accuracy_objects(study),
              files.wants_plot() ? accuracy_plot(study, command.study.axis, scene) : "");
  print_notes(study.notes, command.scene.quiet);
  files.print(concat(printable(scene), "\n", command.study.view.width_px, "x", command.study.view.height_px,
                     ", median of ", counted(static_cast<std::uint64_t>(command.study.rounds), "frame"),
                     " each, by turns\n", accuracy_tables(study, command.study.axis), answer));
}

void run_hard(const AccuracyCommand& command) {
  ReportFiles files(command.files, command.scene.arguments.scene);
  const HardCaseStudy study = with_progress("tracing", command.scene.quiet, [&](const Progress& progress) {
    return HardCaseStudy{
        run_hard_cases(command.hard_rays, command.seed, [&](double done) { progress(0.8 * done); }),
        sweep_operations(std::max(command.hard_rays / 5, kLeastCases), command.seed,
                         [&](double done) { progress(0.8 + 0.2 * done); })};
  });
  files.write(hard_case_objects(study), "");
  files.print(hard_case_tables(study));
  if (const std::string fault = hard_case_fault(study); !fault.empty()) {
    throw InputError(fault);
  }
}

void run_simulation(const AccuracyCommand& command) {
  ReportFiles files(command.files, command.scene.arguments.scene);
  const auto rows = with_progress("measuring", command.scene.quiet, [&](const Progress& progress) {
    return study_simulation(*command.simulation, command.study.rounds, progress);
  });
  files.write(simulation_objects(*command.simulation, rows), simulation_plot(*command.simulation, rows));
  files.print(simulation_table(*command.simulation, rows));
}

// Options that say what is measured go with few of the others.
void check_alone(const CLI::App& sub, const std::string& what, const std::vector<std::string>& allowed) {
  for (const std::string& name : options_given(sub)) {
    refuse_if(name != what && std::find(allowed.begin(), allowed.end(), name) == allowed.end(), what,
              ": takes no ", (name == "scene" ? "SCENE" : name));
  }
}

void check(const AccuracyCommand& command, const CLI::App& sub) {
  for (const char* name : {"--rays", "--seed"}) {
    refuse_if(!command.hard_cases && is_given(sub, name), name, ": goes with --hard-cases only");
  }
  if (command.hard_cases) {
    check_alone(sub, "--hard-cases", {"--rays", "--seed", "--csv", "--json", "--quiet"});
  } else if (command.simulation) {
    check_alone(sub, "--simulation", {"--rounds", "--csv", "--json", "--plot", "--quiet"});
  } else {
    refuse_if(command.scene.arguments.scene.empty(), "SCENE is required");
  }
}

void run(const AccuracyCommand& command) {
  if (command.hard_cases) {
    run_hard(command);
  } else if (command.simulation) {
    run_simulation(command);
  } else {
    run_scene(command);
  }
}

void add_positive(CLI::App& app, const std::string& name, const std::string& type_name, double least,
                  std::optional<double>* value, const std::string& help) {
  add_text_option(
      app, name, type_name,
      [value, least](const std::string& text) -> std::string {
        const auto number = parse_real(text);
        if (!number || *number < least || *number > 1e9) {
          return least > 0 ? "is not a number above 0" : "is not a number from 0 on";
        }
        *value = number;
        return {};
      },
      help);
}

void add_report_of(AccuracyCommand* command, CLI::App& sub) {
  add_report(
      sub, &command->files, &command->scene.quiet,
      "a line a setting: row (setting; anytime: a frame of the defaults stopped early; light: a lit "
      "picture), group (default, the knob turned alone, together, best: the reference itself, anytime), "
      "options (of thimble render), front (1: nothing nearer to the reference is as cheap, times within 3 "
      "per cent being equal), max_depth (0: all), cutoff_px, direction_bits (0: automatic), samples; against "
      "the reference: wrong_px (of another colour), visible_px (a channel off by more than 8 of 255), "
      "rms_error (of 255), psnr_db (empty: equal); ms_median, ms_quarter, ms_three_quarters; rays, hits, "
      "node_visits; silhouette_px (centre's ray hits in one only), depth_error_mean_voxels, "
      "depth_error_max_voxels (of centres' rays that hit in both); lm3s6965evb_instructions (an estimate, "
      "off by 5 per cent on average on the demonstration); anytime: visits_given, inexact_px, "
      "error_bound_grays (of the mean absolute difference from the finished frame), mean_error_grays; light: "
      "occlusion_rays, roughness_rays, bounces (errors against the best of these). With --hard-cases: row "
      "(rays, operation), case (or all), level (of the world), tracer, traversal, arithmetic, "
      "epsilon_voxels, rays, hits, wrong (another voxel, a miss or a hit too many), wrong_face (of the "
      "others), operation, bound_name, unit, error (the largest), bound, cases. With --simulation: row "
      "(particles, water), substeps, subpixel_bits, columns (a side), wave_speed_q6 (columns a step), steps, "
      "work (displacements made, or columns worked out), ms_median, ms_quarter, ms_three_quarters (of all "
      "steps), unit (of the errors), error_rms, error_median, error_most, front",
      "PSNR against what --against says, the front marked and named");
}

}  // namespace

void add_accuracy(CLI::App& app) {
  CLI::App* sub = add_command(
      app, "accuracy",
      "Time against error: one view of a scene with every knob that trades them turned alone and together "
      "(depth, cut-off, bits of a ray's direction, samples a pixel), and frames stopped early, each compared "
      "with a reference that has all knobs at their best.");
  AccuracyCommand* const command = options_for<AccuracyCommand>(*sub, run);
  also_check(*sub, [command, sub] { check(*command, *sub); });
  command->study.view.width_px = 200;
  command->study.view.height_px = 150;
  command->scene.add_scene(*sub, false);
  add_flag(*sub, "--hard-cases", &command->hard_cases,
           "instead of a scene: near-degenerate rays through this tracer and through textbook traversals in "
           "floating point, and every fixed-point operation against exact arithmetic; the exit status is "
           "1 when this tracer gets one wrong");
  add_choice_option(
      *sub, "--simulation", {{"particles", false}, {"water", true}}, &command->simulation,
      "instead of a scene: substeps and bits of positions of the particle world, or columns and steps of a "
      "basin of water, against the finest");
  add_whole_option(*sub, "--rays", "N", 1, 1000000000, &command->hard_rays,
                   "--hard-cases: rays, shared among the cases; a fifth as many cases of each operation");
  add_whole_option(*sub, "--seed", "S", 0, INT64_MAX / 2000003, &command->seed,
                   "--hard-cases: of the random rays");
  add_positive(*sub, "--for-ms", "T", 1e-9, &command->for_ms,
               "answer with the options that come nearest to the reference in T milliseconds of the "
               "processor a frame, median on this machine at this --size");
  add_positive(*sub, "--for-error", "E", 0, &command->for_error,
               "answer with the fastest options whose picture is off by at most E: the root mean square of "
               "all channels' differences from the reference, in steps of 1/255 (column rms_error; 0: equal; "
               "PSNR is 20 log10(255/E) dB)");
  sub->get_option("--for-ms")->excludes(sub->get_option("--for-error"));
  add_whole_option(*sub, "--rounds", "N", 1, 999, &command->study.rounds,
                   "frames timed of each setting, by turns, one of each a round");
  add_choice_option(
      *sub, "--against",
      {{"time", CostAxis::kTime}, {"visits", CostAxis::kVisits}, {"instructions", CostAxis::kInstructions}},
      &command->study.axis,
      "what the front and the plot weigh errors against: milliseconds here, or what is the same on every "
      "machine: nodes visited, or an estimate of instructions on lm3s6965evb");
  add_view(*sub, &command->study.view, false);
  add_shade(
      *sub, &command->study.shade,
      "what is compared: brightness by distance, by the face's direction, palette colours, or hit or not");
  add_effect_list(
      *sub, &command->study.effects,
      "light whose knobs are turned too (rays of occlusion, rays of rough metal, bounces): auto (what the "
      "scene's materials and lights call for), none, or effects with commas between them: " +
          effect_names());
  add_report_of(command, *sub);
}

}  // namespace thimble::tools
