/// @file knobs.h
/// The knobs that trade a picture's error for time: one table. Whoever adds a knob adds a line to it
/// (knobs.cpp) and what it turns to `Setting`.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_KNOBS_H
#define THIMBLE_TOOLS_INSTRUMENTS_KNOBS_H

#include <string>
#include <vector>

#include "scene/quality.h"

namespace thimble::tools {

/// Where every knob stands.
struct Setting {
  Quality quality;
  int direction_bits = 0;  ///< 0: automatic

  /// The options of `thimble render` that ask for it; empty for its defaults.
  std::string options() const;
};

struct Knob {
  const char* key;     ///< "cutoff"
  const char* option;  ///< of `thimble render`
  const char* unit;
  const char* help;
  /// What the study tries with the other knobs at their defaults, and together with those of the other knobs
  /// (its default among them), in a scene of `depth`.
  std::vector<double> (*alone)(int depth);
  std::vector<double> (*together)(int depth);
  void (*set)(Setting* setting, double value);
  /// Its value; 0 where it stands at its default.
  double (*get)(const Setting& setting);
};

const std::vector<Knob>& knobs();

/// Every knob at its best for a scene of `depth`, with at most `most_across`^2 samples a pixel.
Setting best_setting(int most_across);

/// A setting and why it is tried: the key of the knob that is turned alone, "default", "together", or "best":
/// the reference itself.
struct Trial {
  std::string group;
  Setting setting;
};
/// All that the study tries, each setting once, with at most `most_across`^2 samples.
std::vector<Trial> trials(int depth, int most_across);

}  // namespace thimble::tools

#endif
