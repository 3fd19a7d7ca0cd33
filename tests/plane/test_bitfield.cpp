// The bit field against a picture of one char a cell, and its rays against the judges of the voxels: a field
// is a world one voxel deep, and a ray in the plane one that keeps to the middle of it.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "reference/reference.h"
#include "support/counts.h"
#include "support/ray_cases.h"
#include "thimble/plane/bitfield.h"

namespace {

using namespace thimble;
using tests::pick;

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

Cells cells_of(const CellBox& box) {
  Cells cells;
  for (int y = box.low.y; y < box.high.y; ++y) {
    for (int x = box.low.x; x < box.high.x; ++x) {
      cells.push_back({x, y});
    }
  }
  return cells;
}
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
  // The first of `cells` that is set, or nowhere.
  Vec2i first(const Cells& cells) const {
    const auto found = std::find_if(cells.begin(), cells.end(),
                                    [this](const Vec2i& cell) { return picture.test(cell.x, cell.y); });
    return found == cells.end() ? BitField::kNowhere : *found;
  }

  Picture picture;
  BitField field;

 private:
  static constexpr std::uint32_t kGuard = 0xA5C3F00D;
  std::vector<std::uint32_t> words_;
  Bytes bytes_;
};

// What the field says is first, or nowhere; a failed query leaves its argument alone.
template <class Shape>
Vec2i first_of(const BitField& field, const Shape& shape) {
  Vec2i found = BitField::kNowhere;
  const bool any = field.first(shape, &found);
  CHECK(any == (found != BitField::kNowhere));
  return found;
}
Vec2i first_of(const BitField& field, const DiscStamp& disc, const Vec2i& corner) {
  Vec2i found = BitField::kNowhere;
  const bool any = field.first(disc, corner, &found);
  CHECK(any == (found != BitField::kNowhere));
  return found;
}

// --- Rays

reference::Ray to_reference(const FieldRay& ray) {
  return {{ray.origin.x.raw, ray.origin.y.raw, 128}, {ray.direction.x, ray.direction.y, 0}};
}
FieldRay to_field(const reference::Ray& ray) {
  return {{Q8::from_raw(static_cast<std::int32_t>(ray.origin_q8[0])),
           Q8::from_raw(static_cast<std::int32_t>(ray.origin_q8[1]))},
          {static_cast<std::int32_t>(ray.direction[0]), static_cast<std::int32_t>(ray.direction[1])}};
}
reference::Hit to_reference(const FieldHit& hit, int shift_x = 0, int shift_y = 0) {
  if (hit.kind != FieldHitKind::kHit) {
    return {};
  }
  return {
      true, {hit.cell.x - shift_x, hit.cell.y - shift_y, 0}, hit.t_numerator, hit.t_denominator, hit.axis};
}
FieldRay ray_q8(int x, int y, int dx, int dy) {
  return {{Q8::from_raw(x), Q8::from_raw(y)}, {dx, dy}};
}

reference::BitGrid grid_of(const Picture& picture) {
  reference::BitGrid grid({picture.width, picture.height, 1});
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (picture.test(x, y)) {
        grid.set({x, y, 0});
      }
    }
  }
  return grid;
}

// Whether the hit came through a corner: worked out from t, which says where the other axis is.
bool through_corner(const FieldRay& ray, const FieldHit& hit) {
  if (hit.axis != 0 || ray.direction.y == 0 || hit.t_numerator == 0) {
    return false;
  }
  // y * 256 * |dx| = oy * |dx| + dy * num: on a plane when 256 * |dx| divides it.
  const std::int64_t dx = std::abs(ray.direction.x);
  const std::int64_t y = ray.origin.y.raw * dx + std::int64_t{ray.direction.y} * hit.t_numerator;
  return y % (256 * dx) == 0;
}

// Traces a ray and compares; returns a sentence when something is wrong. All limits below the visits stop it.
std::string wrong(const BitField& field, const FieldRay& ray, const reference::Hit& expected) {
  FieldHit hit;
  if (field.first_hit(ray, &hit) != Status::kOk) {
    return "refused";
  }
  const std::string name = reference::describe(to_reference(ray)) + ": ";
  if (!reference::same_answer(to_reference(hit), expected)) {
    return name + "got " + reference::describe(to_reference(hit)) + ", expected " +
           reference::describe(expected);
  }
  if (hit.kind == FieldHitKind::kHit && hit.corner != through_corner(ray, hit)) {
    return name + "corner is wrong";
  }
  if (hit.visits > static_cast<std::uint32_t>(2 * field.height() + field.columns())) {
    return name + std::to_string(hit.visits) + " visits";
  }
  const std::uint32_t limit = hit.visits / 2;
  FieldHit stopped;
  if (field.first_hit(ray, &stopped, limit) != Status::kOk || stopped.visits != limit ||
      stopped.kind != (hit.visits == 0 ? FieldHitKind::kMiss : FieldHitKind::kStepLimit)) {
    return name + "the step limit of " + std::to_string(limit) + " does not stop it";
  }
  FieldHit again;
  if (field.first_hit(ray, &again, hit.visits) != Status::kOk || again.kind != hit.kind) {
    return name + "its own visits are not enough";
  }
  return "";
}

}  // namespace

// --- Making a field

TEST_CASE("bitfield_bytes: rows of whole words -> 60,000 bytes for the paper's world; 0 beyond the range") {
  static_assert(bitfield_bytes(800, 600) == 60000);
  static_assert(bitfield_bytes(128, 64) == 1024);
  static_assert(bitfield_bytes(1, 1) == 4);
  static_assert(bitfield_bytes(33, 2) == 16);
  static_assert(bitfield_bytes(0, 600) == 0);
  static_assert(bitfield_bytes(800, 0) == 0);
  static_assert(bitfield_bytes(-1, 5) == 0);
  static_assert(bitfield_bytes(5, kMaxFieldSide + 1) == 0);
  CHECK(bitfield_bytes(kMaxFieldSide, kMaxFieldSide) == std::size_t{32} << 20);
}

TEST_CASE("init: every byte count that is too small -> out of memory, nothing touched") {
  for (const auto& [width, height] : {std::pair{40, 13}, {32, 16}, {1, 1}, {100, 3}}) {
    const std::size_t needed = bitfield_bytes(width, height);
    alignas(4) std::array<std::uint8_t, 256> bytes;
    REQUIRE(needed < bytes.size());
    for (std::size_t size = 0; size < needed; ++size) {
      bytes.fill(0x5A);
      BitField field;
      CHECK(BitField::make(width, height, {bytes.data(), size}, &field) == Status::kOutOfMemory);
      CHECK(field.width() == 0);
      CHECK(std::count(bytes.begin(), bytes.end(), 0x5A) == 256);
    }
    bytes.fill(0x5A);
    BitField field;
    CHECK(BitField::make(width, height, {bytes.data(), needed}, &field) == Status::kOk);
    CHECK(field.used_bytes() == needed);
    CHECK(field.count() == 0);
    CHECK(static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), 0)) == needed);
    CHECK(bytes[needed] == 0x5A);
  }
}

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

TEST_CASE("a field without cells: everything is called -> nothing is there, nothing breaks") {
  for (const auto& [width, height] : {std::pair{0, 0}, {0, 5}, {5, 0}}) {
    BitField field;
    REQUIRE(BitField::make(width, height, {}, &field) == Status::kOk);
    CHECK(field.used_bytes() == 0);
    const DiscStamp disc = disc_stamp(5);
    field.set(Vec2i{0, 0});
    field.clear(Vec2i{0, 0});
    field.set(CellBox{{-9, -9}, {9, 9}});
    field.clear(CellBox{{-9, -9}, {9, 9}});
    field.set(disc, {-2, -2});
    field.clear(disc, {-2, -2});
    field.clear_all();
    Vec2i found;
    CHECK(!field.test({0, 0}));
    CHECK(!field.any(CellBox{{-9, -9}, {9, 9}}));
    CHECK(!field.first(CellBox{{-9, -9}, {9, 9}}, &found));
    CHECK(!field.first_from_right(CellBox{{-9, -9}, {9, 9}}, &found));
    CHECK(!field.any(disc, {-2, -2}));
    CHECK(field.count() == 0);
    CHECK(field.count(disc, {-2, -2}) == 0);
    CHECK(field.window(0, 0) == 0);
    CHECK(!field.holds(disc, {0, 0}));
    FieldHit hit;
    for (const FieldRay& ray :
         {ray_q8(-300, 100, 1, 0), ray_q8(0, 0, 1, 1), ray_q8(100, -300, 0, 1), ray_q8(0, 0, -1, -1)}) {
      CHECK(field.first_hit(ray, &hit) == Status::kOk);
      CHECK(hit.kind == FieldHitKind::kMiss);
      CHECK(hit.visits == 0);
    }
  }
}

// --- Cells and boxes

TEST_CASE(
    "boxes: random sets, clears and questions, at, over and beyond the edges -> as a picture of chars") {
  const std::uint64_t seed = 20260401;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  for (const auto& [width, height] :
       {std::pair{1, 1}, {31, 7}, {32, 8}, {33, 9}, {64, 3}, {65, 20}, {100, 40}, {3, 70}}) {
    Both both(width, height);
    for (int turn = 0; turn < 60 * kScale; ++turn) {
      const auto edge = [&random](int side) { return static_cast<int>(pick(random, -5, side + 5)); };
      CellBox box{{edge(width), edge(height)}, {edge(width), edge(height)}};
      if (turn % 3 == 0) {
        box.high.y = box.low.y + 1;  // a span
      }
      const Cells cells = cells_of(box);
      const bool value = pick(random, 0, 2) == 0;
      both.put(cells, value);
      if (value) {
        both.field.set(box);
      } else {
        both.field.clear(box);
      }
      const Vec2i single{edge(width), edge(height)};
      both.picture.put(single.x, single.y, !value);
      if (value) {
        both.field.clear(single);
      } else {
        both.field.set(single);
      }
      REQUIRE(both.difference() == "");
      CHECK(both.field.test(single) == both.picture.test(single.x, single.y));

      const CellBox asked{{edge(width), edge(height)}, {edge(width), edge(height)}};
      const Cells asked_cells = cells_of(asked);
      const std::uint32_t count = both.count(asked_cells);
      CHECK(both.field.count(asked) == count);
      CHECK(both.field.any(asked) == (count != 0));
      CHECK(first_of(both.field, asked) == both.first(asked_cells));
      Cells from_right = asked_cells;
      std::stable_sort(from_right.begin(), from_right.end(),
                       [](const Vec2i& a, const Vec2i& b) { return a.y != b.y ? a.y < b.y : a.x > b.x; });
      Vec2i found = BitField::kNowhere;
      CHECK(both.field.first_from_right(asked, &found) == (count != 0));
      CHECK(found == both.first(from_right));

      std::uint32_t window = 0;
      const Vec2i corner{static_cast<int>(pick(random, -70, width + 40)), edge(height)};
      for (int bit = 0; bit < 32; ++bit) {
        window |= (both.picture.test(corner.x + bit, corner.y) ? 1U : 0U) << bit;
      }
      CHECK(both.field.window(corner.x, corner.y) == window);
    }
    CHECK(both.field.count() ==
          static_cast<std::uint32_t>(std::count(both.picture.cells.begin(), both.picture.cells.end(), 1)));
  }
}

TEST_CASE("cells: places far outside, up to the ends of the integers -> clear, and writing does nothing") {
  Both both(40, 20);
  both.field.set(both.field.bounds());
  both.put(cells_of({{0, 0}, {40, 20}}), true);
  for (const int far : {INT32_MIN, INT32_MIN / 2, -1, 40, 1 << 30, INT32_MAX}) {
    for (const Vec2i& place : {Vec2i{far, 3}, {3, far}, {far, far}}) {
      CHECK(!both.field.test(place) == !both.picture.contains(place.x, place.y));
      if (!both.picture.contains(place.x, place.y)) {
        both.field.clear(place);
        for (const int diameter : {1, 12, 16, 17, 300}) {
          if (std::abs(static_cast<std::int64_t>(far)) > 300) {
            CHECK(!both.field.any(disc_stamp(diameter), place));
            both.field.clear(disc_stamp(diameter), place);
          }
        }
        CHECK(both.field.window(place.x, place.y) == (place.x == -1 && place.y == 3 ? 0xFFFFFFFEU : 0U));
      }
    }
  }
  CHECK(both.field.count({{INT32_MIN, INT32_MIN}, {INT32_MAX, INT32_MAX}}) == 800);
  CHECK(both.difference() == "");
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

TEST_CASE("discs: set, cleared and asked at random places, clipped at the edges -> as a picture of chars") {
  const std::uint64_t seed = 20260402;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  for (const auto& [width, height] : {std::pair{1, 1}, {20, 12}, {40, 30}, {100, 60}, {200, 15}}) {
    Both both(width, height);
    for (int turn = 0; turn < 50 * kScale; ++turn) {
      const auto place = [&random](int side, int diameter) {
        return static_cast<int>(pick(random, -diameter - 1, side + 1));
      };
      const int diameter =
          static_cast<int>(pick(random, 0, 3) == 0 ? pick(random, 17, 90) : pick(random, 0, 16));
      const DiscStamp disc = disc_stamp(diameter);
      const Vec2i corner{place(width, diameter), place(height, diameter)};
      CAPTURE(diameter);
      CAPTURE(at(corner));
      const Cells cells = cells_of_disc(diameter, corner);
      const std::uint32_t count = both.count(cells);
      CHECK(both.field.count(disc, corner) == count);
      CHECK(both.field.any(disc, corner) == (count != 0));
      CHECK(first_of(both.field, disc, corner) == both.first(cells));
      const bool value = pick(random, 0, 1) == 0;
      both.put(cells, value);
      if (value) {
        both.field.set(disc, corner);
      } else {
        both.field.clear(disc, corner);
      }
      REQUIRE(both.difference() == "");
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
          const Vec2i own = pick(random, 0, 20) == 0
                                ? BitField::kNowhere
                                : Vec2i{x + static_cast<int>(pick(random, -reach, reach)),
                                        y + static_cast<int>(pick(random, -reach, reach))};
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
        const Vec2i corner{static_cast<int>(pick(random, 0, width - diameter)),
                           static_cast<int>(pick(random, 0, height - diameter))};
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

// --- Rays

TEST_CASE(
    "rays: all fields of 3 x 2 cells, all origins in half cells, all small directions -> as brute force") {
  std::int64_t rays = 0;
  std::int64_t failures = 0;
  for (unsigned bits = 0; bits < 64; ++bits) {
    Both both(3, 2);
    std::vector<reference::Voxel> voxels;
    for (int i = 0; i < 6; ++i) {
      if ((bits >> i & 1) != 0) {
        both.field.set(Vec2i{i % 3, i / 3});
        voxels.push_back({i % 3, i / 3, 0});
      }
    }
    if (kScale == 1 && bits % 7 != 0) {
      continue;
    }
    for (int y = -2; y <= 6; ++y) {
      for (int x = -2; x <= 8; ++x) {
        for (int dy = -3; dy <= 3; ++dy) {
          for (int dx = -3; dx <= 3; ++dx) {
            if (dx == 0 && dy == 0) {
              continue;
            }
            const FieldRay ray = ray_q8(128 * x, 128 * y, dx, dy);
            const std::string sentence =
                wrong(both.field, ray, reference::brute_force(voxels, to_reference(ray)));
            ++rays;
            if (!sentence.empty() && ++failures <= 5) {
              FAIL_CHECK("field " << bits << ", " << sentence);
            }
          }
        }
      }
    }
  }
  CHECK(failures == 0);
  CHECK(rays > 40000);
}

TEST_CASE(
    "rays: random fields and hard rays (in edges, through corners, at the limits) -> as the voxels' judge") {
  const std::uint64_t seed = 20260404;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  reference::Statistics statistics;
  std::int64_t failures = 0;
  for (const auto& [width, height] : {std::pair{1, 1},
                                      {8, 8},
                                      {32, 32},
                                      {33, 5},
                                      {64, 100},
                                      {100, 64},
                                      {800, 600},
                                      {4096, 40},
                                      {30, 4096}}) {
    for (const int one_in : {3, 40, 4000}) {
      Both both(width, height);
      both.sprinkle(random, one_in);
      const reference::BitGrid grid = grid_of(both.picture);
      tests::RayLimits limits = tests::full_limits({width, height, 1});
      for (std::size_t axis = 0; axis < 2; ++axis) {
        limits.origin_low_q8[axis] = std::max(limits.origin_low_q8[axis], std::int64_t{-kMaxFieldOriginQ8});
        limits.origin_high_q8[axis] = std::min(limits.origin_high_q8[axis], std::int64_t{kMaxFieldOriginQ8});
      }
      tests::RayCases cases(random(), {width, height, 1}, limits);
      for (int i = 0; i < 300 * kScale; ++i) {
        reference::Ray judged = cases.next().ray;
        judged.origin_q8[2] = 128;
        judged.direction[2] = 0;
        if (judged.direction[0] == 0 && judged.direction[1] == 0) {
          continue;
        }
        const std::string sentence =
            wrong(both.field, to_field(judged), reference::walk(grid, judged, &statistics));
        if (!sentence.empty() && ++failures <= 5) {
          FAIL_CHECK(width << " x " << height << ", one in " << one_in << ": " << sentence);
        }
      }
    }
  }
  CHECK(failures == 0);
  MESSAGE(reference::describe(statistics));
  // The hard cases were there.
  CHECK(statistics.hits > 500 * kScale);
  CHECK(statistics.starts_inside > 100 * kScale);
  CHECK(statistics.tied_hits > 50 * kScale);
}

TEST_CASE("rays: the greatest field, origins and directions -> as brute force, seen from near by") {
  const std::uint64_t seed = 20260405;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  Both both(kMaxFieldSide, 64);
  // Solids in the last 4096 columns, where the judge can be shifted to.
  const int shift = kMaxFieldSide - 4096;
  std::vector<reference::Voxel> voxels;
  for (int i = 0; i < 60; ++i) {
    const Vec2i cell{static_cast<int>(pick(random, shift, kMaxFieldSide - 1)),
                     static_cast<int>(pick(random, 0, 63))};
    both.field.set(cell);
    voxels.push_back({cell.x - shift, cell.y, 0});
  }
  std::int64_t hits = 0;
  for (int i = 0; i < 2000 * kScale; ++i) {
    // From far away towards a cell: the direction is that from the origin, scaled down, so many only come
    // near.
    const reference::Voxel& voxel = voxels[static_cast<std::size_t>(pick(random, 0, 59))];
    const std::int64_t ox = i % 3 == 0 ? (i % 2 == 0 ? -kMaxFieldOriginQ8 : kMaxFieldOriginQ8)
                                       : pick(random, -kMaxFieldOriginQ8, kMaxFieldOriginQ8);
    const std::int64_t oy = i % 5 == 0 ? kMaxFieldOriginQ8 : pick(random, -3000, 20000);
    const std::int64_t to_x = 256 * (voxel[0] + shift) + pick(random, 0, 256) - ox;
    const std::int64_t to_y = 256 * voxel[1] + pick(random, 0, 256) - oy;
    const std::int64_t longest = std::max(std::abs(to_x), std::abs(to_y));
    const std::int64_t dx = to_x * kMaxFieldDirection / std::max<std::int64_t>(longest, 1);
    const std::int64_t dy = to_y * kMaxFieldDirection / std::max<std::int64_t>(longest, 1);
    if (dx == 0 && dy == 0) {
      continue;
    }
    const FieldRay ray =
        ray_q8(static_cast<int>(ox), static_cast<int>(oy), static_cast<int>(dx), static_cast<int>(dy));
    reference::Ray judged = to_reference(ray);
    judged.origin_q8[0] -= 256 * shift;
    FieldHit hit;
    REQUIRE(both.field.first_hit(ray, &hit) == Status::kOk);
    const reference::Hit expected = reference::brute_force(voxels, judged);
    hits += expected.hit ? 1 : 0;
    REQUIRE_MESSAGE(reference::same_answer(to_reference(hit, shift), expected),
                    reference::describe(to_reference(ray))
                        << ": got " << reference::describe(to_reference(hit)) << ", expected "
                        << reference::describe(expected));
  }
  CHECK(hits > 500 * kScale);
}

TEST_CASE("rays: beyond the limits -> refused, hit untouched") {
  Both both(10, 10);
  FieldHit hit;
  hit.visits = 77;
  const int far = kMaxFieldOriginQ8;
  const int fast = kMaxFieldDirection;
  CHECK(both.field.first_hit(ray_q8(0, 0, 0, 0), &hit) == Status::kBadArgument);
  for (const FieldRay& ray :
       {ray_q8(far + 1, 0, 1, 0), ray_q8(0, far + 1, 1, 0), ray_q8(-far - 1, 0, 1, 0),
        ray_q8(0, -far - 1, 1, 0), ray_q8(0, 0, fast + 1, 0), ray_q8(0, 0, 0, -fast - 1)}) {
    CHECK(both.field.first_hit(ray, &hit) == Status::kOutOfRange);
  }
  CHECK(hit.visits == 77);
  CHECK(both.field.first_hit(ray_q8(far, -far, -fast, fast), &hit) == Status::kOk);
}

TEST_CASE("rays: into an answer that held another -> as into a new one, whatever the ray meets") {
  Both both(40, 30);
  both.field.set(CellBox{{20, 10}, {22, 20}});
  BitField empty;
  for (const BitField* field :
       {&static_cast<const BitField&>(both.field), &static_cast<const BitField&>(empty)}) {
    for (const FieldRay& ray :
         {ray_q8(0, 3840, 1, 0), ray_q8(0, 100, 1, 0), ray_q8(-9, -9, -1, 3), ray_q8(10000, 3840, -7, 0),
          ray_q8(5300, 3000, 1, 1), ray_q8(99, 9000, 2, 1)}) {
      FieldHit fresh;
      REQUIRE(field->first_hit(ray, &fresh) == Status::kOk);
      FieldHit used;
      REQUIRE(both.field.first_hit(ray_q8(3, 3840, 5, 1), &used) == Status::kOk);
      REQUIRE(used.kind == FieldHitKind::kHit);
      used.corner = true;
      REQUIRE(field->first_hit(ray, &used) == Status::kOk);
      CHECK(used.kind == fresh.kind);
      CHECK(used.axis == fresh.axis);
      CHECK(used.corner == fresh.corner);
      CHECK(used.cell == fresh.cell);
      CHECK(used.t_numerator == fresh.t_numerator);
      CHECK(used.t_denominator == fresh.t_denominator);
      CHECK(used.visits == fresh.visits);
    }
  }
}

TEST_CASE("rays: along rows and columns of an empty paper's world -> a word each 32 cells, a word a row") {
  Both both(800, 600);
  FieldHit hit;
  for (const int sign : {1, -1}) {
    REQUIRE(both.field.first_hit(ray_q8(sign > 0 ? 0 : 800 * 256, 300 * 256 + 5, sign * 7, 0), &hit) ==
            Status::kOk);
    CHECK(hit.visits == 25);
    REQUIRE(both.field.first_hit(ray_q8(300 * 256 + 5, sign > 0 ? 0 : 600 * 256, 0, sign * 9), &hit) ==
            Status::kOk);
    CHECK(hit.visits == 600);
    REQUIRE(both.field.first_hit(ray_q8(sign > 0 ? 128 : 799 * 256, 300 * 256, sign * 800, 2), &hit) ==
            Status::kOk);
    CHECK(hit.visits <= 25 + 3);
  }
}

// --- Normals

namespace {

double degrees_between(const Vec2i& estimate, double x, double y) {
  const double cross = estimate.x * y - estimate.y * x;
  const double dot = estimate.x * x + estimate.y * y;
  return std::abs(std::atan2(cross, dot)) * 180 / 3.14159265358979;
}

struct Errors {
  double squares = 0;
  double greatest = 0;
  int count = 0;
  void add(double error) {
    squares += error * error;
    greatest = std::max(greatest, error);
    ++count;
  }
  double rms() const { return std::sqrt(squares / count); }
};

// A hit with its normal, or a failed test.
Vec2i normal_of(const BitField& field, const FieldRay& ray) {
  FieldHit hit;
  REQUIRE(field.first_hit(ray, &hit) == Status::kOk);
  REQUIRE(hit.kind == FieldHitKind::kHit);
  return field.normal(ray, hit);
}

}  // namespace

TEST_CASE("normal: walls and one-cell lines along the axes and the diagonals -> exact from both sides") {
  const auto check = [](auto solid, double x, double y) {
    Both both(60, 60);
    for (int row = 0; row < 60; ++row) {
      for (int column = 0; column < 60; ++column) {
        if (solid(column, row)) {
          both.field.set(Vec2i{column, row});
        }
      }
    }
    // From the side that the normal shows to, at many angles, to about the middle.
    for (int angle = -60; angle <= 60; angle += 5) {
      const double turn = angle * 3.14159265358979 / 180;
      const double dx = x * std::cos(turn) - y * std::sin(turn);
      const double dy = x * std::sin(turn) + y * std::cos(turn);
      const double length = std::hypot(x, y);
      for (int to = 28 * 256 + 100; to < 32 * 256; to += 57) {
        const int ox = to + static_cast<int>(15 * 256 * dx / length);
        const int oy = 30 * 256 + 60 + static_cast<int>(15 * 256 * dy / length);
        const FieldRay ray =
            ray_q8(ox, oy, static_cast<int>(-1000 * dx / length), static_cast<int>(-1000 * dy / length));
        const Vec2i normal = normal_of(both.field, ray);
        CAPTURE(reference::describe(to_reference(ray)));
        CHECK(normal.x * y == normal.y * x);
        CHECK(normal.x * x + normal.y * y > 0);
      }
    }
  };
  check([](int, int y) { return y >= 30; }, 0, -1);
  check([](int, int y) { return y < 30; }, 0, 1);
  check([](int x, int) { return x >= 30; }, -1, 0);
  check([](int x, int) { return x < 30; }, 1, 0);
  check([](int, int y) { return y == 30; }, 0, -1);
  check([](int, int y) { return y == 30; }, 0, 1);
  check([](int x, int) { return x == 30; }, -1, 0);
  check([](int x, int) { return x == 30; }, 1, 0);
  check([](int x, int y) { return x + y == 60; }, -1, -1);
  check([](int x, int y) { return x + y == 60; }, 1, 1);
  check([](int x, int y) { return x == y; }, 1, -1);
  check([](int x, int y) { return x == y; }, -1, 1);
  check([](int x, int y) { return x + y >= 60; }, -1, -1);
}

TEST_CASE("normal: discs of 2 to 12 cells and slanted walls and lines -> within the stated accuracy") {
  // Discs: rays that aim at the circle, against the circle's own normal where they meet it.
  const double pi = 3.14159265358979;
  const double disc_limits[13] = {0, 0, 27, 14.5, 16.5, 10.5, 8, 9, 7, 6, 6, 5.5, 5};
  std::string line;
  for (int diameter = 2; diameter <= 12; ++diameter) {
    Both both(64, 64);
    const double middle = 20 + diameter / 2.0;
    both.field.set(disc_stamp(diameter), {20, 20});
    Errors errors;
    for (int angle = 0; angle < 360; angle += 3) {
      for (int off = -7; off <= 7; off += 2) {
        const double turn = (angle + 0.37) * pi / 180;
        const double b = off / 8.0 * diameter / 2 * 0.9;
        const double dx = std::cos(turn);
        const double dy = std::sin(turn);
        const FieldRay ray = ray_q8(static_cast<int>((middle - 18 * dx - b * dy) * 256),
                                    static_cast<int>((middle - 18 * dy + b * dx) * 256),
                                    static_cast<int>(60000 * dx), static_cast<int>(60000 * dy));
        FieldHit hit;
        REQUIRE(both.field.first_hit(ray, &hit) == Status::kOk);
        if (hit.kind != FieldHitKind::kHit) {
          continue;  // past the corners of the cells
        }
        const double along = -std::sqrt(diameter * diameter / 4.0 - b * b);
        errors.add(degrees_between(both.field.normal(ray, hit), along * dx - b * dy, along * dy + b * dx));
      }
    }
    line += " " + std::to_string(diameter) + ": " + std::to_string(errors.rms()).substr(0, 4);
    CHECK(errors.count > 800);
    CHECK(errors.rms() < disc_limits[diameter]);
  }
  MESSAGE("RMS degrees of discs by diameter:" << line);

  // Slanted half planes and lines one cell thick, at all angles.
  for (const bool thin : {false, true}) {
    Errors errors;
    // Never 45 degrees, where a ray may slip through the corners of a thin line, as it should.
    for (int part = 0; part < 50; ++part) {
      const double turn = (1 + 7.3 * part) * pi / 180;
      const double nx = std::cos(turn);
      const double ny = std::sin(turn);
      Both both(80, 80);
      for (int y = 0; y < 80; ++y) {
        for (int x = 0; x < 80; ++x) {
          const double depth = (x + 0.5 - 40) * nx + (y + 0.5 - 40) * ny;
          // A line of one cell a row or column, whichever it crosses more of.
          const double thickness = std::max(std::abs(nx), std::abs(ny));
          if (thin ? depth >= -thickness / 2 && depth < thickness / 2 : depth < 0) {
            both.field.set(Vec2i{x, y});
          }
        }
      }
      for (int slant = -60; slant <= 60; slant += 15) {
        const double from = turn + slant * pi / 180;
        for (int to = -8; to <= 8; ++to) {
          const double x = 40 - ny * to / 1.7;
          const double y = 40 + nx * to / 1.7;
          const FieldRay ray =
              ray_q8(static_cast<int>((x + 12 * std::cos(from)) * 256),
                     static_cast<int>((y + 12 * std::sin(from)) * 256),
                     static_cast<int>(-60000 * std::cos(from)), static_cast<int>(-60000 * std::sin(from)));
          errors.add(degrees_between(normal_of(both.field, ray), nx, ny));
        }
      }
    }
    const std::string what = (thin ? "one-cell lines" : "walls") + std::string(": RMS ") +
                             std::to_string(errors.rms()) + ", greatest " + std::to_string(errors.greatest);
    MESSAGE("degrees off for " << what);
    CHECK(errors.rms() < 2);
    CHECK(errors.greatest < 6);
  }
}

TEST_CASE("normal: random pictures turned and mirrored -> the normal turns and mirrors with them") {
  const std::uint64_t seed = 20260406;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  constexpr int kSide = 40;
  int hits = 0;
  for (int turn = 0; turn < 40 * kScale; ++turn) {
    Both both(kSide, kSide);
    both.sprinkle(random, static_cast<int>(pick(random, 2, 12)));
    // Origins off the edges of cells, which belong to one side only.
    const auto odd = [&random] { return static_cast<int>(2 * pick(random, 0, kSide * 128 - 1) + 1); };
    const auto slope = [&random] { return static_cast<int>(pick(random, -4, 4)); };
    const FieldRay ray = ray_q8(odd(), odd(), slope(), slope());
    FieldHit hit;
    if (both.field.first_hit(ray, &hit) != Status::kOk || hit.kind != FieldHitKind::kHit) {
      continue;
    }
    ++hits;
    const Vec2i normal = both.field.normal(ray, hit);
    CHECK(normal != Vec2i{});
    for (int symmetry = 1; symmetry < 8; ++symmetry) {
      const auto turned = [symmetry](const Vec2i& v, int side) {  // side 0: a direction
        Vec2i result = (symmetry & 4) != 0 ? Vec2i{v.y, v.x} : v;
        result.x = (symmetry & 1) != 0 ? side - result.x : result.x;
        result.y = (symmetry & 2) != 0 ? side - result.y : result.y;
        return result;
      };
      Both other(kSide, kSide);
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          if (both.picture.test(x, y)) {
            other.field.set(turned({x, y}, kSide - 1));
          }
        }
      }
      const Vec2i origin = turned({ray.origin.x.raw, ray.origin.y.raw}, kSide * 256);
      const Vec2i direction = turned(ray.direction, 0);
      const FieldRay other_ray = ray_q8(origin.x, origin.y, direction.x, direction.y);
      FieldHit other_hit;
      REQUIRE(other.field.first_hit(other_ray, &other_hit) == Status::kOk);
      REQUIRE(other_hit.kind == FieldHitKind::kHit);
      CHECK(other_hit.cell == turned(hit.cell, kSide - 1));
      CHECK(other.field.normal(other_ray, other_hit) == turned(normal, 0));
    }
  }
  CHECK(hits > 20 * kScale);
}
