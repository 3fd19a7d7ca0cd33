// The bit field against a picture of one char a cell.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/ray_cases.h"
#include "thimble/plane/bitfield.h"

namespace {

using namespace thimble;
using tests::pick;
using tests::pick_int;

const int kScale = thimble::tests::many_or_few(10, 1);

std::string at(const Vec2i& cell) {
  return "(" + std::to_string(cell.x) + ", " + std::to_string(cell.y) + ")";
}

// The judge: no words, no masks.
struct Picture {
  int width;
  int height;
  std::vector<char> cells;

  Picture(int w, int h)
      : width(w), height(h), cells(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0) {}

  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  char& cell(int x, int y) { return cells[index(x, y)]; }
  bool test(int x, int y) const { return contains(x, y) && cells[index(x, y)] != 0; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  void put(int x, int y, bool value) {
    if (contains(x, y)) {
      cell(x, y) = value ? 1 : 0;
    }
  }
};

// A set of cells to do something with, in reading order.
using Cells = std::vector<Vec2i>;

// The disc by its definition, in real numbers.
bool in_disc(int diameter, int column, int row) {
  const double u = column + 0.5 - diameter / 2.0;
  const double v = row + 0.5 - diameter / 2.0;
  return std::sqrt(u * u + v * v) < diameter / 2.0;
}
Cells cells_of_disc(int diameter, const Vec2i& corner) {
  Cells cells;
  for (int row = 0; row < diameter; ++row) {
    for (int column = 0; column < diameter; ++column) {
      if (in_disc(diameter, column, row)) {
        cells.push_back({corner.x + column, corner.y + row});
      }
    }
  }
  return cells;
}

// A field and the picture that it should show, in a block of exactly as many bytes between two guards.
class Both {
 public:
  Both(int width, int height)
      : picture(width, height),
        words_(bitfield_bytes(width, height) / 4 + 2, kGuard),
        bytes_(reinterpret_cast<std::uint8_t*>(words_.data() + 1), bitfield_bytes(width, height)) {
    REQUIRE(BitField::make(width, height, bytes_, &field) == Status::kOk);
  }
  Both(const Both&) = delete;
  Both& operator=(const Both&) = delete;

  void put(const Cells& cells, bool value) {
    for (const Vec2i& cell : cells) {
      picture.put(cell.x, cell.y, value);
    }
  }
  // Random cells, about `one_in` apart.
  void sprinkle(std::mt19937_64& random, int one_in) {
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        if (pick(random, 1, one_in) == 1) {
          picture.cell(x, y) = 1;
          field.set(Vec2i{x, y});
        }
      }
    }
  }
  // Empty when both are the same, no bit is set beyond the right edge, and the guards stand.
  std::string difference() const {
    for (int y = 0; y < picture.height; ++y) {
      for (int column = 0; column < field.columns(); ++column) {
        for (int bit = 0; bit < 32; ++bit) {
          const int x = 32 * column + bit;
          const bool set = (field.cells_32(column, y) >> bit & 1) != 0;
          if (set != picture.test(x, y)) {
            return "cell " + at({x, y}) + (set ? " is set" : " is clear");
          }
        }
      }
    }
    return words_.front() == kGuard && words_.back() == kGuard ? "" : "written outside the bytes";
  }
  std::uint32_t count(const Cells& cells) const {
    return static_cast<std::uint32_t>(std::count_if(
        cells.begin(), cells.end(), [this](const Vec2i& cell) { return picture.test(cell.x, cell.y); }));
  }

  Picture picture;
  BitField field;

 private:
  static constexpr std::uint32_t kGuard = 0xA5C3F00D;
  std::vector<std::uint32_t> words_;
  Bytes bytes_;
};

}  // namespace

// --- Making a field

TEST_CASE("init: sides beyond the limits and odd addresses -> refused") {
  alignas(4) std::array<std::uint8_t, 64> bytes;
  BitField field;
  CHECK(BitField::make(-1, 4, bytes.data() == nullptr ? Bytes{} : Bytes{bytes.data(), 64}, &field) ==
        Status::kOutOfRange);
  CHECK(BitField::make(4, -1, {bytes.data(), 64}, &field) == Status::kOutOfRange);
  CHECK(BitField::make(kMaxFieldSide + 1, 0, {bytes.data(), 64}, &field) == Status::kOutOfRange);
  CHECK(BitField::make(0, kMaxFieldSide + 1, {bytes.data(), 64}, &field) == Status::kOutOfRange);
  for (std::size_t odd = 1; odd < 4; ++odd) {
    CHECK(BitField::make(4, 4, {bytes.data() + odd, 60}, &field) == Status::kBadArgument);
  }
  CHECK(field.width() == 0);
}

// --- Discs

TEST_CASE("disc_corner: a centre between cells -> the nearest place, and the middle of a place stays") {
  for (int diameter = 1; diameter <= 20; ++diameter) {
    for (int corner = -3; corner <= 3; ++corner) {
      const int middle_q16 = corner * 65536 + diameter * 32768;
      CHECK(disc_corner(middle_q16, diameter) == corner);
      CHECK(disc_corner(middle_q16 + 32767, diameter) == corner);
      CHECK(disc_corner(middle_q16 + 32768, diameter) == corner + 1);
      CHECK(disc_corner(middle_q16 - 32768, diameter) == corner);
      CHECK(disc_corner(middle_q16 - 32769, diameter) == corner - 1);
    }
  }
}

TEST_CASE("small discs inside: every diameter, place and own place -> as a picture of chars") {
  const std::uint64_t seed = 20260403;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  for (const auto& size : {std::pair{70, 16}, {65, 17}, {33, 19}, {64, 21}, {40, 9}, {3, 30}, {16, 16}}) {
    const int width = size.first;
    const int height = size.second;
    CAPTURE(width);
    CAPTURE(height);
    for (int diameter = 1; diameter <= kMaxSmallDisc; ++diameter) {
      CAPTURE(diameter);
      const DiscStamp disc = disc_stamp(diameter);
      if (!Both(width, height).field.holds(disc, {0, 0})) {
        continue;
      }
      Both both(width, height);
      both.sprinkle(random, diameter * diameter);
      for (int y = -1; y <= height - diameter + 1; ++y) {
        for (int x = -1; x <= width - diameter + 1; ++x) {
          const Vec2i corner{x, y};
          const bool inside = x >= 0 && y >= 0 && x + diameter <= width && y + diameter <= height;
          REQUIRE(both.field.holds(disc, corner) == inside);
          if (!inside || (kScale == 1 && (x + y + diameter) % 5 != 0)) {
            continue;
          }
          CAPTURE(at(corner));
          const Cells cells = cells_of_disc(diameter, corner);
          REQUIRE(both.field.any_inside(disc, corner) == (both.count(cells) != 0));

          const int reach = pick(random, 0, 1) == 0 ? 2 : diameter + 1;
          const Vec2i own = pick(random, 0, 20) == 0 ? BitField::kNowhere
                                                     : Vec2i{x + pick_int(random, -reach, reach),
                                                             y + pick_int(random, -reach, reach)};
          CAPTURE(at(own));
          std::array<std::uint32_t, 16> expected{};
          bool any = false;
          for (const Vec2i& cell : cells) {
            const int u = cell.x - own.x;
            const int v = cell.y - own.y;
            const bool is_own = u >= 0 && v >= 0 && u < diameter && v < diameter && in_disc(diameter, u, v);
            if (both.picture.test(cell.x, cell.y) && !is_own) {
              expected[static_cast<std::size_t>(cell.y - y)] |= 1U << (cell.x - x);
              any = true;
            }
          }
          REQUIRE(both.field.any_besides_inside(disc, corner, own) == any);
          std::uint32_t rows[kMaxSmallDisc];
          std::fill(std::begin(rows), std::end(rows), 0xDEADU);
          REQUIRE(both.field.overlap_inside(disc, corner, own, rows) == any);
          REQUIRE(std::equal(std::begin(rows), std::end(rows), expected.begin()));
        }
      }
      for (int turn = 0; turn < 20 * kScale; ++turn) {
        const Vec2i corner{pick_int(random, 0, width - diameter), pick_int(random, 0, height - diameter)};
        const bool value = pick(random, 0, 1) == 0;
        both.put(cells_of_disc(diameter, corner), value);
        if (value) {
          both.field.set_inside(disc, corner);
        } else {
          both.field.clear_inside(disc, corner);
        }
        REQUIRE(both.difference() == "");
      }
    }
  }
}
