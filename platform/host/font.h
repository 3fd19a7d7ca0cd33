/// A fixed font of 5 x 8 dots for ASCII, so that a window needs no font of its system.
#pragma once

#include <array>
#include <cstdint>

namespace thimble::host {

inline constexpr std::int32_t kGlyphColumns = 5;
inline constexpr std::int32_t kGlyphRows = 8;  ///< the lowest one is below the line

/// Rows from the top, the leftmost dot in bit 4.
using Glyph = std::array<std::uint8_t, kGlyphRows>;

/// A box for what is not printable ASCII.
const Glyph& glyph_of(char character);

}  // namespace thimble::host
