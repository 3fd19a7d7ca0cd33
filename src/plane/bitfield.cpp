// The bit field: boxes and discs by word masks. src/plane/README.md says why the words lie as they do.
#include "thimble/plane/bitfield.h"

#include "../base/bits.h"

namespace thimble {

using field_detail::Word;

namespace {

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

// Calls `visit(word, mask)` for every word that the box (clipped) touches, down each column, until it returns
// false.
template <class Words, class Visit>
void for_each_word(Words* words, int32_t height, const CellBox& box, Visit visit) {
  if (box.low.y >= box.high.y) {
    return;
  }
  const int32_t first = box.low.x >> 5;
  const int32_t last = (box.high.x - 1) >> 5;
  for (int32_t column = first; column <= last; ++column) {
    const uint32_t low = column == first ? UINT32_MAX << (box.low.x & 31) : UINT32_MAX;
    const uint32_t mask = column == last ? low & UINT32_MAX >> (31 - ((box.high.x - 1) & 31)) : low;
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

}  // namespace thimble
