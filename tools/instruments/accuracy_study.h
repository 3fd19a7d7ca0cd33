/// One view of a scene at every setting of the knobs: what each costs, and how far its picture is
/// from the one with every knob at its best.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "instruments/timed_frames.h"
#include "output/progress.h"
#include "output/tables.h"
#include "scene/built_scene.h"
#include "scene/framing.h"
#include "scene/lit_description.h"
#include "scene/painter.h"
#include "scene/scene_source.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

// What a frame would cost on the flagship board, from what was counted here: an estimate, and how good it
// is.
//
// The figures are a least-squares fit (of relative errors) to instructions counted on an emulated
// lm3s6965evb (Cortex-M3, QEMU with -icount, gcc 12 -O2 as platform/firmware.cmake sets it): pictures of 128
// x 64 pixels of the demonstration (`thimble bake demo`, 72,295 voxels) from 36 cameras, at three distances
// and three fields of view, in bands of 8 rows of 16 greys, depth and normal shading; 72 pictures without a
// cut-off, 216 with one of 2, 4 and 8 pixels. The fit is off by 5 per cent on average and by 19 at most.
// Rays there take the 32-bit path; those of larger worlds or finer pictures do not, and cost about 1.3 times
// as much (`bench` on that board: 6,040 a ray in 64 bits, 4,587 in 32). Runs of pixels that miss all that is
// solid are cheap and in the average.

/// Instructions on a Cortex-M3.
struct ChipCost {
  double a_ray;
  double a_hit;  ///< shading and storing it included
  double a_visit;
};
inline constexpr ChipCost kChipCost{147, 1749, 222};
inline constexpr ChipCost kChipCostCut{152, 1486, 273};
/// Of `average_samples`: a pixel, and each of its samples.
inline constexpr double kChipCostPixel = 70;
inline constexpr double kChipCostSample = 10;

/// Instructions of a frame with those counts, of `samples` a pixel.
inline double chip_instructions(const RenderCounts& counts, bool cuts, int samples) {
  const ChipCost& cost = cuts ? kChipCostCut : kChipCost;
  const auto rays = static_cast<double>(counts.rays);
  const double averaging = samples == 1 ? 0 : rays * kChipCostSample + rays / samples * kChipCostPixel;
  return rays * cost.a_ray + static_cast<double>(counts.hits) * cost.a_hit +
         static_cast<double>(counts.node_visits) * cost.a_visit + averaging;
}

/// Where the knobs stand that trade a plain picture's error for time.
struct Setting {
  Quality quality;
  int direction_bits = 0;  ///< 0: automatic

  /// Those of the options --max-depth, --cutoff, --direction-bits and --samples; 0 where one stands at its default.
  std::array<double, 4> values() const;
  /// The options of `thimble render` that ask for it; empty for its defaults.
  std::string text() const;
};

/// Where the knobs of light stand. -1: the scene does not call for it.
struct LightSetting {
  int occlusion_rays = -1;  ///< a hit: 0, 4, 8, 16 or 32
  int roughness_rays = -1;  ///< a ray that meets rough metal: 4, or 1 as if it were polished
  int bounces = -1;         ///< 0 .. kMaxBounces
  friend bool operator==(const LightSetting&, const LightSetting&) = default;

  /// "occlusion rays 8, bounces 4".
  std::string text() const;
};

/// A pixel is visibly wrong when a channel is off by more than this, of 255.
inline constexpr int kVisibleDifference = 8;

struct AccuracyRow : DepthError, MedianTime {
  /// Why it is tried: the key of the knob that is turned alone, "default", "together", "best" (the reference itself)
  /// or "anytime".
  std::string group;
  Setting setting;
  LightSetting light;  ///< of a lit picture
  // Against the reference; distances are those of the rays of pixels' centres.
  std::uint64_t wrong_px = 0;    ///< of another colour, by however little
  std::uint64_t visible_px = 0;  ///< with a channel off by more than kVisibleDifference
  double psnr_db = 0;            ///< over all pixels and channels; infinite for equal pictures
  // The same on every machine.
  RenderCounts counts;
  double lm3s_instructions = 0;  ///< an estimate: `ChipCost`
  bool front = false;            ///< mark_front
};

/// A frame that was stopped after so much work (thimble/picture/anytime.h), with the knobs at their defaults.
struct WorkRow {
  std::uint64_t given_visits = 0;
  /// Pixels not yet exact, and how far the picture can then be from the finished one: the core's own bound.
  std::uint64_t inexact_px = 0;
  double error_bound_grays = 0;
  double mean_error_grays = 0;  ///< how far it is: mean absolute difference of greys from the finished one
  /// `picture`: errors against the study's reference (no depths), times and counts.
  AccuracyRow picture;
};

/// What an error is weighed against: the median time on this machine, node visits, or the estimate for the
/// board. The last two are the same on every machine.
enum class CostAxis : std::uint8_t { kTime, kVisits, kInstructions };
double cost_of(const AccuracyRow& row, CostAxis axis);

struct AccuracyOptions {
  ViewWishes view;
  ShadeMode shade = ShadeMode::kDepth;
  int rounds = 5;
  CostAxis axis = CostAxis::kTime;  ///< of the Pareto front
  EffectChoice effects;
};

struct AccuracyStudy {
  std::vector<AccuracyRow> rows;  ///< the settings as tried
  std::vector<WorkRow> work;      ///< more and more work; the last one is done
  /// Lit pictures with the knobs of light, against the one with these at their best (one sample a pixel); no
  /// depths, no instructions. Empty where the scene's effects have no knobs.
  std::vector<AccuracyRow> light;
  EffectSet effects = Effect::kNone;
  Setting reference;
  LightSetting light_reference;
  std::uint64_t pixels = 0;
  std::vector<std::string> notes;  ///< sentences for a person: what could not be tried
};

/// Tries and measures. Frames are drawn by turns, one of each setting a round, so that what else the machine
/// does falls on all alike. Throws InputError.
AccuracyStudy study_accuracy(const SceneSource& source, BuiltScene* built, const AccuracyOptions& options,
                             const Progress& progress);

/// Times this near to each other are taken for equal.
inline constexpr double kTimeNoise = 0.03;
/// Marks the rows of the Pareto front, psnr_db against that cost: those that are not dearer than an equal one
/// and to which no other one is nearer at a cost that is no higher (time: by no more than kTimeNoise).
void mark_front(std::vector<AccuracyRow>* rows, CostAxis axis);

/// The row with the highest psnr_db of those that take at most `ms`; null when none does.
const AccuracyRow* best_within(const std::vector<AccuracyRow>& rows, double ms);
/// The fastest row of those with at least `psnr_db`; null when none has.
const AccuracyRow* fastest_with(const std::vector<AccuracyRow>& rows, double psnr_db);

/// The root of the mean squared difference of the channels, in steps of 1/255, that a PSNR stands for; and
/// the other way. 0 is infinite decibels.
double rms_of(double psnr_db);
double psnr_of(double rms);

/// 10 log10(255^2 / mean squared difference) of two pictures of bytes, infinite when they are equal.
double psnr_db(const std::vector<std::uint8_t>& picture, const std::vector<std::uint8_t>& reference);

// What `thimble accuracy SCENE` found, for people, for machines and as a plot.

/// An object a row, all with the same names: the settings, then the frames stopped early.
JsonRow accuracy_objects(const AccuracyStudy& study);

/// Tables of at most 100 columns: of settings tried together only those on the front.
std::string accuracy_tables(const AccuracyStudy& study, CostAxis axis);

/// Error against cost, the front marked and named.
std::string accuracy_plot(const AccuracyStudy& study, CostAxis axis, const std::string& scene);

/// What --for-ms and --for-error answer: a line "options: ..." and what they give, or an InputError that says
/// what is the nearest that can be had.
std::string answer_for_ms(const AccuracyStudy& study, double ms);
std::string answer_for_error(const AccuracyStudy& study, double rms);

}  // namespace thimble::tools
