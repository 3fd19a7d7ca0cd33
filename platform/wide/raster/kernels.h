/// The loops that run over boxes and pixels. They are compiled for several instruction sets, of which the
/// program chooses one when it runs (Highway). Their sources stand in kernels/.
///
/// A box goes through three stages. First it is projected, up to sixteen boxes at a time, to the rectangle of pixels
/// that it might cover. A small rectangle becomes candidates: pairs of a box and a pixel, in a queue that is tested
/// when it is full. A large rectangle is tested row by row at once. Last, a hit is written into the picture where it
/// is nearer than what the picture holds.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "wide/kernel.h"
#include "wide/raster/frame.h"
#include "wide/raster/gray_scale.h"

namespace thimble::wide {

/// The nearest box of every pixel among those drawn so far.
///
/// A box's key is the Morton code of its lowest corner, mirrored in every axis along which the pixel's ray
/// runs downwards. Of two boxes of an octree that a ray hits, the one hit first has the smaller key: at the
/// node where their paths part, the ray passes the children in the order of their mirrored numbers. So
/// depths are compared exactly, as integers.
///
/// Where a pixel shows only a grey by depth or a face, of single voxels, it keeps that as a code
/// (GrayScale::Code) in place of the voxel's number; the code is found when the ray hits the voxel. In place of the key
/// it keeps the sum of the voxel's mirrored coordinates: from voxel to voxel a ray raises one or more of these and
/// lowers none. That takes 3 bytes a pixel instead of 8, and nothing is left to look up.
///
/// The picture is cut into strips of 32 columns, and each strip stands row by row: neighbours in the
/// picture are neighbours in memory.
struct Depths {
  uint64_t* nearest;  ///< per pixel: key << kEntryBits | entry; holds something only where `covered` says so
  const GrayScale* gray_scale;  ///< null: `nearest` is in use; else `nearest_sum` and `gray` are
  const Shading* shading;
  uint16_t* nearest_sum;  ///< of the voxel's mirrored coordinates; holds something only where `gray` does
  uint8_t* gray;          ///< the code; 0 where there is nothing: greys are at least kFarBrightness
  uint32_t* covered;      ///< a bit a pixel, a word a row of a strip, the leftmost pixel in the lowest bit;
                          ///< behind the last strip one more can be read
  bool marks;             ///< whether `covered` is in use; it is not where `gray` serves as well
  /// Where one thread draws few boxes: a byte for each piece of kPieceWords words of pixels says whether its codes
  /// were cleared. A piece is cleared when its first pixel is written, so most of a picture that holds little is
  /// never looked at. Null: all codes were cleared at first.
  uint8_t* is_touched;
  uint32_t* touched;  ///< how many pieces were cleared, then their numbers
  int32_t rows;       ///< rows of the picture, and words from a strip to the next
  int32_t first_row;  ///< the number of the first row that is held

  /// The index in `covered` of the word that holds the pixel, and the pixel's own in the other arrays.
  size_t word(int32_t x, int32_t y) const {
    return static_cast<size_t>(x >> 5) * static_cast<size_t>(rows) + static_cast<size_t>(y - first_row);
  }
  size_t pixel(int32_t x, int32_t y) const { return 32 * word(x, y) + (static_cast<uint32_t>(x) & 31U); }
};
inline constexpr int kPieceWords = 8;
inline constexpr int kEntryBits = 28;
inline constexpr int kKeyBits = 36;

struct Counts {
  uint64_t boxes = 0;       ///< projected
  uint64_t candidates = 0;  ///< pixels whose ray was tested against a box
  uint64_t exact = 0;       ///< candidates that floats could not decide
  uint64_t hits = 0;        ///< tests that were hits
  uint64_t nodes = 0;       ///< blocks looked at
  uint64_t crossing = 0;    ///< boxes in the eye's plane, tested pixel by pixel
  uint64_t asked = 0;       ///< pixels that the core decided (hidden_voxels.h)

  void add(const Counts& other) {
    boxes += other.boxes;
    candidates += other.candidates;
    exact += other.exact;
    hits += other.hits;
    nodes += other.nodes;
    crossing += other.crossing;
    asked += other.asked;
  }
};

/// Pairs of a box and a pixel. There is room to store a whole vector behind the last pair.
struct Pairs {
  static constexpr size_t kSize = 512;
  static constexpr size_t kRoom = kSize + 64;
  size_t count = 0;
  alignas(64) uint32_t entry[kRoom];
  alignas(64) uint32_t number[kRoom];
  alignas(64) uint32_t place[kRoom];  ///< y << 16 | x
};

/// Boxes that may be seen, and the pixels at which they may: x .. x + wide_x, y .. y + wide_y.
struct Boxes {
  static constexpr size_t kSize = 192;
  static constexpr size_t kRoom = kSize + 64;
  size_t count = 0;
  alignas(64) uint32_t entry[kRoom];
  alignas(64) uint32_t number[kRoom];
  alignas(64) uint32_t place[kRoom];  ///< y << 16 | x
  alignas(64) uint32_t wide[kRoom];   ///< wide_y << 16 | wide_x
};

/// Boxes of one voxel, and for each which of the four pixels that it might cover are open.
struct Picked {
  static constexpr size_t kSize = 256;
  static constexpr size_t kRoom = kSize + 64;
  size_t count = 0;
  alignas(64) uint32_t entry[kRoom];
  alignas(64) uint32_t number[kRoom];
  /// y << 16 | x of the first pixel, each modulo 2^14, since that pixel may lie beside the picture. The two bits
  /// above x tell which of the upper two pixels are open, the two above y which of the lower two.
  alignas(64) uint32_t place[kRoom];
};
inline constexpr int kPlaceBits = 14;

/// The map of a block of short entries to the picture, in fixed point modulo 2^16: a voxel's first pixel is at
///
///     a + a b 2^-16 + base,   a = e step[0] + (e >> 5) step[1] + (e >> 10) step[2] + last,   b = e bend[0] + ...
///
/// with e the entry; a is the distance from the block's middle in parts of a pixel, and there is b only in
/// perspective, while `base` is part of `last` otherwise.
struct ShortMap {
  struct Axis {
    int16_t step[3];
    int16_t last;
    int16_t base;
    int16_t least;  ///< a voxel covers its first pixel where the place's fraction is greater
    float middle;   ///< the block's, by the steps
    double below;   ///< how far a voxel reaches below the place of its middle, in pixels
  };
  Axis x, y;
  int16_t bend[3];
  int16_t bend_last;
  uint32_t kind = 0;  ///< the kind of blocks that the map is for: their side and place in the cube; 0: none
};

/// What one thread is working on, kept also from run to run. Less than 32 KiB.
struct Batch {
  Picked picked;  ///< not yet paired with their pixels; empty when `boxes` is not
  Boxes boxes;    ///< not yet paired with their pixels
  Pairs waiting;  ///< pairs that are to be tested in floats
  Pairs unclear;  ///< pairs that floats could not decide
  // Hits that are not yet written into the picture; `hits` of them.
  alignas(64) uint32_t key[Pairs::kRoom];     ///< the key within the cube, or the sum of mirrored coordinates
  alignas(64) uint32_t down[Pairs::kRoom];    ///< a bit for each axis along which the ray runs downwards
  alignas(64) uint32_t number[Pairs::kRoom];  ///< the entry's number, or its grey
  alignas(64) uint32_t pixel[Pairs::kRoom];   ///< the pixel's index in Depths::nearest
  // The cube that the pairs lie in.
  uint64_t cube_value[8];          ///< its corner's key, by `down`
  uint32_t corner[3] = {1, 1, 1};  ///< none yet
  float constant[3];               ///< of u, v and w, for corners within the cube
  size_t hits = 0;
  /// Entries that will be wanted soon, and their end: one cache line of them is fetched for each vector that is
  /// looked at.
  const uint32_t* ahead = nullptr;
  const uint32_t* ahead_end = nullptr;
  ShortMap short_map;
  Counts counts;
  /// Whether all of the picture lies in front of `boxes`, as their runs said (Run::behind).
  bool all_behind = true;
};
static_assert(sizeof(Batch) < 32 * 1024);

/// Where a block may be seen, and its centre.
struct Place {
  Rectangle where;  ///< within the tile
  float column, row;
  float per_depth;  ///< 1 / W.c of the centre (frame.h); 0 where the block reaches the eye's plane
  uint32_t unused;
};

/// A block of the tree: a node and where it may be seen.
///
/// It is written and copied as three vectors of 16 bytes: reading a vector right after its parts were written one by
/// one would wait until they are in the cache.
struct alignas(16) Block {
  Place place;
  uint32_t node;
  uint16_t corner[3];
  uint16_t level;
  uint32_t unused;
};
static_assert(sizeof(Block) == 48);

/// Entries and numbers are read by whole vectors, so up to so many behind the last may be read.
inline constexpr uint32_t kReadAhead = 64;

/// Short entries (voxel_lists.h) of a block of at most 32 voxels a side are drawn at once, or widened to entries.
inline constexpr uint32_t kMostShortEntries = 4096;
struct ShortEntries {
  const uint16_t* entries;  ///< kReadAhead more can be read
  uint32_t cube;            ///< the lowest corner of their cube of 32 a side, packed as an entry
};

/// A run of entries (voxel_lists.h) of the cube whose lowest corner is `corner` (in voxels).
struct Run {
  const uint32_t* entries;  ///< `count`, and kReadAhead more that can be read
  uint32_t count;
  const uint32_t* numbers;  ///< the entries' numbers; null: they count up from `first`
  uint32_t first;
  uint32_t corner[3];
  bool unit;  ///< whether all are one voxel
  /// The block that the entries fill: its lowest corner within the cube, and its side, in voxels.
  uint32_t block[3];
  uint32_t side;
  /// Where the block may be seen. The rectangle holds all pixels of the tile at which any of the boxes may be seen.
  Place place;
  /// Whether all that is in the picture lies in front of the run, so that its boxes are not tested at
  /// covered pixels.
  bool behind;
  /// Whether also each entry lies in front of those after it, wherever a ray hits both. Only with `numbers`.
  bool sorted;
};

/// Draws the boxes of a run. Some may wait in the batch until `finish`.
extern const Kernel<void(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch)>
    draw_run;
/// Draws a block of short entries, behind all that is in the picture; `run` has all but its entries. Returns false, with
/// nothing done, where voxels are too large on the picture or the block is too near, and where the instruction set has
/// no loop for it.
extern const Kernel<bool(const WideFrame& frame, const Run& run, const ShortEntries& from,
                         const Depths& depths, Batch* batch)>
    draw_short_run;
/// Writes short entries as entries of their cube of 1024 a side, and up to kReadAhead more.
extern const Kernel<void(const ShortEntries& from, uint32_t count, uint32_t* entries)> widen;
/// Draws the boxes that wait in the batch.
extern const Kernel<void(const WideFrame& frame, const Depths& depths, Batch* batch)> finish;

/// Finds which boxes of the run may be seen at open pixels. Stores their entries and numbers, in the order of the run,
/// in `entries` and `numbers`, which have room for run.count + kReadAhead. Returns how many boxes those are.
extern const Kernel<uint32_t(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch,
                             uint32_t* entries, uint32_t* numbers)>
    cull_run;

/// Finds which children of a block may be seen, among the octants in `mask`. Their nodes count up from `first_child`;
/// `nearest` is the octant nearest to the eye, which comes last. Returns how many may be seen. `children` has room for
/// eight.
extern const Kernel<int(const WideFrame& frame, const Block& block, unsigned mask, uint32_t first_child,
                        unsigned nearest, Block* children)>
    find_children;

/// Pixels and their nearest boxes. There is room for a whole vector behind the last pixel.
inline constexpr uint32_t kMostPixels = 512;
struct Pixels {
  uint32_t count = 0;
  bool any_levels = false;                       ///< whether `level` and `voxels` mean anything
  alignas(64) uint32_t at[kMostPixels + 64];     ///< the pixels' indices in Depths::nearest
  alignas(64) uint64_t value[kMostPixels + 64];  ///< what is there; `number`, `key` and `cube` are unpacked
                                                 ///< from it
  alignas(64) int32_t x[kMostPixels + 64];
  alignas(64) int32_t y[kMostPixels + 64];
  alignas(64) uint32_t number[kMostPixels + 64];  ///< the entry's number
  alignas(64) uint32_t key[kMostPixels + 64];     ///< key of the mirrored corner within its cube
  alignas(64) uint32_t cube[kMostPixels + 64];    ///< key of the cube's mirrored corner
  alignas(64) int32_t level[kMostPixels + 64];    ///< log2 of the boxes' sides
  alignas(64) int32_t voxels[kMostPixels + 64];   ///< 1: a voxel of the box is hit, 0: the box as a whole
};
/// Appends the covered pixels of the strip that begins at column `left`, row by row from `row` on: sets `at`, `x` and
/// `y`. Stops at row `end`, or when the next row might not fit. Returns the first row that is not appended.
extern const Kernel<int32_t(const Depths& depths, int32_t left, int32_t row, int32_t end, Pixels* pixels)>
    find_covered;
/// Reads the values of the pixels and unpacks them; fills the lanes behind the last pixel too.
extern const Kernel<void(const Depths& depths, Pixels* pixels)> unpack;
/// Finds the greys that shade() gives for ShadeMode::kDepth. `gray` has room for `count` greys and a vector behind
/// them.
extern const Kernel<void(const WideFrame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray)>
    find_grays;
/// How the codes that Depths keeps are stored as pixels of whole bytes.
struct CodeBytes {
  int size;         ///< bytes of a pixel: 1 .. 3
  bool is_gray;     ///< codes are greys; a channel takes 8 bits of one, or 5 or 6 where a pixel has two bytes
  bool high_first;  ///< where a grey pixel has two bytes: whether the one with the higher bits comes first
  /// For each byte of a pixel, the bytes of 16 codes; with `is_gray` only the background's, the first, is set.
  alignas(16) uint8_t of[3][16];
};
/// Stores row `y` in `to`, which has room for width_px pixels. Needs a picture of codes. Returns how many pixels show
/// something.
extern const Kernel<uint32_t(const Depths& depths, int32_t y, int32_t width_px, const CodeBytes& bytes,
                             uint8_t* to)>
    put_colors;
/// Does the same for the pieces of the whole picture that were touched (Depths::is_touched), not for what is between
/// them. `to` is the picture's first row.
extern const Kernel<uint32_t(const Depths& depths, int32_t width_px, const CodeBytes& bytes, uint8_t* to,
                             size_t stride)>
    put_touched;
/// Finds the faces that face_of() gives, as 2 * axis, and 1 more where the face looks towards larger coordinates.
/// `face` has room as in find_grays().
extern const Kernel<void(const WideFrame& frame, const Pixels& pixels, uint8_t* face)> find_faces;

/// Names the instruction set in use: the best one of this machine, unless a test chose another.
extern const Kernel<const char*()> instruction_set;
/// For tests, while nothing is drawn: counts the instruction sets that this machine and this build have, and uses the
/// one of that number from now on (the best one again where `number` is negative).
int instruction_set_count();
void use_instruction_set(int number);

}  // namespace thimble::wide
