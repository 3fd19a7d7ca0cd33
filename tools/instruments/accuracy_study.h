/// @file accuracy_study.h
/// One view of a scene at every setting of the knobs (knobs.h): what each costs, and how far its picture is
/// from the one with every knob at its best.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_ACCURACY_STUDY_H
#define THIMBLE_TOOLS_INSTRUMENTS_ACCURACY_STUDY_H

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "instruments/knobs.h"
#include "instruments/light_studio.h"
#include "scene/built_scene.h"
#include "scene/framing.h"
#include "scene/quality.h"

namespace thimble::tools {

/// A pixel is visibly wrong when a channel is off by more than this, of 255.
inline constexpr int kVisibleDifference = 8;

struct AccuracyRow {
  Trial trial;
  LightSetting light;  ///< of a lit picture
  // Against the reference.
  std::uint64_t wrong_px = 0;       ///< of another colour, by however little
  std::uint64_t visible_px = 0;     ///< with a channel off by more than kVisibleDifference
  std::uint64_t silhouette_px = 0;  ///< whose centre's ray hits in one and misses in the other
  /// Distances along the rays of pixels' centres that hit in both.
  double depth_mean_voxels = 0;
  double depth_max_voxels = 0;
  double psnr_db = 0;  ///< over all pixels and channels; infinite for equal pictures
  // One frame: median and quartiles, in milliseconds of the processor.
  double ms_median = 0;
  double ms_quarter = 0;
  double ms_three_quarters = 0;
  // The same on every machine.
  RenderCounts counts;
  double lm3s_instructions = 0;  ///< an estimate: chip_cost.h
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
                             const std::function<void(double)>& progress);

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

}  // namespace thimble::tools

#endif
