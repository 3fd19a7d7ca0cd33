#include "wide/lit/slope_table.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "thimble/light/host/slope.h"
#include "wide/lit/kernels.h"

namespace thimble::wide {
namespace {

constexpr int kSide = lit::kSlopeSide;
constexpr int kColumns = lit::kSlopeColumns;
constexpr unsigned kAll = (1U << kSide) - 1;

constexpr std::array<uint16_t, kAll + 1> reversed_words() {
  std::array<uint16_t, kAll + 1> words{};
  for (unsigned word = 0; word <= kAll; ++word) {
    for (int bit = 0; bit < kSide; ++bit) {
      words[word] = static_cast<uint16_t>(words[word] | (word >> bit & 1U) << (kSide - 1 - bit));
    }
  }
  return words;
}
constexpr std::array<uint16_t, kAll + 1> kReversed = reversed_words();

// Makes of rows along x columns along an axis, or of such columns rows: the bits and the index of that axis change places.
void turn(int axis, uint16_t (*rows)[kSide]) {
  if (axis == 0) {
    return;
  }
  uint16_t words[16][kTurnLanes] = {};
  const auto word = [&](int k, int lane) -> uint16_t& { return axis == 1 ? rows[lane][k] : rows[k][lane]; };
  for (int k = 0; k < kSide; ++k) {
    for (int lane = 0; lane < kSide; ++lane) {
      words[k][lane] = word(k, lane);
    }
  }
  turn_words(words);
  for (int k = 0; k < kSide; ++k) {
    for (int lane = 0; lane < kSide; ++lane) {
      word(k, lane) = words[k][lane];
    }
  }
}

// The order in which the surface is followed: ring by ring, the corners of a ring last. Three columns say which height
// the next column is expected to have: that of the first plus that of the second, less that of the third.
struct Step {
  int8_t u;
  int8_t v;
  uint8_t at;  // the column's place in the array of heights, then those of the three
  uint8_t plus[2];
  uint8_t minus;
};
constexpr int kAcross = 2 * kColumns + 1;
constexpr int kSteps = kAcross * kAcross - 1;

constexpr uint8_t place_of(int u, int v) {
  return static_cast<uint8_t>((kColumns + u) * kAcross + kColumns + v);
}
constexpr Step step_to(int u, int v) {
  const int step_u = u > 0 ? 1 : -1;
  const int step_v = v > 0 ? 1 : -1;
  const int size_u = u < 0 ? -u : u;
  const int size_v = v < 0 ? -v : v;
  Step step{static_cast<int8_t>(u), static_cast<int8_t>(v), place_of(u, v), {}, 0};
  if (size_u == size_v) {
    step.plus[0] = place_of(u - step_u, v);
    step.plus[1] = place_of(u, v - step_v);
    step.minus = place_of(u - step_u, v - step_v);
  } else {
    const int far_u = size_u > size_v ? step_u : 0;
    const int far_v = far_u == 0 ? step_v : 0;
    const bool first = size_u + size_v == 1;
    step.plus[0] = step.plus[1] = place_of(u - far_u, v - far_v);
    step.minus = first ? step.plus[0] : place_of(u - 2 * far_u, v - 2 * far_v);
  }
  return step;
}
constexpr std::array<Step, kSteps> all_steps() {
  std::array<Step, kSteps> steps{};
  size_t count = 0;
  for (int ring = 1; ring <= kColumns; ++ring) {
    for (int along = 1 - ring; along <= ring; ++along) {
      for (int side = -ring; side <= ring; side += 2 * ring) {
        const int other = along == ring ? -side : along;
        steps[count++] = step_to(side, along == ring ? side : other);
        steps[count++] = step_to(other, side);
      }
    }
  }
  return steps;
}
constexpr std::array<Step, kSteps> kOrder = all_steps();

// The core's Columns (src/light/slope.cpp) on words: a loop over voxels there is a count of bits here. Nothing
// branches on what is solid, which nobody can predict. Heights are -kColumns .. kColumns, middle_w is 4 .. 7: a place
// above the window's lower end is -1 at the least, so words are looked at with a bit more below them.
struct Columns {
  lit::SlopeWindow* window;
  int axis;  // along them
  bool upwards;
  int side_u;  // the axes of their two indices, the first one last
  int side_v;
  int middle_w;
  int middle_u;
  int middle_v;
  bool changed = false;
  bool has_edge = false;  // a column leaves the course
  int8_t heights[kAcross * kAcross] = {};

  // Until they end the window's rows are columns.
  Columns(lit::SlopeWindow* of, const Vec3i& middle, int along, bool is_upwards)
      : window(of),
        axis(along),
        upwards(is_upwards),
        side_u(along == 1 ? 0 : 1),
        side_v(along == 2 ? 0 : 2),
        middle_w(is_upwards ? middle[along] : kSide - 1 - middle[along]),
        middle_u(middle[side_u]),
        middle_v(middle[side_v]) {
    turn(axis, window->rows);
    reverse();
  }
  ~Columns() {
    reverse();
    turn(axis, window->rows);
  }
  Columns(const Columns&) = delete;
  Columns& operator=(const Columns&) = delete;

  // Bit 0 is where they begin.
  void reverse() const {
    for (auto& row : window->rows) {
      for (uint16_t& word : row) {
        word = upwards ? word : kReversed[word];
      }
    }
  }
  int height(int u, int v) const { return heights[place_of(u, v)]; }
  // Finds the height at which a column ends, from an expected height.
  int measure(unsigned word, int height) const {
    const unsigned wide = word << 1;
    const auto place = static_cast<unsigned>(middle_w + height + 1);
    const int up = std::min(kColumns, height + __builtin_ctz(~(wide >> (place + 1))));
    const unsigned below = (wide & ((1U << place) - 1)) | 1U;
    const int down = std::max(-kColumns, 30 - __builtin_clz(below) - middle_w);
    const int is_solid = 0 - static_cast<int>(wide >> place & 1U);
    return down + ((up - down) & is_solid);
  }
  unsigned filled_to(int height) const { return ((1U << (middle_w + height + 1)) - 1) & kAll; }
  // Makes a column solid below its top where it is a shell.
  unsigned thickened(unsigned word, int top) const {
    const auto place = static_cast<unsigned>(middle_w + top + 1);
    const unsigned down = (1U << place) - 1;
    const unsigned shell = down & ~(down >> lit::kSlopeShell);
    const unsigned is_thin = (~word & shell) != 0 ? 1U : 0U;
    return word | (down & (0U - ((word << 1 >> place) & is_thin & 1U)));
  }
  // Follows the surface; with kCuts, a surface that leaves its course is continued as before. Returns whether the
  // column beside the middle, in direction `out`, was cut off.
  template <bool kCuts>
  bool follow(const Vec3i& out) {
    uint16_t* const middle = &window->rows[middle_v][middle_u];
    const int top = measure(*middle, 0);
    heights[place_of(0, 0)] = static_cast<int8_t>(top);
    const unsigned of_middle = thickened(*middle, top);
    unsigned changes = of_middle ^ *middle;
    *middle = static_cast<uint16_t>(of_middle);
    unsigned edges = 0;
    unsigned wall = 0;
    const unsigned beside = place_of(out[side_u], out[side_v]);
    for (const Step& step : kOrder) {
      const int wanted = std::clamp(heights[step.plus[0]] + heights[step.plus[1]] - heights[step.minus],
                                    -kColumns, kColumns);
      const auto at_u = static_cast<unsigned>(middle_u + step.u);
      const auto at_v = static_cast<unsigned>(middle_v + step.v);
      // Columns beside the window are empty, and what is made solid in them is dropped.
      uint16_t nothing = 0;
      uint16_t* const column = at_u < kSide && at_v < kSide ? &window->rows[at_v][at_u] : &nothing;
      const unsigned word = *column;
      const int found = measure(word, wanted);
      const unsigned edge = std::abs(found - wanted) >= lit::kEdgeStep ? 1U : 0U;
      edges |= edge;
      const unsigned cut = kCuts ? 0U - edge : 0U;
      const unsigned solid = (thickened(word, found) & ~cut) | (filled_to(wanted) & cut);
      heights[step.at] = static_cast<int8_t>(found + ((wanted - found) & static_cast<int>(cut)));
      changes |= (solid ^ word) | (cut & 1U);
      wall |= cut & (step.at == beside ? 1U : 0U);
      *column = static_cast<uint16_t>(solid);
    }
    changed = changes != 0;
    has_edge = edges != 0;
    return wall != 0;
  }
  // Whether all columns end at the height of the middle one.
  bool are_level() const {
    return std::all_of(heights, heights + kAcross * kAcross,
                       [this](int8_t one) { return one == heights[place_of(0, 0)]; });
  }
};

Vec3i middle_of(const Vec3i& voxel, const Face& face) {
  Vec3i middle;
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = voxel[axis] - lit::slope_window_low(voxel[axis]);
  }
  middle[face.axis] -= face.negative ? 0 : 1;
  return middle;
}

// Whether the voxel has nothing solid close behind it.
bool is_shell(const lit::SlopeWindow& window, Vec3i voxel, const Face& face) {
  bool is_thin = false;
  for (int behind = 1; behind < lit::kSlopeShell; ++behind) {
    voxel[face.axis] += face.negative ? 1 : -1;
    is_thin = is_thin || !window.is_solid(voxel);
  }
  return is_thin;
}

Vec3i gradient_at(const lit::SlopeWindow& window, const Vec3i& point) {
  const int32_t of_point[3] = {point.x, point.y, point.z};
  int32_t gradient[3];
  find_gradient(window.rows[0], of_point, gradient);
  return {gradient[0], gradient[1], gradient[2]};
}

// Follows a face's surface along an axis.
void follow(int along, bool upwards, const Face& face, KnownSlope* known) {
  known->cut = known->window;
  Vec3i out;
  out[face.axis] = face.negative ? -1 : 1;
  Columns columns(&known->cut, middle_of(known->voxel, face), along, upwards);
  const bool wall = columns.follow<true>(out);
  known->keeps_face = along == face.axis
                          ? columns.are_level()
                          : wall || columns.height(out[columns.side_u], out[columns.side_v]) >= 0;
  known->is_cut = columns.changed;
}

uint8_t number_of(int axis, bool upwards) {
  return static_cast<uint8_t>(2 * axis + (upwards ? 1 : 0));
}

// Mixes a place into a number; neighbouring places get numbers that lie far apart.
uint32_t mixed(const Vec3i& place, uint32_t rest) {
  uint32_t mix = static_cast<uint32_t>(place.x) * 0x9E3779B1U + static_cast<uint32_t>(place.y) * 0x85EBCA77U +
                 static_cast<uint32_t>(place.z) * 0xC2B2AE3DU + rest * 0x27D4EB2FU;
  mix = (mix ^ mix >> 15) * 0x2C1B3C6DU;
  return mix >> 12;
}

}  // namespace

const KnownWindow& SlopeTable::window_at(const Vec3i& low, uint16_t index_q12) {
  KnownWindow& known = windows_[mixed(low, index_q12) & (count_ / 4 - 1)];
  if (!known.is_known || known.window.low != low || known.index_q12 != index_q12) {
    known = {};
    known.window.low = low;
    known.index_q12 = index_q12;
    known.is_known = true;
    const lit::Body body{frame_->scene.surfaces, frame_->effects, index_q12};
    lit::read_slope_window(frame_->tree, body, &known.window, &known.visits);
  }
  return known;
}

KnownSlope& SlopeTable::find(const Vec3i& voxel, const Face& face, uint16_t index_q12) {
  const uint8_t number = number_of(face.axis, !face.negative);
  KnownSlope& known = places_[mixed(voxel, number + 8U * index_q12) & (count_ - 1)];
  if (known.face == number && known.voxel == voxel && known.index_q12 == index_q12) {
    return known;
  }
  known.voxel = voxel;
  known.face = number;
  known.index_q12 = index_q12;
  known.course = KnownSlope::kNone;
  Vec3i low;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = lit::slope_window_low(voxel[axis]);
  }
  const KnownWindow& window = window_at(low, index_q12);
  known.visits = window.visits;
  known.window = window.window;
  const Vec3i middle = middle_of(voxel, face);
  if (is_shell(known.window, middle, face)) {
    Columns columns(&known.window, middle, face.axis, !face.negative);
    columns.follow<false>({});
    if (!columns.has_edge) {
      // Following the surface along the face's axis again would take the same course, and has nothing left to make
      // solid.
      known.course = number;
      known.keeps_face = columns.are_level();
      known.is_cut = false;
    }
  }
  return known;
}

Vec3i SlopeTable::normal(const Vec3Q8& at, const Face& face, uint16_t index_q12, uint32_t* visits) {
  const Vec3i voxel{at.x.floor(), at.y.floor(), at.z.floor()};
  KnownSlope& known = find(voxel, face, index_q12);
  *visits += known.visits;
  Vec3i point;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t low = lit::slope_window_low(voxel[axis]) * Q8::kOne;
    point[axis] = (at[axis].raw - low) / (Q8::kOne / lit::kSlopeUnit);
  }
  const Vec3i normal = gradient_at(known.window, point);
  const int along = lit::slope_axis(normal, face);
  if (along < 0) {
    return lit::unit_of_slope({}, face);
  }
  const bool upwards = along == face.axis ? !face.negative : normal[along] > 0;
  if (known.course != number_of(along, upwards)) {
    follow(along, upwards, face, &known);
    known.course = number_of(along, upwards);
  }
  if (known.keeps_face) {
    return lit::unit_of_slope({}, face);
  }
  return lit::unit_of_slope(known.is_cut ? gradient_at(known.cut, point) : normal, face);
}

}  // namespace thimble::wide
