/// @file color_scale.h
/// What the numbers of colours mean where a format does not say: decided over all of a file, so that a dark corner
/// does not pass for another scale.
#ifndef THIMBLE_TOOLS_READERS_COLOR_SCALE_H
#define THIMBLE_TOOLS_READERS_COLOR_SCALE_H

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "readers/mesh.h"
#include "readers/source.h"

namespace thimble::tools {

/// The components of a file's colours, seen one by one.
class ColorScale {
 public:
  void see(double component) {
    is_valid_ = is_valid_ && component >= 0 && component <= 65535;
    is_whole_ = is_whole_ && component == std::floor(component);
    highest_ = std::max(highest_, component);
  }
  /// Nothing was below 0, above 65,535 or no number.
  bool is_valid() const { return is_valid_; }
  /// What may be a colour where no name says so: 0 to 1, or whole numbers up to 255.
  bool looks_like_colors() const { return is_valid_ && (highest_ <= 1 || (is_whole_ && highest_ <= 255)); }
  /// 1 where no component is above 1, else 255, else 65,535.
  double full() const { return highest_ <= 1 ? 1 : (highest_ <= 255 ? 255 : 65535); }

  Rgb color(double red, double green, double blue) const {
    return {unit_to_byte(red / full()), unit_to_byte(green / full()), unit_to_byte(blue / full())};
  }

 private:
  bool is_valid_ = true;
  bool is_whole_ = true;
  double highest_ = 0;
};

}  // namespace thimble::tools

#endif
