/// What the numbers of colours mean where a format does not say: decided over all of a file, so that a dark corner
/// does not pass for another scale.
#pragma once

#include "readers/formats.h"
#include "readers/mesh.h"

namespace thimble::tools {

/// The components of a file's colours, seen one by one.
class ColorScale {
 public:
  explicit ColorScale(const ReadOptions& options) : stated_(options.full_color) {}
  void see(double component) {
    is_valid_ = is_valid_ && component >= 0 && component <= 65535;
    is_whole_ = is_whole_ && component == std::floor(component);
    highest_ = std::max(highest_, component);
  }
  /// Sees a colour, and what is kept of it until all are seen: within what bytes have, unless something else was stated.
  std::array<float, 3> keep(std::span<const double> components) {
    std::array<float, 3> kept{};
    for (std::size_t i = 0; i < 3; ++i) {
      kept[i] = static_cast<float>(std::fmax(0, std::fmin(components[i], stated_ != 0 ? stated_ : 255)));
      see(static_cast<double>(kept[i]));
    }
    return kept;
  }
  /// Nothing was below 0, above 65,535 or no number.
  bool is_valid() const { return is_valid_; }
  /// What may be a colour where no name says so: 0 to 1, or whole numbers up to 255.
  bool looks_like_colors() const {
    return is_valid_ && (stated_ != 0 || highest_ <= 1 || (is_whole_ && highest_ <= 255));
  }
  /// What was stated; else 1 where no component is above 1, else 255, else 65,535.
  double full() const { return stated_ != 0 ? stated_ : highest_ <= 1 ? 1 : highest_ <= 255 ? 255 : 65535; }
  /// Says what they are taken for where they could be something else.
  void add_note(Notes& notes) const {
    note_if(!is_valid_, notes,
            "colors below 0, above 65535 or that are no numbers are taken for what is next to them");
    const bool is_small = highest_ > 0 && highest_ <= 2 && (is_whole_ || highest_ > 1);
    note_if(stated_ == 0 && is_valid_ && (highest_ > 255 || is_small), notes, "no color is above ",
            static_cast<int>(std::ceil(std::min(highest_, 65535.0))), ": full is taken to be ",
            static_cast<int>(full()), " (--colors says otherwise)");
  }

  Rgb color(double red, double green, double blue) const {
    return {unit_to_byte(red / full()), unit_to_byte(green / full()), unit_to_byte(blue / full())};
  }
  /// What was kept as colours; white where it is below 0.
  std::vector<Rgb> colors(const std::vector<std::array<float, 3>>& kept) const {
    std::vector<Rgb> colors;
    colors.reserve(kept.size());
    for (const auto& [red, green, blue] : kept) {
      colors.push_back(
          red < 0 ? Rgb{}
                  : color(static_cast<double>(red), static_cast<double>(green), static_cast<double>(blue)));
    }
    return colors;
  }

 private:
  double stated_;
  bool is_valid_ = true;
  bool is_whole_ = true;
  double highest_ = 0;
};

}  // namespace thimble::tools
