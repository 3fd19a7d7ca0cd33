/// @file bodies.h
/// Bodies in the plane, as programs that simulate gravity between them exchange them.
///
/// Text: the number of bodies, the radius of the world, then a line each: `x y vx vy m r g b`, with the
/// colour in whole numbers of 0 .. 255. y goes up. Empty lines are passed over.
#ifndef THIMBLE_TOOLS_PARTICLES_BODIES_H
#define THIMBLE_TOOLS_PARTICLES_BODIES_H

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "thimble/picture/pixel.h"

namespace thimble::tools {

struct Body {
  double x = 0;
  double y = 0;
  double vx = 0;
  double vy = 0;
  double mass = 0;  ///< above 0
  Rgb8 color;
};

struct Bodies {
  double radius = 0;  ///< above 0; some bodies may lie beyond it
  std::vector<Body> bodies;
};

/// Throws InputError "line L, column C: ..." for anything else, also for numbers that are not finite, a mass
/// of 0 or less, and fewer or more lines than announced.
Bodies read_bodies(std::string_view text);

/// Throws InputError "line LINE, column COLUMN: SENTENCE", the column being where `word` begins in `line`.
[[noreturn]] void fail_at_word(std::uint64_t line_number, std::string_view line, std::string_view word,
                               const std::string& sentence);

}  // namespace thimble::tools

#endif
