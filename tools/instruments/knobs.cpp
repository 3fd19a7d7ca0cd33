#include "instruments/knobs.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "output/units.h"

namespace thimble::tools {
namespace {

// Depths less than the scene's own, by so many levels.
std::vector<double> shallower(int depth, int most) {
  std::vector<double> depths;
  for (int less = 1; less <= most && depth - less >= 1; ++less) {
    depths.push_back(depth - less);
  }
  return depths;
}

}  // namespace

const std::vector<Knob>& knobs() {
  static const std::vector<Knob> kKnobs{
      {"depth", "--max-depth", "levels", "levels of the tree that are looked at",
       [](int depth) { return shallower(depth, 4); },
       [](int depth) {
         std::vector<double> depths = shallower(depth, 2);
         depths.insert(depths.begin(), 0);
         return depths;
       },
       [](Setting* setting, double value) { setting->quality.max_depth = static_cast<int>(value); },
       [](const Setting& setting) { return static_cast<double>(setting.quality.max_depth); }},
      {"cutoff", "--cutoff", "pixels", "blocks that cover less of a pixel are not looked into",
       [](int) {
         return std::vector<double>{0.5, 1, 2, 4, 8};
       },
       [](int) {
         return std::vector<double>{0, 1, 2, 4};
       },
       [](Setting* setting, double value) {
         setting->quality.cutoff = Q16::from_raw(static_cast<std::int32_t>(std::lround(value * Q16::kOne)));
       },
       [](const Setting& setting) { return static_cast<double>(setting.quality.cutoff.raw) / Q16::kOne; }},
      {"direction_bits", "--direction-bits", "bits", "bits of a ray's direction",
       [](int) { return std::vector<double>{8, 9, 10, 12, 16, 20}; },
       [](int) {
         return std::vector<double>{0, 9};
       },
       [](Setting* setting, double value) { setting->direction_bits = static_cast<int>(value); },
       [](const Setting& setting) { return static_cast<double>(setting.direction_bits); }},
      {"samples", "--samples", "rays a pixel", "samples a pixel",
       [](int) {
         return std::vector<double>{4, 9, 16, 36, 64};
       },
       [](int) {
         return std::vector<double>{1, 4, 16};
       },
       [](Setting* setting, double value) {
         setting->quality.across = static_cast<int>(std::lround(std::sqrt(value)));
       },
       [](const Setting& setting) {
         return setting.quality.across == 1 ? 0.0 : static_cast<double>(setting.quality.samples());
       }},
  };
  return kKnobs;
}

std::string Setting::options() const {
  std::string text;
  for (const Knob& knob : knobs()) {
    if (const double value = knob.get(*this); value != 0) {
      text += (text.empty() ? "" : " ") + std::string(knob.option) + " " + shortest(value);
    }
  }
  return text;
}

Setting best_setting(int most_across) {
  Setting setting;
  setting.quality.across = most_across;
  setting.direction_bits = kMaxDirectionBits;
  return setting;
}

std::vector<Trial> trials(int depth, int most_across) {
  std::vector<Trial> result;
  std::set<std::string> known;
  const auto add = [&](const std::string& group, const Setting& setting) {
    if (setting.quality.across <= most_across && known.insert(setting.options()).second) {
      result.push_back({group, setting});
    }
  };
  add("default", {});
  for (const Knob& knob : knobs()) {
    for (const double value : knob.alone(depth)) {
      Setting setting;
      knob.set(&setting, value);
      add(knob.key, setting);
    }
  }
  // Every combination: each knob in turn multiplies the list.
  std::vector<Setting> together(1);
  for (const Knob& knob : knobs()) {
    std::vector<Setting> next;
    for (const Setting& setting : together) {
      for (const double value : knob.together(depth)) {
        next.push_back(setting);
        knob.set(&next.back(), value);
      }
    }
    together = std::move(next);
  }
  for (const Setting& setting : together) {
    add("together", setting);
  }
  add("best", best_setting(most_across));
  return result;
}

}  // namespace thimble::tools
