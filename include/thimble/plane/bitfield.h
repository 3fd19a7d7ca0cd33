/// @file bitfield.h
/// A picture of one bit a cell: what is solid in the plane. Discs are stamped into it, and what they would
/// touch is read from it, at a cost that does not depend on how many there are.
///
///     x to the right, y down the picture; cell (x, y) is [x, x+1) x [y, y+1)
///
///       x   0 ........ 31   32 ....... 63   64 ..
///     y 0 [ word 0       ][ word H       ][ word 2H
///       1 [ word 1       ][ word H + 1   ][ ..           bit x % 32 of a word, the lowest on the left
///       2 [ word 2       ][ word H + 2   ]
///
/// A row is whole 32-bit words, and the words of 32 columns lie one below the other in memory: a disc of up
/// to 16 cells is then up to 16 neighbouring words (one or two cache lines), or twice that where it lies
/// across two such columns. 800 x 600 takes 60,000 bytes. Bits beyond the right edge are always clear.
///
/// Outside the field there is nothing: reading gives clear, writing does nothing, so everything here is
/// clipped at the edges unless its name ends in `_inside`.
///
/// Costs are given in words read or written. Nothing here allocates, fails late or loops without a bound.
#ifndef THIMBLE_PLANE_BITFIELD_H
#define THIMBLE_PLANE_BITFIELD_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"

namespace thimble {

/// A field is at most this many cells wide and high (16384 x 16384 is 32 MiB).
inline constexpr int32_t kMaxFieldSide = int32_t{1} << 14;
/// Discs up to this diameter have a table of rows and the fast functions.
inline constexpr int32_t kMaxSmallDisc = 16;
/// Discs of up to this diameter can be stamped.
inline constexpr int32_t kMaxDisc = kMaxFieldSide;

/// Bytes of a field of `width` x `height` cells, each 0 .. kMaxFieldSide; 0 beyond that range.
constexpr size_t bitfield_bytes(int32_t width, int32_t height) {
  if (width < 0 || height < 0 || width > kMaxFieldSide || height > kMaxFieldSide) {
    return 0;
  }
  return static_cast<size_t>((width + 31) / 32) * static_cast<size_t>(height) * 4;
}

/// Two components in the plane.
template <class T>
struct Vec2 {
  T x{};
  T y{};

  constexpr T& operator[](int axis) { return axis == 0 ? x : y; }
  constexpr const T& operator[](int axis) const { return axis == 0 ? x : y; }
  friend constexpr bool operator==(const Vec2& a, const Vec2& b) { return a.x == b.x && a.y == b.y; }
  friend constexpr bool operator!=(const Vec2& a, const Vec2& b) { return !(a == b); }
};
using Vec2i = Vec2<int32_t>;

/// The cells [low, high) on both axes; empty when `low >= high` on either.
struct CellBox {
  Vec2i low;
  Vec2i high;
};

/// A disc as a set of cells. It is placed by its corner, the cell of least x and y of the square around it,
/// and its cells depend on the diameter alone, never on where it lies: the circle has its centre in the
/// middle of that square (in the middle of a cell for odd diameters, on a corner of cells for even ones), and
/// a cell belongs to it when the cell's centre lies in the circle. (No cell's centre ever lies on it: with
/// u = 2 * column + 1 - diameter and v likewise, u * u + v * v is never diameter * diameter.) So a disc is
/// the same under quarter turns and mirrors. Whoever has a centre c between cells puts the corner at the
/// integer nearest to c - diameter / 2; `disc_corner` does so for Q16.
///
///     diameter 1   2    3     4      5       6
///              #   ##   ###   .##.   .###.   .####.
///                  ##   ###   ####   #####   ######
///                       ###   ####   #####   ######  ...
///                             .##.   #####   ######
///                                    .###.   ######
///                                            .####.
struct DiscStamp {
  int32_t diameter = 0;
  /// rows[diameter], bit 0 on the left, with 16 empty rows before and after that may be read too; null for
  /// diameters above `kMaxSmallDisc`.
  const uint32_t* rows = nullptr;
};

namespace field_detail {

/// The rows of all discs up to kMaxSmallDisc, 16 empty rows before each and after the last.
struct SmallDiscs {
  static constexpr int32_t kGap = 16;
  static constexpr int32_t kRows = kGap * (kMaxSmallDisc + 2) + kMaxSmallDisc * (kMaxSmallDisc + 1) / 2;
  uint32_t rows[kRows] = {};

  static constexpr int32_t first(int32_t diameter) {
    return kGap * (diameter + 1) + diameter * (diameter - 1) / 2;
  }
  constexpr SmallDiscs() {
    for (int32_t d = 1; d <= kMaxSmallDisc; ++d) {
      for (int32_t y = 0; y < d; ++y) {
        for (int32_t x = 0; x < d; ++x) {
          const int32_t u = 2 * x + 1 - d;
          const int32_t v = 2 * y + 1 - d;
          if (u * u + v * v < d * d) {
            rows[first(d) + y] |= uint32_t{1} << x;
          }
        }
      }
    }
  }
};
inline constexpr SmallDiscs kSmallDiscs;

/// A word of the field in the caller's bytes, whatever type they were declared with.
typedef uint32_t __attribute__((may_alias)) Word;

/// Rows of a disc that are worked on together: four where there are registers of four words to put them into
/// (the compiler's own vectors, no header), else one.
#if defined(__SSE2__) || defined(__ARM_NEON)
inline constexpr int32_t kRowsAtOnce = 4;
typedef uint32_t __attribute__((vector_size(16), aligned(4), may_alias)) UnalignedBlock;
typedef uint32_t __attribute__((vector_size(16))) Block;
inline Block load(const Word* rows) {
  return *reinterpret_cast<const UnalignedBlock*>(rows);
}
inline void store(Word* rows, Block block) {
  *reinterpret_cast<UnalignedBlock*>(rows) = block;
}
inline bool any_of(Block block) {
  typedef uint64_t Halves __attribute__((vector_size(16)));
  const Halves halves = reinterpret_cast<Halves>(block);
  return (halves[0] | halves[1]) != 0;
}
#else
inline constexpr int32_t kRowsAtOnce = 1;
using Block = uint32_t;
inline Block load(const Word* rows) {
  return *rows;
}
inline void store(Word* rows, Block block) {
  *rows = block;
}
inline bool any_of(Block block) {
  return block != 0;
}
#endif

/// Calls `visit(row)` for the first row of every block of the first `count` rows: for each row, or for twelve or sixteen
/// in fours. Not inlined, it costs as much as what it does.
template <class Visit>
__attribute__((always_inline)) inline void for_rows(int32_t count, Visit visit) {
  if constexpr (kRowsAtOnce > 1) {
    visit(0);
    visit(4);
    visit(8);
    if (count > 12) {
      visit(12);
    }
  } else {
    for (int32_t row = 0; row < count; ++row) {
      visit(row);
    }
  }
}

/// Whether the squares around two discs of the same diameter share a cell.
constexpr bool same_size_discs_meet(int32_t diameter, const Vec2i& a, const Vec2i& b) {
  const uint32_t reach = static_cast<uint32_t>(diameter) - 1;
  return static_cast<uint32_t>(a.x) - static_cast<uint32_t>(b.x) + reach <= 2 * reach &&
         static_cast<uint32_t>(a.y) - static_cast<uint32_t>(b.y) + reach <= 2 * reach;
}

}  // namespace field_detail

/// The disc of `diameter`; below 1 it has no cells, above `kMaxDisc` it is that of kMaxDisc.
constexpr DiscStamp disc_stamp(int32_t diameter) {
  DiscStamp disc;
  disc.diameter = diameter < 0 ? 0 : diameter > kMaxDisc ? kMaxDisc : diameter;
  if (disc.diameter <= kMaxSmallDisc) {
    disc.rows = field_detail::kSmallDiscs.rows + field_detail::SmallDiscs::first(disc.diameter);
  }
  return disc;
}

/// The rows of a disc of at most kMaxSmallDisc (a larger one gets those of that), as `DiscStamp::rows`; never
/// null.
constexpr const uint32_t* small_disc_rows(int32_t diameter) {
  const int32_t least = diameter < 0 ? 0 : diameter;
  return field_detail::kSmallDiscs.rows +
         field_detail::SmallDiscs::first(least < kMaxSmallDisc ? least : kMaxSmallDisc);
}

/// The corner of a disc whose centre is at `centre_q16` on an axis: floor(centre - diameter / 2 + 1/2).
constexpr int32_t disc_corner(int32_t centre_q16, int32_t diameter) {
  return (centre_q16 - (diameter - 1) * 32768) >> 16;
}

/// A field over the caller's bytes, which outlive it. Copies share the bytes.
class BitField {
 public:
  /// A field of no cells.
  BitField() = default;

  /// Makes `field` an empty field in the first bitfield_bytes(width, height) of `bytes`, clearing them. A
  /// side of 0 is a field without cells. `kOutOfRange` for a side beyond 0 .. kMaxFieldSide, `kOutOfMemory`
  /// when `bytes` is too small, `kBadArgument` when its address is not a multiple of 4; `field` and `bytes`
  /// are then untouched.
  static Status make(int32_t width, int32_t height, Bytes bytes, BitField* field);
  /// The same in an arena, which gives just those bytes; after an error it is as it was.
  static Status make(int32_t width, int32_t height, Arena& arena, BitField* field) {
    return make_in(arena, bitfield_bytes(width, height), sizeof(uint32_t),
                   [&](Bytes bytes) { return make(width, height, bytes, field); });
  }

  int32_t width() const { return width_; }
  int32_t height() const { return height_; }
  size_t used_bytes() const { return bitfield_bytes(width_, height_); }
  /// Everything there is.
  CellBox bounds() const { return {{0, 0}, {width_, height_}}; }
  bool contains(Vec2i at) const {
    return static_cast<uint32_t>(at.x) < static_cast<uint32_t>(width_) &&
           static_cast<uint32_t>(at.y) < static_cast<uint32_t>(height_);
  }
  /// Columns of 32 cells.
  int32_t columns() const { return (width_ + 31) / 32; }
  /// Cells 32 * column .. + 31 of row y, the lowest bit on the left. The caller keeps column < columns() and
  /// y < height().
  uint32_t cells_32(int32_t column, int32_t y) const { return words_[column * height_ + y]; }
  /// Cells x .. x + 31 of row y, the lowest bit on the left; clear outside the field. Two words.
  uint32_t window(int32_t x, int32_t y) const;

  // --- One cell

  bool test(Vec2i at) const { return contains(at) && (cells_32(at.x >> 5, at.y) >> (at.x & 31) & 1U) != 0; }
  void set(Vec2i at) {
    if (contains(at)) {
      words_[(at.x >> 5) * height_ + at.y] |= uint32_t{1} << (at.x & 31);
    }
  }
  void clear(Vec2i at) {
    if (contains(at)) {
      words_[(at.x >> 5) * height_ + at.y] &= ~(uint32_t{1} << (at.x & 31));
    }
  }

  // --- Boxes of cells; a span is a box one cell high. Cost: the words that the box touches.

  void clear_all();
  void set(const CellBox& box);
  void clear(const CellBox& box);
  bool any(const CellBox& box) const;
  uint32_t count(const CellBox& box) const;
  /// All set cells.
  uint32_t count() const { return count(bounds()); }

  // --- Discs, clipped at the edges; `corner` may be anything. Cost: the words of each row, which are one or
  // two for diameters up to 32.

  void set(const DiscStamp& disc, Vec2i corner);
  void clear(const DiscStamp& disc, Vec2i corner);
  bool any(const DiscStamp& disc, Vec2i corner) const;

  // --- Discs of diameter 1 .. kMaxSmallDisc that lie in the field: the fast ones. The caller keeps to that
  // (`holds` tells); beyond it they read and write outside the bytes.

  /// Whether all of the square around the disc lies in the field.
  bool holds(const DiscStamp& disc, Vec2i corner) const {
    return corner.x >= 0 && corner.y >= 0 && corner.x <= width_ - disc.diameter &&
           corner.y <= height_ - disc.diameter;
  }
  void set_inside(const DiscStamp& disc, Vec2i corner);
  void clear_inside(const DiscStamp& disc, Vec2i corner);
  /// Whether a cell under the disc is set.
  bool any_inside(const DiscStamp& disc, Vec2i corner) const;
  /// Whether a cell under the disc is set that is not under the same disc at `own` (its corner; anywhere):
  /// may a disc that lies at `own` move to `corner`?
  bool any_besides_inside(const DiscStamp& disc, Vec2i corner, Vec2i own) const;
  /// Which cells those are: out[y] bit x for cell corner + (x, y); rows beyond the diameter are cleared.
  /// Returns whether there are any. With `own == kNowhere` it is all set cells under the disc.
  bool overlap_inside(const DiscStamp& disc, Vec2i corner, Vec2i own, uint32_t (&out)[kMaxSmallDisc]) const;
  /// An `own` that covers nothing.
  static constexpr Vec2i kNowhere{-(int32_t{1} << 20), -(int32_t{1} << 20)};

 private:
  // Where the words of a small disc lie.
  struct Rows {
    field_detail::Word* left;  // the first row, in the column of the disc's left edge
    const uint32_t* masks;     // for the same row
    int32_t shift;             // of the disc's left edge in its word
    bool two_words;            // it reaches into the next column
  };
  __attribute__((always_inline)) Rows rows_of(const DiscStamp& disc, Vec2i corner) const;

  field_detail::Word* words_ = nullptr;
  int32_t width_ = 0;
  int32_t height_ = 0;
};

// The fast functions. What costs time on a desktop is not the words but the branches, which discs of many
// sizes take at random: so there all discs of up to 12 rows are taken as 12 rows and the greater ones as 16,
// four rows to a register, with masks that are empty beyond the disc. Where the field ends below the disc
// these rows lie above it instead. Elsewhere a row is a turn of a loop.

inline BitField::Rows BitField::rows_of(const DiscStamp& disc, Vec2i corner) const {
  Rows rows;
  int32_t top = corner.y;
  if constexpr (field_detail::kRowsAtOnce > 1) {
    const int32_t lowest_top = height_ - (disc.diameter > 12 ? kMaxSmallDisc : 12);
    top = top < lowest_top ? top : lowest_top;
  }
  rows.left = words_ + (corner.x >> 5) * height_ + top;
  rows.masks = disc.rows - (corner.y - top);
  rows.shift = corner.x & 31;
  rows.two_words = rows.shift + disc.diameter > 32;
  return rows;
}

inline bool BitField::any_inside(const DiscStamp& disc, Vec2i corner) const {
  using namespace field_detail;
  if (height_ < kMaxSmallDisc) {
    return any(disc, corner);
  }
  const Rows rows = rows_of(disc, corner);
  Block found = {};
  for_rows(disc.diameter,
           [&](int32_t row) { found |= load(rows.left + row) >> rows.shift & load(rows.masks + row); });
  if (rows.two_words) {
    for_rows(disc.diameter, [&](int32_t row) {
      found |= load(rows.left + height_ + row) << (32 - rows.shift) & load(rows.masks + row);
    });
  }
  return any_of(found);
}

inline bool BitField::any_besides_inside(const DiscStamp& disc, Vec2i corner, Vec2i own) const {
  using namespace field_detail;
  if (!same_size_discs_meet(disc.diameter, corner, own)) {
    return any_inside(disc, corner);
  }
  if (height_ < kMaxSmallDisc) {
    uint32_t rows[kMaxSmallDisc];
    return overlap_inside(disc, corner, own, rows);
  }
  const Rows rows = rows_of(disc, corner);
  // The own disc's rows as they lie beside those of the new place.
  const uint32_t* own_masks = rows.masks + (corner.y - own.y);
  const int32_t to_left = own.x < corner.x ? corner.x - own.x : 0;
  const int32_t to_right = own.x > corner.x ? own.x - corner.x : 0;
  Block found = {};
  for_rows(disc.diameter, [&](int32_t row) {
    found |= load(rows.left + row) >> rows.shift & load(rows.masks + row) &
             ~(load(own_masks + row) >> to_left << to_right);
  });
  if (rows.two_words) {
    for_rows(disc.diameter, [&](int32_t row) {
      found |= load(rows.left + height_ + row) << (32 - rows.shift) & load(rows.masks + row) &
               ~(load(own_masks + row) >> to_left << to_right);
    });
  }
  return any_of(found);
}

inline void BitField::set_inside(const DiscStamp& disc, Vec2i corner) {
  using namespace field_detail;
  if (height_ < kMaxSmallDisc) {
    set(disc, corner);
    return;
  }
  const Rows rows = rows_of(disc, corner);
  for_rows(disc.diameter, [&](int32_t row) {
    store(rows.left + row, load(rows.left + row) | load(rows.masks + row) << rows.shift);
  });
  if (rows.two_words) {
    Word* right = rows.left + height_;
    for_rows(disc.diameter, [&](int32_t row) {
      store(right + row, load(right + row) | load(rows.masks + row) >> (32 - rows.shift));
    });
  }
}

inline void BitField::clear_inside(const DiscStamp& disc, Vec2i corner) {
  using namespace field_detail;
  if (height_ < kMaxSmallDisc) {
    clear(disc, corner);
    return;
  }
  const Rows rows = rows_of(disc, corner);
  for_rows(disc.diameter, [&](int32_t row) {
    store(rows.left + row, load(rows.left + row) & ~(load(rows.masks + row) << rows.shift));
  });
  if (rows.two_words) {
    Word* right = rows.left + height_;
    for_rows(disc.diameter, [&](int32_t row) {
      store(right + row, load(right + row) & ~(load(rows.masks + row) >> (32 - rows.shift)));
    });
  }
}

}  // namespace thimble

#endif
