// The slope of a surface of voxels. Around the point stands a window of 12 x 12 x 12 voxels, a bit each, read
// off the tree in one walk. In it
//
//   normal = - sum over solid voxels of (R^2 - d^2) d,   d from the point to the voxel's centre, |d| < R
//
// which is the gradient of what is solid, blurred by (R^2 - d^2)^2: smooth in the point too, so that no
// voxel shows. Before that, the surface is followed from column to column along the normal's largest axis;
// where it leaves its course by kEdgeStep at once, it is continued as before. So a cube stays a cube.
#include "thimble/light/host/slope.h"

#include "../base/bits.h"
#include "../base/integers.h"
#include "thimble/light/host/optics.h"
#include "thimble/light/host/slope_window.h"
#include "thimble/trace/secondary_ray.h"

namespace thimble::lit {
namespace {

// A solid block; corner in voxels of the window, which the block may exceed.
void fill(const Vec3i& corner, int32_t side, SlopeWindow* window) {
  const int32_t from = greater(corner.x, 0);
  const unsigned bits = (1U << lesser(corner.x + side, kSlopeSide)) - (1U << from);
  for (int32_t z = greater(corner.z, 0); z < lesser(corner.z + side, kSlopeSide); ++z) {
    for (int32_t y = greater(corner.y, 0); y < lesser(corner.y + side, kSlopeSide); ++y) {
      window->rows[z][y] = static_cast<uint16_t>(window->rows[z][y] | bits);
    }
  }
}

// Octants of a node of half side `half` at `corner` (of the window) that reach into the window.
unsigned octants_inside(const Vec3i& corner, int32_t half) {
  constexpr uint8_t kLower[3] = {0x55, 0x33, 0x0F};
  unsigned octants = 0xFF;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t low = corner[axis];
    const bool lower = low < kSlopeSide && low + half > 0;
    const bool upper = low + half < kSlopeSide && low + 2 * half > 0;
    octants &= (lower ? kLower[axis] : 0U) | (upper ? 0xFFU & ~kLower[axis] : 0U);
  }
  return octants;
}

// The voxels of a node of level 1, which begins at an even place of the window and so lies inside.
void put_voxels(const CompactTree& tree, const Body& body, uint32_t index, unsigned mask, const Vec3i& corner,
                SlopeWindow* window) {
  if (!body.holds_all()) {
    unsigned kept = 0;
    uint32_t number = tree.first_child(index);
    for (unsigned left = mask; left != 0; left &= left - 1, ++number) {
      kept |= body.holds(tree.voxel_material(number)) ? left & (0U - left) : 0U;
    }
    mask = kept;
  }
  for (int pair = 0; pair < 4; ++pair) {
    uint16_t& row = window->rows[corner.z + (pair >> 1)][corner.y + (pair & 1)];
    row = static_cast<uint16_t>(row | ((mask >> (2 * pair)) & 3U) << corner.x);
  }
}

// What R^2 - d^2 adds up to over the whole voxels between two planes needs these sums for each plane.
struct Sums {
  int32_t first[kSlopeSide + 1] = {};   // of d
  int32_t second[kSlopeSide + 1] = {};  // of d^2
  int32_t third[kSlopeSide + 1] = {};   // of d^3, below 2^30
};

// The gradient, outwards. `point` is in 1/64 voxel of the window.
Vec3i gradient(const SlopeWindow& window, const Vec3i& point) {
  Sums sums;
  for (int32_t x = 0; x < kSlopeSide; ++x) {
    const int32_t d = x * kSlopeUnit + kSlopeUnit / 2 - point.x;
    sums.first[x + 1] = sums.first[x] + d;
    sums.second[x + 1] = sums.second[x] + d * d;
    sums.third[x + 1] = sums.third[x] + d * d * d;
  }
  Vec3i normal;
  for (int32_t z = 0; z < kSlopeSide; ++z) {
    const int32_t dz = z * kSlopeUnit + kSlopeUnit / 2 - point.z;
    for (int32_t y = 0; y < kSlopeSide; ++y) {
      const int32_t dy = y * kSlopeUnit + kSlopeUnit / 2 - point.y;
      const int32_t rest = kSlopeReachSquare - dy * dy - dz * dz;
      unsigned row = rest > 0 ? window.rows[z][y] : 0U;
      if (row == 0) {
        continue;
      }
      // The voxels of the row that are within reach.
      int32_t from = 0;
      int32_t to = kSlopeSide;
      while (from < to && sums.second[from + 1] - sums.second[from] >= rest) {
        ++from;
      }
      while (to > from && sums.second[to] - sums.second[to - 1] >= rest) {
        --to;
      }
      row &= (1U << to) - (1U << from);
      int32_t of_row = 0;
      while (row != 0) {
        // Solid ones side by side.
        const unsigned begin = bits::lowest_bit(row);
        const unsigned end = bits::lowest_bit(~(row | ((1U << begin) - 1U)));
        row &= ~((1U << end) - 1U);
        of_row += static_cast<int32_t>(end - begin) * rest - (sums.second[end] - sums.second[begin]);
        normal.x -= (sums.first[end] - sums.first[begin]) * rest - (sums.third[end] - sums.third[begin]);
      }
      normal.y -= of_row * dy;
      normal.z -= of_row * dz;
    }
  }
  return normal;
}

// The columns of the window along an axis: how high the surface stands in each above the middle, followed
// from the middle outwards, at most kSlopeColumns up or down.
struct Columns {
  SlopeWindow* window;
  Vec3i middle;  // the voxel that has the point
  int axis;      // along them
  int side_u;    // the other two
  int side_v;
  int32_t up;  // 1 or -1
  bool cuts;   // where edges are
  bool changed = false;
  int8_t heights[2 * kSlopeColumns + 1][2 * kSlopeColumns + 1] = {};

  Columns(SlopeWindow* of, const Vec3i& at, int along, bool upwards, bool cuts_edges)
      : window(of),
        middle(at),
        axis(along),
        side_u(along == 0 ? 1 : 0),
        side_v(along == 2 ? 1 : 2),
        up(upwards ? 1 : -1),
        cuts(cuts_edges) {}

  int8_t& height(int u, int v) { return heights[kSlopeColumns + u][kSlopeColumns + v]; }
  int height_at(int u, int v) const { return heights[kSlopeColumns + u][kSlopeColumns + v]; }
  // From a height near by.
  int measure(int u, int v, int height) const {
    Vec3i at = middle;
    at[side_u] += u;
    at[side_v] += v;
    at[axis] += up * height;
    if (window->is_solid(at)) {
      for (; height < kSlopeColumns; ++height) {
        at[axis] += up;
        if (!window->is_solid(at)) {
          break;
        }
      }
    } else {
      while (height > -kSlopeColumns) {
        --height;
        at[axis] -= up;
        if (window->is_solid(at)) {
          break;
        }
      }
    }
    return height;
  }
  // Makes the column solid up to a height.
  void cut(int u, int v, int height) {
    Vec3i at = middle;
    at[side_u] += u;
    at[side_v] += v;
    for (int above = -kSlopeSide; above <= kSlopeSide; ++above) {
      at[axis] = middle[axis] + up * above;
      window->put(at, above <= height);
    }
  }
  // As high as the column would be, if the surface continued as it came towards it from the point.
  int expected(int u, int v) {
    const int step_u = u > 0 ? 1 : -1;
    const int step_v = v > 0 ? 1 : -1;
    int height_there = 0;
    if (absolute(u) == absolute(v)) {
      height_there = height(u - step_u, v) + height(u, v - step_v) - height(u - step_u, v - step_v);
    } else {
      const int far_u = absolute(u) > absolute(v) ? step_u : 0;
      const int far_v = far_u == 0 ? step_v : 0;
      const bool first = absolute(u) + absolute(v) == 1;
      const int before = height_at(u - far_u, v - far_v);
      height_there = first ? before : 2 * before - height_at(u - 2 * far_u, v - 2 * far_v);
    }
    return clamped(height_there, -kSlopeColumns, kSlopeColumns);
  }
  // What is solid at a height but not below is the shell of a body: as if all were solid below.
  bool thicken(int u, int v, int top) {
    Vec3i at = middle;
    at[side_u] += u;
    at[side_v] += v;
    at[axis] += up * top;
    if (!window->is_solid(at)) {
      return false;
    }
    bool thin = false;
    for (int below = 1; SlopeWindow::is_inside(at); ++below) {
      if (below > kSlopeShell && !thin) {
        return false;
      }
      thin = thin || !window->is_solid(at);
      window->put(at, true);
      at[axis] -= up;
    }
    return thin;
  }
  // Follows the surface into the column. Whether it was cut off there, where an edge begins.
  bool settle(int u, int v) {
    const int wanted = expected(u, v);
    const int found = measure(u, v, wanted);
    const bool edge = cuts && absolute(found - wanted) >= kEdgeStep;
    height(u, v) = static_cast<int8_t>(edge ? wanted : found);
    if (edge) {
      cut(u, v, wanted);
    } else {
      changed = thicken(u, v, found) || changed;
    }
    changed = changed || edge;
    return edge;
  }
  // Follows the surface ring by ring, the corners of a ring last. Whether the column beside the middle, in
  // direction `out`, was cut off.
  bool follow(const Vec3i& out) {
    bool wall = false;
    height(0, 0) = static_cast<int8_t>(measure(0, 0, 0));
    changed = thicken(0, 0, height(0, 0));
    for (int ring = 1; ring <= kSlopeColumns; ++ring) {
      for (int along = 1 - ring; along <= ring; ++along) {
        for (int side = -ring; side <= ring; side += 2 * ring) {
          // The last round does the corners.
          const int other = along == ring ? -side : along;
          const bool by_u = settle(side, along == ring ? side : other);
          const bool by_v = settle(other, side);
          wall = wall || (ring == 1 && along == 0 &&
                          ((by_u && side == out[side_u]) || (by_v && side == out[side_v])));
        }
      }
    }
    return wall;
  }
  // Whether all end where the middle one does.
  bool are_level() const {
    for (const auto& row : heights) {
      for (const int8_t one : row) {
        if (one != heights[kSlopeColumns][kSlopeColumns]) {
          return false;
        }
      }
    }
    return true;
  }
};

// Whether the voxel has nothing solid close behind it.
bool is_shell(const SlopeWindow& window, Vec3i voxel, const Vec3i& out) {
  for (int behind = 1; behind < kSlopeShell; ++behind) {
    voxel = {voxel.x - out.x, voxel.y - out.y, voxel.z - out.z};
    if (!window.is_solid(voxel)) {
      return true;
    }
  }
  return false;
}

bool is_along(const Vec3i& normal, int axis) {
  return normal[axis == 0 ? 1 : 0] == 0 && normal[axis == 2 ? 1 : 2] == 0;
}

}  // namespace

bool Body::holds(uint8_t material) const {
  const Surface surface = material < surfaces.size ? surfaces[material] : Surface{};
  const bool glass = surface.kind == SurfaceKind::kGlass && (effects & Effect::kGlass) != 0;
  const bool media = surface.kind == SurfaceKind::kMedia && (effects & Effect::kMedia) != 0;
  if (index_q12 == 0) {
    return !glass && !media;
  }
  return (glass && surface.index_q12 == index_q12) || (media && index_q12 == kMinIndexQ12);
}

bool Body::has(const CompactTree& tree, const Vec3i& voxel) const {
  uint8_t material = 0;
  return material_at(tree, voxel, &material) && holds(material);
}

// Reads the window off the tree: every node that reaches into it once. Levels fall with every step down, and
// an octant is taken off a list fixed on the way in, so that it ends whatever the tree holds.
void read_slope_window(const CompactTree& tree, const Body& body, SlopeWindow* window, uint32_t* visits) {
  struct OpenNode {
    uint32_t first_child;
    uint8_t mask;
    uint8_t left;
  } stack[kMaxLevel + 1];
  const Vec3i& low = window->low;
  uint32_t index = 0;
  int level = tree.level();
  Vec3i place;  // of the node in the world
  for (;;) {
    if (index < tree.node_count()) {
      const uint8_t mask = tree.mask(index);
      const Vec3i corner{place.x - low.x, place.y - low.y, place.z - low.z};
      ++*visits;
      if (mask == 0) {
        if (body.holds_all() || body.holds(tree.block_material(index))) {
          fill(corner, int32_t{1} << level, window);
        }
      } else if (level == 1) {
        put_voxels(tree, body, index, mask, corner, window);
      } else {
        const unsigned left = mask & octants_inside(corner, int32_t{1} << (level - 1));
        stack[level] = {tree.first_child(index), mask, static_cast<uint8_t>(left)};
        --level;
      }
    }
    // On to the next octant of the lowest node that has one left.
    do {
      ++level;
    } while (level <= tree.level() && stack[level].left == 0);
    if (level > tree.level()) {
      return;
    }
    OpenNode& open = stack[level];
    const unsigned octant = bits::lowest_bit(open.left);
    open.left = static_cast<uint8_t>(open.left & (open.left - 1U));
    index = open.first_child + bits::popcount8(open.mask & ((1U << octant) - 1U));
    --level;
    const int32_t side = int32_t{1} << level;
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = (place[axis] & ~(2 * side - 1)) | ((octant >> axis & 1U) != 0 ? side : 0);
    }
  }
}

int slope_axis(const Vec3i& normal, const Face& face) {
  if (is_along(normal, face.axis)) {
    return -1;
  }
  int along = face.axis;
  for (int axis = 0; axis < 3; ++axis) {
    along = magnitude_32(normal[axis]) > magnitude_32(normal[along]) ? axis : along;
  }
  return along;
}

Vec3i unit_of_slope(const Vec3i& normal, const Face& face) {
  Vec3i left = normal;
  if (face.negative ? left[face.axis] > 0 : left[face.axis] < 0) {
    left[face.axis] = 0;  // a face within a slope that leans the other way
  }
  if (is_along(left, face.axis)) {
    left = {};
    left[face.axis] = face.negative ? -kUnitQ14 : kUnitQ14;
    return left;
  }
  // `unit_q14` takes 20 bits.
  const int excess =
      bits::bit_length(magnitude_32(left.x) | magnitude_32(left.y) | magnitude_32(left.z)) - 20;
  for (int axis = 0; axis < 3 && excess > 0; ++axis) {
    const auto shifted = static_cast<int32_t>(magnitude_32(left[axis]) >> excess);
    left[axis] = left[axis] < 0 ? -shifted : shifted;
  }
  return unit_q14(left);
}

Vec3i surface_normal(const CompactTree& tree, const Body& body, const Vec3Q8& at, const Face& face,
                     uint32_t* visits) {
  Vec3i flat;
  flat[face.axis] = face.negative ? -kUnitQ14 : kUnitQ14;
  SlopeWindow window;
  Vec3i middle;
  Vec3i point;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t voxel = at[axis].floor();
    window.low[axis] = slope_window_low(voxel);
    middle[axis] = voxel - window.low[axis] - (axis == face.axis && !face.negative ? 1 : 0);
    point[axis] = (at[axis].raw - window.low[axis] * Q8::kOne) / (Q8::kOne / kSlopeUnit);
  }
  read_slope_window(tree, body, &window, visits);
  Vec3i out;
  out[face.axis] = face.negative ? -1 : 1;
  if (is_shell(window, middle, out)) {
    // Which way it lies shows only once it is a body.
    Columns(&window, middle, face.axis, !face.negative, false).follow(out);
  }
  Vec3i normal = gradient(window, point);
  const int along = slope_axis(normal, face);
  if (along < 0) {
    return flat;
  }
  Columns columns(&window, middle, along, along == face.axis ? !face.negative : normal[along] > 0, true);
  const bool wall = columns.follow(out);
  // Level all around, or itself the wall of an edge. A column before the face that is as high as the face
  // belongs to something else, such as the far side of a thin wall.
  if (along == face.axis ? columns.are_level()
                         : wall || columns.height(out[columns.side_u], out[columns.side_v]) >= 0) {
    return flat;
  }
  if (columns.changed) {
    normal = gradient(window, point);
  }
  return unit_of_slope(normal, face);
}

}  // namespace thimble::lit
