// The bit field: boxes and discs by word masks, rays row by row, normals by filling the outside.
// src/plane/README.md says why the words lie as they do and derives the bounds of the rays.
#include "thimble/plane/bitfield.h"

#include "../base/bits.h"

namespace thimble {

using field_detail::Word;

namespace {

// Cells from .. 31 of a word, and cells 0 .. to - 1 (to 1 .. 32).
constexpr uint32_t mask_from(int32_t from) {
  return UINT32_MAX << from;
}
constexpr uint32_t mask_to(int32_t to) {
  return UINT32_MAX >> (32 - to);
}

// `box` without what lies outside a field of that size; empty boxes come out with no rows.
CellBox clipped(const CellBox& box, int32_t width, int32_t height) {
  CellBox result = box;
  result.low.x = box.low.x < 0 ? 0 : box.low.x;
  result.low.y = box.low.y < 0 ? 0 : box.low.y;
  result.high.x = box.high.x > width ? width : box.high.x;
  result.high.y = box.high.y > height ? height : box.high.y;
  if (result.low.x >= result.high.x || result.low.y >= result.high.y) {
    return {};
  }
  return result;
}

// The columns of 32 cells that a box (clipped) touches, and which cells of each.
class Columns {
 public:
  explicit Columns(const CellBox& box)
      : first_(box.low.x >> 5), last_((box.high.x - 1) >> 5), min_x_(box.low.x), max_x_(box.high.x) {}

  int32_t first() const { return first_; }
  int32_t last() const { return last_; }
  uint32_t mask(int32_t column) const {
    const uint32_t low = column == first_ ? mask_from(min_x_ & 31) : UINT32_MAX;
    return column == last_ ? low & mask_to(((max_x_ - 1) & 31) + 1) : low;
  }

 private:
  int32_t first_;
  int32_t last_;
  int32_t min_x_;
  int32_t max_x_;
};

// Calls `visit(word, mask)` for every word that the box (clipped) touches, down each column, until it returns
// false.
template <class Words, class Visit>
void for_each_word(Words* words, int32_t height, const CellBox& box, Visit visit) {
  if (box.low.y >= box.high.y) {
    return;
  }
  const Columns columns(box);
  for (int32_t column = columns.first(); column <= columns.last(); ++column) {
    const uint32_t mask = columns.mask(column);
    Words* down = words + column * height;
    for (int32_t y = box.low.y; y < box.high.y; ++y) {
      if (!visit(down[y], mask)) {
        return;
      }
    }
  }
}

// Calls `visit(span)` for every row of the disc that lies in a field of that height, from the top, until it
// returns false. The left end of the rows moves outwards and back in, a cell at a time.
template <class Visit>
void for_each_row(const DiscStamp& disc, const Vec2i& corner, int32_t width, int32_t height, Visit visit) {
  const int32_t d = disc.diameter;
  if (d < 1 || corner.x >= width || corner.y >= height || corner.x <= -d || corner.y <= -d) {
    return;
  }
  int32_t left = d / 2;
  for (int32_t row = 0; row < d; ++row) {
    const int32_t v = 2 * row + 1 - d;
    // u * u + v * v stays below 2 * kMaxDisc * kMaxDisc = 2^29. A row always has its middle cell.
    const auto inside = [&](int32_t column) {
      const int32_t u = 2 * column + 1 - d;
      return u * u + v * v < d * d;
    };
    while (left > 0 && inside(left - 1)) {
      --left;
    }
    while (!inside(left)) {
      ++left;
    }
    const int32_t y = corner.y + row;
    if (y < 0) {
      continue;
    }
    if (y >= height || !visit(CellBox{{corner.x + left, y}, {corner.x + d - left, y + 1}})) {
      return;
    }
  }
}

}  // namespace

uint32_t disc_cells(const DiscStamp& disc) {
  uint32_t cells = 0;
  for_each_row(disc, {0, 0}, kMaxDisc, kMaxDisc, [&cells](const CellBox& span) {
    cells += static_cast<uint32_t>(span.high.x - span.low.x);
    return true;
  });
  return cells;
}

Status BitField::make(int32_t width, int32_t height, Bytes bytes, BitField* field) {
  if (width < 0 || height < 0 || width > kMaxFieldSide || height > kMaxFieldSide) {
    return Status::kOutOfRange;
  }
  if (bitfield_bytes(width, height) > bytes.size) {
    return Status::kOutOfMemory;
  }
  if ((reinterpret_cast<size_t>(bytes.data) & 3U) != 0) {
    return Status::kBadArgument;
  }
  // Through void: the address was looked at.
  field->words_ = static_cast<Word*>(static_cast<void*>(bytes.data));
  field->width_ = width;
  field->height_ = height;
  field->clear_all();
  return Status::kOk;
}

uint32_t BitField::window(int32_t x, int32_t y) const {
  if (y < 0 || y >= height_) {
    return 0;
  }
  const int32_t column = x >> 5;
  const uint32_t shift = static_cast<uint32_t>(x) & 31U;
  const uint32_t left = column >= 0 && column < columns() ? cells_32(column, y) : 0;
  if (shift == 0) {
    return left;
  }
  const uint32_t right = column >= -1 && column < columns() - 1 ? cells_32(column + 1, y) : 0;
  return left >> shift | right << (32 - shift);
}

void BitField::clear_all() {
  const int32_t words = columns() * height_;
  for (int32_t i = 0; i < words; ++i) {
    words_[i] = 0;
  }
}

void BitField::set(const CellBox& box) {
  for_each_word(words_, height_, clipped(box, width_, height_), [](Word& word, uint32_t mask) {
    word |= mask;
    return true;
  });
}

void BitField::clear(const CellBox& box) {
  for_each_word(words_, height_, clipped(box, width_, height_), [](Word& word, uint32_t mask) {
    word &= ~mask;
    return true;
  });
}

bool BitField::any(const CellBox& box) const {
  bool found = false;
  for_each_word(words_, height_, clipped(box, width_, height_), [&found](uint32_t word, uint32_t mask) {
    found = (word & mask) != 0;
    return !found;
  });
  return found;
}

uint32_t BitField::count(const CellBox& box) const {
  uint32_t cells = 0;
  for_each_word(words_, height_, clipped(box, width_, height_), [&cells](uint32_t word, uint32_t mask) {
    cells += bits::popcount32(word & mask);
    return true;
  });
  return cells;
}

bool BitField::first(const CellBox& box, Vec2i* at) const {
  const CellBox inside = clipped(box, width_, height_);
  const Columns columns(inside);
  for (int32_t y = inside.low.y; y < inside.high.y; ++y) {
    for (int32_t column = columns.first(); column <= columns.last(); ++column) {
      const uint32_t found = cells_32(column, y) & columns.mask(column);
      if (found != 0) {
        *at = {32 * column + static_cast<int32_t>(bits::lowest_bit(found)), y};
        return true;
      }
    }
  }
  return false;
}

bool BitField::first_from_right(const CellBox& box, Vec2i* at) const {
  const CellBox inside = clipped(box, width_, height_);
  const Columns columns(inside);
  for (int32_t y = inside.low.y; y < inside.high.y; ++y) {
    for (int32_t column = columns.last(); column >= columns.first(); --column) {
      const uint32_t found = cells_32(column, y) & columns.mask(column);
      if (found != 0) {
        *at = {32 * column + bits::highest_bit(found), y};
        return true;
      }
    }
  }
  return false;
}

void BitField::set(const DiscStamp& disc, Vec2i corner) {
  for_each_row(disc, corner, width_, height_, [this](const CellBox& span) {
    set(span);
    return true;
  });
}

void BitField::clear(const DiscStamp& disc, Vec2i corner) {
  for_each_row(disc, corner, width_, height_, [this](const CellBox& span) {
    clear(span);
    return true;
  });
}

bool BitField::any(const DiscStamp& disc, Vec2i corner) const {
  bool found = false;
  for_each_row(disc, corner, width_, height_, [this, &found](const CellBox& span) {
    found = any(span);
    return !found;
  });
  return found;
}

uint32_t BitField::count(const DiscStamp& disc, Vec2i corner) const {
  uint32_t cells = 0;
  for_each_row(disc, corner, width_, height_, [this, &cells](const CellBox& span) {
    cells += count(span);
    return true;
  });
  return cells;
}

bool BitField::first(const DiscStamp& disc, Vec2i corner, Vec2i* at) const {
  bool found = false;
  for_each_row(disc, corner, width_, height_, [this, &found, at](const CellBox& span) {
    found = first(span, at);
    return !found;
  });
  return found;
}

bool BitField::overlap_inside(const DiscStamp& disc, Vec2i corner, Vec2i own,
                              uint32_t (&out)[kMaxSmallDisc]) const {
  const bool meet = field_detail::same_size_discs_meet(disc.diameter, corner, own);
  const int32_t down = meet ? corner.y - own.y : 0;
  const int32_t to_left = meet && own.x < corner.x ? corner.x - own.x : 0;
  const int32_t to_right = meet && own.x > corner.x ? own.x - corner.x : 0;
  const int32_t shift = corner.x & 31;
  const bool two_words = shift + disc.diameter > 32;
  const Word* left = words_ + (corner.x >> 5) * height_ + corner.y;
  uint32_t any = 0;
  for (int32_t row = 0; row < kMaxSmallDisc; ++row) {
    uint32_t found = 0;
    if (row < disc.diameter) {
      const uint32_t own_row = meet ? (disc.rows[row + down] >> to_left) << to_right : 0;
      found = left[row] >> shift;
      if (two_words) {
        found |= left[height_ + row] << (32 - shift);
      }
      found &= disc.rows[row] & ~own_row;
    }
    out[row] = found;
    any |= found;
  }
  return any != 0;
}

// --- Rays
//
// The ray is mirrored so that no component is negative (cell i becomes side - 1 - i), which leaves one case.
// In a row of cells it then spends a positive length in those from where it enters the row to where it leaves
// it, a span that is looked through a word at a time. Where it crosses the rows' planes is known exactly, as
// a cell and a remainder that grow by the same amounts from row to row.

namespace {

// Where a ray crosses a plane: in `cell` of the other axis, `rest` beyond the cell's start in units of
// 1 / (256 * direction across) cell.
struct Crossing {
  int32_t cell;
  uint32_t rest;  // below 256 * direction across < 2^28
};

// A cell number so great that it lies beyond every field, whatever is added on the way through a row.
constexpr int32_t kBeyond = int32_t{1} << 28;

// Where a ray that starts at `origin_q8` of an axis and moves `along` on it while it moves `across` on the
// other is, after `distance_q8` across. With along = whole * across + part it is
//   origin + whole * distance + part * distance / across,
// and the last term is divided bit by bit of the distance, with a remainder below 2^20.
Crossing crossing(int32_t origin_q8, uint32_t along, uint32_t across, uint32_t distance_q8) {
  const uint32_t whole = along / across;
  const uint32_t part = along % across;
  uint32_t quotient = 0;
  uint32_t rest = 0;
  for (int bit = 23; bit >= 0; --bit) {
    rest = 2 * rest + ((distance_q8 >> bit & 1U) != 0 ? part : 0);  // below 3 * across
    quotient *= 2;
    for (int turn = 0; turn < 2 && rest >= across; ++turn) {
      rest -= across;
      ++quotient;
    }
  }
  const int64_t position_q8 = int64_t{origin_q8} + static_cast<int64_t>(whole) * int64_t{distance_q8} +
                              static_cast<int64_t>(quotient);
  if (position_q8 >= int64_t{kBeyond}) {
    return {kBeyond, 0};
  }
  const int32_t near_q8 = static_cast<int32_t>(position_q8);  // at least the origin
  return {near_q8 >> 8, (static_cast<uint32_t>(near_q8) & 255U) * across + rest};
}

// A ray whose directions are not negative, in a field whose cells are numbered to suit.
struct MirroredFieldRay {
  Vec2i origin_q8;
  Vec2i direction;
  bool flip[2];

  MirroredFieldRay(const FieldRay& ray, int32_t width, int32_t height) {
    for (int axis = 0; axis < 2; ++axis) {
      flip[axis] = ray.direction[axis] < 0;
      const int32_t side_q8 = (axis == 0 ? width : height) * Q8::kOne;
      direction[axis] = flip[axis] ? -ray.direction[axis] : ray.direction[axis];
      origin_q8[axis] = flip[axis] ? side_q8 - ray.origin[axis].raw : ray.origin[axis].raw;
    }
  }
  // From the origin to the lower plane of cell `number`.
  int32_t distance(int axis, int32_t number) const { return number * Q8::kOne - origin_q8[axis]; }
  // Where it crosses the lower plane of cell `number` of `axis`, which lies ahead; it moves along that axis.
  Crossing at_plane(int axis, int32_t number) const {
    return crossing(origin_q8[1 - axis], static_cast<uint32_t>(direction[1 - axis]),
                    static_cast<uint32_t>(direction[axis]), static_cast<uint32_t>(distance(axis, number)));
  }
};

// How the ray came into a cell. `axis` -1: it starts there.
struct Entry {
  Vec2i cell;
  int axis;
  bool corner;
};

// The first cell of the field that the ray spends a positive length in; false when there is none.
bool enter_field(const MirroredFieldRay& ray, int32_t width, int32_t height, Entry* entry) {
  *entry = {{ray.origin_q8.x >> 8, ray.origin_q8.y >> 8}, -1, false};
  for (int axis = 0; axis < 2; ++axis) {
    const int32_t side = axis == 0 ? width : height;
    if (entry->cell[axis] >= side || (entry->cell[axis] < 0 && ray.direction[axis] == 0)) {
      return false;
    }
  }
  if (entry->cell.y < 0) {
    const Crossing top = ray.at_plane(1, 0);
    if (top.cell >= width) {
      return false;
    }
    if (top.cell >= 0) {
      const bool corner = top.rest == 0 && ray.direction.x != 0;
      *entry = {{top.cell, 0}, corner ? 0 : 1, corner};
      return true;
    }
  }
  // Above or beside the field and, where it comes level with it, still to the left of it.
  if (entry->cell.x < 0) {
    const Crossing side = ray.at_plane(0, 0);
    if (side.cell >= height) {
      return false;
    }
    *entry = {{0, side.cell}, 0, side.rest == 0 && ray.direction.y != 0};
  }
  return true;
}

}  // namespace

Status BitField::first_hit(const FieldRay& ray, FieldHit* hit, uint32_t max_visits) const {
  const Status status = check_field_ray(ray);
  if (status != Status::kOk) {
    return status;
  }
  *hit = FieldHit{};
  if (width_ == 0 || height_ == 0) {
    return Status::kOk;
  }
  const MirroredFieldRay mirrored(ray, width_, height_);
  const Vec2i direction = mirrored.direction;
  Entry entry;
  if (!enter_field(mirrored, width_, height_, &entry)) {
    return Status::kOk;
  }

  // What the crossing moves on by from row to row.
  const uint32_t unit = static_cast<uint32_t>(direction.y) * 256U;
  int32_t row_cells = 0;
  uint32_t row_rest = 0;
  Crossing leave{kBeyond, 0};
  if (direction.y != 0) {
    row_cells = direction.x / direction.y;
    row_rest = static_cast<uint32_t>(direction.x % direction.y) * 256U;
    leave = mirrored.at_plane(1, entry.cell.y + 1);
  }
  uint32_t visits = 0;
  while (true) {  // a row a turn
    // It leaves the row at a plane between two cells only after the first of them.
    const bool leaves_by_corner = leave.rest == 0 && direction.x != 0;
    const int32_t end = leave.cell + (leaves_by_corner ? 0 : 1);
    const int32_t first = entry.cell.x;
    const int32_t last = (end < width_ ? end : width_) - 1;
    const int32_t y = mirrored.flip[1] ? height_ - 1 - entry.cell.y : entry.cell.y;
    const int32_t from = mirrored.flip[0] ? width_ - 1 - first : first;
    const int32_t to = mirrored.flip[0] ? width_ - 1 - last : last;
    const int32_t step = mirrored.flip[0] ? -1 : 1;
    for (int32_t column = from >> 5;; column += step) {
      if (visits == max_visits) {
        hit->kind = FieldHitKind::kStepLimit;
        hit->visits = visits;
        return Status::kOk;
      }
      ++visits;
      uint32_t found = cells_32(column, y);
      if (column == from >> 5) {
        found &= step > 0 ? mask_from(from & 31) : mask_to((from & 31) + 1);
      }
      if (column == to >> 5) {
        found &= step > 0 ? mask_to((to & 31) + 1) : mask_from(to & 31);
      }
      if (found != 0) {
        const int32_t x = 32 * column + (step > 0 ? static_cast<int32_t>(bits::lowest_bit(found))
                                                  : bits::highest_bit(found));
        if (x != from) {
          entry.cell.x = mirrored.flip[0] ? width_ - 1 - x : x;
          entry.axis = 0;
          entry.corner = false;
        }
        hit->kind = FieldHitKind::kHit;
        hit->axis = static_cast<int8_t>(entry.axis);
        hit->corner = entry.corner;
        hit->cell = {x, y};
        hit->visits = visits;
        if (entry.axis >= 0) {
          hit->t_numerator = mirrored.distance(entry.axis, entry.cell[entry.axis]);
          hit->t_denominator = direction[entry.axis] * Q8::kOne;
        }
        return Status::kOk;
      }
      if (column == to >> 5) {
        break;
      }
    }
    // Into the next row.
    entry.cell.x = leave.cell;
    ++entry.cell.y;
    if (entry.cell.x >= width_ || entry.cell.y >= height_) {
      break;
    }
    entry.axis = leaves_by_corner ? 0 : 1;
    entry.corner = leaves_by_corner;
    leave.cell += row_cells;
    leave.rest += row_rest;
    if (leave.rest >= unit) {
      leave.rest -= unit;
      ++leave.cell;
    }
  }
  hit->visits = visits;
  return Status::kOk;
}

// --- Normals

Vec2i BitField::normal(const FieldRay& ray, const FieldHit& hit) const {
  if (hit.axis < 0) {
    return {-ray.direction.x, -ray.direction.y};
  }
  // Against the ray, through the edge or corner entered: where it came from.
  Vec2i back;
  for (int axis = 0; axis < 2; ++axis) {
    if (hit.corner || hit.axis == axis) {
      back[axis] = ray.direction[axis] > 0 ? -1 : 1;
    }
  }
  // The empty cells of the disc around the cell hit, and those of them that are known to be outside.
  constexpr int32_t kRadius = kNormalRadius;
  constexpr int32_t kSide = 2 * kRadius + 1;
  static_assert(kSide <= kMaxSmallDisc);
  const DiscStamp disc = disc_stamp(kSide);
  uint32_t empty[kSide];
  uint32_t outside[kSide + 2] = {};  // with an empty row above and below
  for (int32_t row = 0; row < kSide; ++row) {
    empty[row] = disc.rows[row] & ~window(hit.cell.x - kRadius, hit.cell.y - kRadius + row);
  }
  outside[kRadius + back.y + 1] = (uint32_t{1} << (kRadius + back.x)) & empty[kRadius + back.y];
  // Spreads along the rows, and from row to row down and up, until nothing changes. Every turn but the last
  // adds a cell, so there are at most kSide * kSide of them; usually it is two or three.
  for (int32_t turn = 0; turn < kSide * kSide; ++turn) {
    uint32_t change = 0;
    for (int32_t i = 0; i < 2 * kSide; ++i) {
      const int32_t row = i < kSide ? i : 2 * kSide - 1 - i;
      const uint32_t room = empty[row];
      uint32_t reached = (outside[row] | outside[row + 1] | outside[row + 2]) & room;
      uint32_t right = room;
      uint32_t left = room;
      for (int32_t shift = 1; shift < kSide; shift *= 2) {
        reached |= ((reached << shift) & right) | ((reached >> shift) & left);
        right &= right << shift;
        left &= left >> shift;
      }
      change |= reached ^ outside[row + 1];
      outside[row + 1] = reached;
    }
    if (change == 0) {
      break;
    }
  }
  Vec2i sum;
  for (int32_t row = 0; row < kSide; ++row) {
    const uint32_t cells = outside[row + 1];
    const int32_t count = static_cast<int32_t>(bits::popcount32(cells));
    sum.y += count * (row - kRadius);
    sum.x -= count * kRadius;
    // The sum of the cells' numbers, bit by bit of the number: 16 cells have numbers of 4 bits.
    sum.x +=
        static_cast<int32_t>(bits::popcount32(cells & 0xAAAAU) + 2 * bits::popcount32(cells & 0xCCCCU) +
                             4 * bits::popcount32(cells & 0xF0F0U) + 8 * bits::popcount32(cells & 0xFF00U));
  }
  return sum == Vec2i{} ? back : sum;
}

}  // namespace thimble
