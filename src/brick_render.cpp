// Frames by bricks: from voxel to voxel through the 64-bit bricks of a map, plane by plane along the axis on
// which the rays of a tile move fastest. DESIGN.md, "Frames on a chip", derives what is used here.
//
// Everything is mirrored as in crossings.h, so that no direction has a negative component, and relative to
// the map's box: planes and cells are counted from the side at which the rays come in. Axis c is the one that
// a tile's rays move fastest on, a and b are the others. Between two planes of c a ray crosses few planes of
// a and b. For each of the two it keeps the position on the plane of c that is reached next:
//
//   rest_a = P_a - (cell_a + 1) * den       P_a = o_a * d_c + s_c * d_a, the position times den = 256 * d_c
//
// negative as long as the ray is still in its cell; adding 256 * d_a goes on to the next plane of c. When it
// becomes positive the ray crosses a plane of a before, at 0 together with, that plane of c. Which of a and b
// comes first when both do: rest_a * d_b against rest_b * d_a, since rest / d is the time that is left.
#include "thimble/brick_render.h"

#include "bits.h"

namespace thimble {
namespace {

// Cells that a ray may start outside of the box on axes a and b.
constexpr int32_t kOutsideCells = 64;
constexpr int32_t kOutsideQ8 = kOutsideCells * Q8::kOne;

// Answers that are not colours.
constexpr int32_t kMissed = -1;
constexpr int32_t kAsk = -2;  // closest_hit knows

// Bricks counted in one word, ten bits an axis: each 512 - (bricks from here to the far side). Bit 9 of one
// is set when the ray has left the box; bit 31 while it has not come into it.
constexpr uint32_t kLeft = uint32_t{1} << 9 | uint32_t{1} << 19 | uint32_t{1} << 29;
constexpr uint32_t kWaiting = uint32_t{1} << 31;

// The directory and the bricks as halfwords: they lie at even addresses.
using Half [[gnu::may_alias]] = uint16_t;

uint32_t half_at(const uint8_t* bytes, int32_t offset) {
  // Through void: compilers for small chips warn of a cast that promises an alignment.
  return *static_cast<const Half*>(static_cast<const void*>(bytes + offset));
}

// Colours that were looked up: of faces of voxels, and of faces of a material.
struct Inks {
  static constexpr uint32_t kFaces = 32;
  static constexpr uint32_t kMaterials = 16;
  static constexpr uint32_t kNone = UINT32_MAX;
  struct Seen {
    uint32_t key;
    uint32_t ink;
  };
  Seen face[kFaces];
  uint32_t material[6 * kMaterials];  // material << 24 | ink
};

struct Frame {
  const CompactTree& tree;
  const BrickMap& map;
  const Camera& camera;
  const Shading& shading;
  PixelFormat format;
  Inks* inks;
};

// All that rays of one tile have in common whose directions have the same signs.
struct Course {
  // Mirrored; on a and b kOutsideQ8 beyond.
  int32_t origin[3];
  uint32_t plane;   // distance from the origin to where the rays start, 1/256 voxel
  uint32_t behind;  // from there back to the plane of c before it, when the origin lies between two planes
  const uint8_t* directory;
  const uint8_t* bricks;
  int32_t start;      // directory offset in bytes, without a and b
  int32_t stride[3];  // in bytes
  uint32_t left;      // counts of bricks, without a and b
  uint32_t last[3];   // the voxel of a brick before the next one, in place
  int32_t step[3];    // to the next voxel, in place
  uint32_t flip[3];   // 3 where mirrored
  uint32_t first;     // the voxel that rays start in, on c
  uint32_t face[3];
  uint32_t mirrored;  // bit a: axis a is
  bool inside;        // the rays start at their origins
  bool exact_ties;    // faces entered through an edge are the voxel's
};

// Where a voxel lies in a brick: x and y as a shift of halfword z, z in bytes.
struct Place {
  uint32_t shift;
  uint32_t row;
};
template <int kAxis>
uint32_t in_place(uint32_t voxel) {
  return voxel << (kAxis == 1 ? 2 : kAxis == 2 ? 1 : 0);
}
template <int kAxis>
uint32_t& part(Place& place) {
  return kAxis == 2 ? place.row : place.shift;
}
template <int kAxis>
constexpr uint32_t kField = kAxis == 0   ? 3U
                            : kAxis == 1 ? 12U
                                         : 6U;

uint32_t ink_of(PixelFormat format, Rgb8 color) {
  switch (format) {
    case PixelFormat::kGray4:
      return ((gray_of(color) + 8U) * 241U) >> 12;
    case PixelFormat::kMono1:
    case PixelFormat::kGray8:
      return gray_of(color);
    case PixelFormat::kRgb565:
    case PixelFormat::kRgb888:
      break;
  }
  return static_cast<uint32_t>(color.r) | static_cast<uint32_t>(color.g) << 8 |
         static_cast<uint32_t>(color.b) << 16;
}

void store_ink(uint8_t* line, int32_t x, int32_t y, PixelFormat format, uint32_t ink) {
  const uint8_t low = static_cast<uint8_t>(ink);
  switch (format) {
    case PixelFormat::kGray4:
      line[x >> 1] = static_cast<uint8_t>(line[x >> 1] | low << ((x & 1) != 0 ? 0 : 4));
      return;
    case PixelFormat::kGray8:
      line[x] = low;
      return;
    case PixelFormat::kMono1:
      store_pixel(line, x, y, format, {low, low, low});
      return;
    case PixelFormat::kRgb565:
    case PixelFormat::kRgb888:
      store_pixel(line, x, y, format, {low, static_cast<uint8_t>(ink >> 8), static_cast<uint8_t>(ink >> 16)});
      return;
  }
}

struct Found {
  uint32_t brick;  // number
  uint32_t bit;
  uint32_t axis;
  uint32_t t_numerator;
  uint32_t direction;  // on that axis
};

// The colour of a face that is not among those seen lately.
[[gnu::noinline]] int32_t look_up(const Frame& frame, const Course& course, const Found& found) {
  Hit hit;
  hit.kind = HitKind::kHit;
  hit.axis = static_cast<int8_t>(found.axis);
  const bool positive = (course.mirrored >> found.axis & 1U) == 0;
  hit.material = frame.map.material(frame.tree, found.brick, found.bit);
  Ray ray;
  ray.direction[static_cast<int>(found.axis)] = positive ? 1 : -1;
  if (frame.shading.mode == ShadeMode::kDepth) {
    hit.t_numerator = static_cast<int32_t>(found.t_numerator);
    hit.t_denominator = static_cast<int32_t>(found.direction) * Q8::kOne;
    return static_cast<int32_t>(ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)));
  }
  const uint32_t face = course.face[found.axis];
  uint32_t& kept = frame.inks->material[face * Inks::kMaterials + hit.material % Inks::kMaterials];
  if (kept >> 24 != hit.material || kept == Inks::kNone) {
    kept = ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)) |
           static_cast<uint32_t>(hit.material) << 24;
  }
  const uint32_t ink = kept & 0xFFFFFFU;
  const uint32_t key = (found.brick << 6 | found.bit) << 3 | face;
  frame.inks->face[(found.bit ^ face << 2) % Inks::kFaces] = {key, ink};
  return static_cast<int32_t>(ink);
}

// One ray of direction (d_a, d_b, d_c), mirrored.
template <int kC>
[[gnu::noinline]] int32_t trace_one(const Frame& frame, const Course& course, uint32_t d_a, uint32_t d_b,
                                    uint32_t d_c) {
  constexpr int kA = kC == 0 ? 1 : 0;
  constexpr int kB = kC == 2 ? 1 : 2;
  const uint32_t den = d_c << 8;
  const int32_t at_a =
      course.origin[kA] * static_cast<int32_t>(d_c) + static_cast<int32_t>(course.plane * d_a);
  const int32_t at_b =
      course.origin[kB] * static_cast<int32_t>(d_c) + static_cast<int32_t>(course.plane * d_b);
  if ((at_a | at_b) < 0) {
    return kAsk;
  }
  const uint32_t cell_a = static_cast<uint32_t>(at_a) / den;
  const uint32_t cell_b = static_cast<uint32_t>(at_b) / den;
  if ((cell_a | cell_b) >= 1024) {
    return kMissed;
  }
  int32_t rest_a =
      static_cast<int32_t>(static_cast<uint32_t>(at_a) - (cell_a + 1) * den - course.behind * d_a);
  int32_t rest_b =
      static_cast<int32_t>(static_cast<uint32_t>(at_b) - (cell_b + 1) * den - course.behind * d_b);
  const int32_t go_a = static_cast<int32_t>(d_a << 8);
  const int32_t go_b = static_cast<int32_t>(d_b << 8);

  uint32_t left = course.left + ((cell_a >> 2) << 10 * kA) + ((cell_b >> 2) << 10 * kB);
  left |= ((cell_a - kOutsideCells) | (cell_b - kOutsideCells)) & kWaiting;
  int32_t cell = course.start + static_cast<int32_t>(cell_a >> 2) * course.stride[kA] +
                 static_cast<int32_t>(cell_b >> 2) * course.stride[kB];
  Place place{0, 0};
  part<kA>(place) |= in_place<kA>((cell_a & 3U) ^ course.flip[kA]);
  part<kB>(place) |= in_place<kB>((cell_b & 3U) ^ course.flip[kB]);
  part<kC>(place) |= course.first;
  uint32_t brick = 0;  // offset of the brick

  // The brick at `cell`; false when the ray has left the box.
  const auto enter = [&]() {
    if ((left & (kLeft | kWaiting)) != 0) [[unlikely]] {
      if ((left & kLeft) != 0) {
        return false;
      }
      // 512 - bricks from the near side: below it the ray waits.
      const VoxelBox& box = frame.map.box();
      const uint32_t from_a = 512U - static_cast<uint32_t>(box.max[kA] - box.min[kA]);
      const uint32_t from_b = 512U - static_cast<uint32_t>(box.max[kB] - box.min[kB]);
      if ((left >> 10 * kA & 0x3FFU) < from_a || (left >> 10 * kB & 0x3FFU) < from_b) {
        brick = 0;
        return true;
      }
      left &= ~kWaiting;
    }
    brick = half_at(course.directory, cell) * 8;
    return true;
  };
  const auto step = [&]<int kAxis>() {
    uint32_t& own = part<kAxis>(place);
    if ((own & kField<kAxis>) == course.last[kAxis]) {
      own ^= kField<kAxis>;
      left += uint32_t{1} << 10 * kAxis;
      cell += course.stride[kAxis];
      return enter();
    }
    own += static_cast<uint32_t>(course.step[kAxis]);
    return true;
  };
  const auto solid = [&]() {
    return (half_at(course.bricks, static_cast<int32_t>(brick + place.row)) >> place.shift & 1U) != 0;
  };
  int axis = kC;

  if (!enter()) {
    return kMissed;
  }
  if (solid()) {
    if (course.inside) {
      return kAsk;
    }
  } else {
    for (;;) {
      rest_a += go_a;
      rest_b += go_b;
      while (rest_a >= 0 || rest_b >= 0) {
        bool a = rest_a >= 0;
        bool b = rest_b >= 0;
        if (a && b) {
          const uint32_t time_a = static_cast<uint32_t>(rest_a) * d_b;
          const uint32_t time_b = static_cast<uint32_t>(rest_b) * d_a;
          a = time_a >= time_b;
          b = time_b >= time_a;
        }
        // At 0 the plane is crossed together with that of c: no time is spent in between.
        const bool visit = (a ? rest_a : rest_b) != 0;
        if (a) {
          rest_a -= static_cast<int32_t>(den);
          if (!step.template operator()<kA>()) {
            return kMissed;
          }
        }
        if (b) {
          rest_b -= static_cast<int32_t>(den);
          if (!step.template operator()<kB>()) {
            return kMissed;
          }
        }
        if (visit && solid()) {
          axis = a ? kA : kB;
          if (a && b && !course.exact_ties) {
            return kAsk;
          }
          goto hit;
        }
      }
      if (!step.template operator()<kC>()) {
        return kMissed;
      }
      if (solid()) {
        break;
      }
    }
  }
  // Entered by a plane of c, and perhaps by others at the same t: the lowest axis counts.
  {
    const bool a = rest_a == -static_cast<int32_t>(den) && d_a != 0;
    const bool b = rest_b == -static_cast<int32_t>(den) && d_b != 0;
    if (a || b) [[unlikely]] {
      if (!course.exact_ties) {
        return kAsk;
      }
      if (kA < kC && a) {
        axis = kA;
      } else if (kB < kC && b) {
        axis = kB;
      }
    }
  }
hit:
  const uint32_t bit = place.shift + place.row * 8;
  const uint32_t face = course.face[axis];
  const Inks::Seen& seen = frame.inks->face[(bit ^ face << 2) % Inks::kFaces];
  if (seen.key == ((brick << 3 | bit) << 3 | face)) {
    return static_cast<int32_t>(seen.ink);
  }
  Found found{brick >> 3, bit, static_cast<uint32_t>(axis), 0, axis == kA ? d_a : axis == kB ? d_b : d_c};
  if (frame.shading.mode == ShadeMode::kDepth) {
    const VoxelBox& box = frame.map.box();
    const uint32_t bricks =
        (left >> 10 * axis & 0x3FFU) - (512U - static_cast<uint32_t>(box.max[axis] - box.min[axis]));
    const uint32_t voxel = (axis == 0 ? bit : axis == 1 ? bit >> 2 : bit >> 4) & 3U;
    const uint32_t mirrored = voxel ^ course.flip[axis];
    const int32_t origin = course.origin[axis] - (axis == kC ? 0 : kOutsideQ8);
    found.t_numerator = (4 * bricks + mirrored) * Q8::kOne - static_cast<uint32_t>(origin);
  }
  return look_up(frame, course, found);
}

// The directions of a tile: for each axis the least and the greatest.
struct Fan {
  Vec3i low;
  Vec3i high;
};

// Axis `axis` of the tile is the fastest, rays start in the slab of bricks `slab` along it.
void set_course(Course& course, const Frame& frame, unsigned mirrored, int c, int32_t slab) {
  const VoxelBox& box = frame.map.box();
  const Vec3i side{box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z};
  course.directory = frame.map.directory();
  course.bricks = frame.map.bricks();
  course.mirrored = mirrored;
  course.exact_ties = !frame.tree.merged();
  course.start = 0;
  course.left = 0;
  int32_t stride = 2;
  for (int axis = 0; axis < 3; ++axis) {
    const bool flipped = (mirrored >> axis & 1U) != 0;
    const int32_t origin = frame.camera.eye()[axis].raw;
    const int32_t near_q8 = (flipped ? box.max[axis] : box.min[axis]) * (4 * Q8::kOne);
    course.origin[axis] = (flipped ? near_q8 - origin : origin - near_q8) + (axis == c ? 0 : kOutsideQ8);
    course.stride[axis] = flipped ? -stride : stride;
    const int32_t base = flipped ? (side[axis] - 1) * stride : 0;
    const int32_t from = axis == c ? slab : -kOutsideCells / 4;
    course.start += base + course.stride[axis] * from;
    course.left += static_cast<uint32_t>(512 - side[axis] + from) << 10 * axis;
    course.flip[axis] = flipped ? 3 : 0;
    const int shift = axis == 1 ? 2 : axis == 2 ? 1 : 0;
    course.last[axis] = (flipped ? 0U : 3U) << shift;
    course.step[axis] = (flipped ? -1 : 1) * (1 << shift);
    course.face[axis] = static_cast<uint32_t>(2 * axis) + (flipped ? 1U : 0U);
    stride *= side[axis];
  }
  const int32_t distance = slab * (4 * Q8::kOne) - course.origin[c];
  uint32_t first = 0;
  course.plane = 0;
  course.behind = 0;
  course.inside = distance <= 0;
  if (distance > 0) {
    course.plane = static_cast<uint32_t>(distance);
  } else {
    first = static_cast<uint32_t>(-distance) >> 8;
    course.behind = static_cast<uint32_t>(-distance) & 255U;
  }
  course.first = (first ^ course.flip[c]) << (c == 1 ? 2 : c == 2 ? 1 : 0);
}

// Slopes of the beam in 1/1024.
constexpr int kSlopeBits = 10;

// The first slab of bricks along c in which a ray of `fan` may meet something, or the number of slabs when
// there is none. `course` has a start at slab 0.
int32_t first_slab(const Frame& frame, const Course& course, const Fan& fan, int c) {
  const VoxelBox& box = frame.map.box();
  const int32_t slabs = box.max[c] - box.min[c];
  const int32_t first = course.origin[c] < 0 ? 0 : course.origin[c] >> 10;
  if (first >= slabs) {
    return slabs;
  }
  const int a = c == 0 ? 1 : 0;
  const int b = c == 2 ? 1 : 2;
  int32_t low_slope[2];
  int32_t high_slope[2];
  int32_t origin[2];
  int32_t side[2];
  int32_t stride[2];
  const bool flipped = (course.mirrored >> c & 1U) != 0;
  const int32_t c_low = flipped ? -fan.high[c] : fan.low[c];
  const int32_t c_high = flipped ? -fan.low[c] : fan.high[c];
  for (int i = 0; i < 2; ++i) {
    const int axis = i == 0 ? a : b;
    const bool mirrored = (course.mirrored >> axis & 1U) != 0;
    const int32_t low = (mirrored ? -fan.high[axis] : fan.low[axis]) * (1 << kSlopeBits);
    const int32_t high = (mirrored ? -fan.low[axis] : fan.high[axis]) * (1 << kSlopeBits);
    low_slope[i] = low / (low < 0 ? c_low : c_high) - 1;
    high_slope[i] = high / (high < 0 ? c_high : c_low) + 1;
    if (low_slope[i] < -(2 << kSlopeBits) || high_slope[i] > 2 << kSlopeBits) {
      return first;
    }
    origin[i] = course.origin[axis] - kOutsideQ8;
    side[i] = box.max[axis] - box.min[axis];
    stride[i] = course.stride[axis];
  }
  int32_t row = course.start + kOutsideCells / 4 * (stride[0] + stride[1]);
  row += course.stride[c] * first;
  int32_t far_q8 = first * (4 * Q8::kOne) - course.origin[c];
  for (int32_t slab = first; slab < slabs; ++slab, row += course.stride[c]) {
    const int32_t near_q8 = far_q8 > 0 ? far_q8 : 0;
    far_q8 += 4 * Q8::kOne;
    int32_t from[2];
    int32_t to[2];
    for (int i = 0; i < 2; ++i) {
      const int32_t low =
          origin[i] + (((low_slope[i] < 0 ? far_q8 : near_q8) * low_slope[i]) >> kSlopeBits) - 1;
      const int32_t high =
          origin[i] + (((high_slope[i] < 0 ? near_q8 : far_q8) * high_slope[i]) >> kSlopeBits) + 1;
      from[i] = low < 0 ? 0 : low >> 10;
      to[i] = high >> 10 < side[i] ? high >> 10 : side[i] - 1;
    }
    for (int32_t j = from[1]; j <= to[1]; ++j) {
      for (int32_t i = from[0]; i <= to[0]; ++i) {
        if (half_at(course.directory, row + i * stride[0] + j * stride[1]) != 0) {
          return slab;
        }
      }
    }
  }
  return slabs;
}

int32_t trace_along(const Frame& frame, const Course& course, int c, const Vec3i& d) {
  const auto size = [](int32_t value) { return static_cast<uint32_t>(value < 0 ? -value : value); };
  const uint32_t x = size(d.x);
  const uint32_t y = size(d.y);
  const uint32_t z = size(d.z);
  return c == 0   ? trace_one<0>(frame, course, y, z, x)
         : c == 1 ? trace_one<1>(frame, course, x, z, y)
                  : trace_one<2>(frame, course, x, y, z);
}

struct Tile {
  int32_t x0;
  int32_t x1;
  int32_t y0;
  int32_t y1;
};

// The picture's affine function over whole tiles.
struct Span8 {
  Camera::Vec3Q32 low;
  Camera::Vec3Q32 high;
};

int32_t ask(const Frame& frame, int32_t x, int32_t y, RenderCounts* counts) {
  const Ray ray = frame.camera.ray(x, y);
  Hit hit;
  if (closest_hit(frame.tree, ray, &hit) != Status::kOk) {
    return kMissed;
  }
  counts->node_visits += hit.visits;
  if (hit.kind != HitKind::kHit) {
    return kMissed;
  }
  return static_cast<int32_t>(ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)));
}

unsigned signs_of(const Vec3i& d) {
  return (d.x < 0 ? 1U : 0U) | (d.y < 0 ? 2U : 0U) | (d.z < 0 ? 4U : 0U);
}

void draw_tile(const Frame& frame, const Tile& tile, const Span8& span, uint8_t* first_line, size_t stride,
               uint32_t background, RenderCounts* counts) {
  const Camera::Affine& affine = frame.camera.affine();
  Camera::Vec3Q32 value;
  Fan fan;
  int c = 0;
  int32_t most = -1;
  unsigned mirrored = 0;
  unsigned mixed = 0;
  for (int axis = 0; axis < 3; ++axis) {
    value[axis] = affine.base[axis] + tile.x0 * affine.step_x[axis] + tile.y0 * affine.step_y[axis];
    fan.low[axis] = Camera::round(value[axis] + span.low[axis]);
    fan.high[axis] = Camera::round(value[axis] + span.high[axis]);
    const int32_t sum = fan.low[axis] + fan.high[axis];
    const int32_t size = sum < 0 ? -sum : sum;
    if (size > most) {
      most = size;
      c = axis;
    }
    mirrored |= sum < 0 ? 1U << axis : 0U;
    mixed |= (sum < 0 ? fan.high[axis] >= 0 : fan.low[axis] < 0) ? 1U << axis : 0U;
  }
  Course course;
  const bool usable = (mixed >> c & 1U) == 0 && fan.low[c] != 0;
  int32_t slab = 0;
  bool missed = frame.map.empty();
  if (usable && !missed) {
    set_course(course, frame, mirrored, c, 0);
    slab = first_slab(frame, course, fan, c);
    missed = slab == frame.map.box().max[c] - frame.map.box().min[c];
    if (!missed) {
      set_course(course, frame, mirrored, c, slab);
    }
  }
  uint8_t* line = first_line;
  for (int32_t y = tile.y0; y < tile.y1; ++y, line += stride) {
    Camera::Vec3Q32 at = value;
    for (int32_t x = tile.x0; x < tile.x1; ++x) {
      int32_t ink = kMissed;
      if (!missed) {
        const Vec3i d{Camera::round(at.x), Camera::round(at.y), Camera::round(at.z)};
        ink = kAsk;
        if (usable) {
          const unsigned signs = signs_of(d);
          if (signs != course.mirrored) {
            set_course(course, frame, signs, c, slab);
          }
          ink = trace_along(frame, course, c, d);
        }
        if (ink == kAsk) {
          ink = ask(frame, x, y, counts);
        }
      }
      if (ink < 0) {
        ink = static_cast<int32_t>(background);
      } else {
        ++counts->hits;
      }
      store_ink(line, x, y, frame.format, static_cast<uint32_t>(ink));
      for (int axis = 0; axis < 3; ++axis) {
        at[axis] += affine.step_x[axis];
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      value[axis] += affine.step_y[axis];
    }
  }
}

}  // namespace

bool draws_fast(const BrickMap& map, const Camera& camera) {
  if (!camera.is_perspective() || camera.width_px() == 0 || camera.level() != map.level() ||
      camera.direction_bits() > kMaxBrickDirectionBits) {
    return false;
  }
  // The products of distances, measured from up to kOutsideCells beyond the box, and directions; two are
  // added.
  uint32_t distances = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t from_low = camera.eye()[axis].raw - map.box().min[axis] * (4 * Q8::kOne);
    const int32_t from_high = map.box().max[axis] * (4 * Q8::kOne) - camera.eye()[axis].raw;
    distances |= static_cast<uint32_t>((from_low < 0 ? -from_low : from_low) + kOutsideQ8);
    distances |= static_cast<uint32_t>((from_high < 0 ? -from_high : from_high) + kOutsideQ8);
  }
  return bits::bit_length(distances) + camera.direction_bits() <= 30;
}

Status render_band(const CompactTree& tree, const BrickMap& map, const Camera& camera, const Shading& shading,
                   const Band& band, RenderCounts* counts) {
  if (!map.belongs_to(tree)) {
    return Status::kDamaged;
  }
  if (!draws_fast(map, camera)) {
    return render_band(tree, camera, shading, band, counts);
  }
  const int32_t width = camera.width_px();
  if (band.first_row < 0 || band.rows < 0 || band.rows > camera.height_px() - band.first_row) {
    return Status::kBadArgument;
  }
  const size_t line_bytes = row_bytes(band.format, width);
  const size_t stride = band.stride_bytes == 0 ? line_bytes : band.stride_bytes;
  if (stride < line_bytes) {
    return Status::kBadArgument;
  }
  if (band.rows == 0) {
    return Status::kOk;
  }
  const size_t rows_above = static_cast<size_t>(band.rows) - 1;
  if (line_bytes > band.pixels.size || rows_above > (band.pixels.size - line_bytes) / stride) {
    return Status::kOutOfMemory;
  }
  Inks inks;
  for (Inks::Seen& seen : inks.face) {
    seen.key = Inks::kNone;
  }
  for (uint32_t& ink : inks.material) {
    ink = Inks::kNone;
  }
  const Frame frame{tree, map, camera, shading, band.format, &inks};
  const uint32_t background = ink_of(band.format, shade(Hit{}, Ray{}, camera, shading));
  Span8 span;
  const Camera::Affine& affine = camera.affine();
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t across = affine.step_x[axis] * (kBrickTilePx - 1);
    const int64_t down = affine.step_y[axis] * (kBrickTilePx - 1);
    span.low[axis] = (across < 0 ? across : 0) + (down < 0 ? down : 0);
    span.high[axis] = (across < 0 ? 0 : across) + (down < 0 ? 0 : down);
  }
  RenderCounts done;
  const int32_t end = band.first_row + band.rows;
  for (int32_t y = band.first_row; y < end;) {
    const int32_t tile_end = (y / kBrickTilePx + 1) * kBrickTilePx;
    const int32_t y1 = tile_end < end ? tile_end : end;
    uint8_t* line = band.pixels.data + stride * static_cast<size_t>(y - band.first_row);
    for (int32_t row = y; row < y1; ++row) {
      for (size_t i = 0; i < line_bytes; ++i) {
        line[stride * static_cast<size_t>(row - y) + i] = 0;
      }
    }
    for (int32_t x = 0; x < width; x += kBrickTilePx) {
      const int32_t x1 = x + kBrickTilePx < width ? x + kBrickTilePx : width;
      draw_tile(frame, {x, x1, y, y1}, span, line, stride, background, &done);
    }
    y = y1;
  }
  if (counts != nullptr) {
    counts->rays += static_cast<uint64_t>(static_cast<uint32_t>(width)) * static_cast<uint32_t>(band.rows);
    counts->hits += done.hits;
    counts->node_visits += done.node_visits;
  }
  return Status::kOk;
}

}  // namespace thimble
