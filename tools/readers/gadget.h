/// @file gadget.h
/// Gadget-1 snapshots of N-body simulations (format 1), positions only.
///
/// The file is a chain of Fortran records, each between two copies of its length in bytes:
///
///     +-----+------------------+-----+   +-----+--------------------+-----+   +-----+--
///     | 256 | header, 256 bytes| 256 |   | len | POS: x y z, x y z..| len |   | len | VEL, ID, ...
///     +-----+------------------+-----+   +-----+--------------------+-----+   +-----+--
///
/// The header begins with the numbers of particles of six types, in which order their positions follow; they
/// are of float or of double, as the record's length tells. The byte order is the one in which the first
/// marker is 256. Records after the positions are not read, but their markers are held against the file's
/// size, so that a file that was cut off is noticed. Of a snapshot in several files this is one.
///
/// Colours tell the types apart: `kGadgetColors`. Format 2 (records with names) is refused by name.
///
/// Source of the format: Springel, "User guide for GADGET-2", section 6.
#ifndef THIMBLE_TOOLS_READERS_GADGET_H
#define THIMBLE_TOOLS_READERS_GADGET_H

#include <array>

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// The colour of each particle type.
inline constexpr std::array<Rgb, 6> kGadgetColors{{
    {64, 160, 255},   // 0 gas: blue
    {128, 96, 176},   // 1 halo (dark matter): violet
    {255, 208, 112},  // 2 disk: gold
    {255, 128, 64},   // 3 bulge: orange
    {255, 255, 240},  // 4 stars: white
    {96, 208, 128},   // 5 boundary: green
}};

/// True when the bytes begin with a record of 256 bytes in either byte order.
bool looks_like_gadget(std::span<const std::uint8_t> bytes);

/// Checks the whole file; the result keeps `file` and streams from it. `CloudPoint::line` is the particle's
/// number, from 1.
/// @throws InputError  naming the byte offset or the particle: no such snapshot, markers that disagree or
///   leave the file, positions that are not as many as the header's particles, a position that is not finite,
///   no particles
Source read_gadget(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
