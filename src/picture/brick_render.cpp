// Frames by bricks: from voxel to voxel through the 64-bit bricks of a map, plane by plane along the axis on
// which the rays of a tile move fastest. src/picture/README.md derives what is used here.
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
#include "thimble/picture/brick_render.h"

#include "../base/bits.h"
#include "../base/likely.h"

// Whatever the rest is compiled for, this file is for speed. (gcc has these on a function's or a file's wish;
// the second saves one instruction in a hundred.)
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O2", "rename-registers")
#endif

namespace thimble {
namespace {

// Cells that a ray may start outside of the box on axes a and b.
constexpr int32_t kOutsideCells = 64;
constexpr int32_t kOutsideQ8 = kOutsideCells * Q8::kOne;

// Answers that are not colours.
constexpr int32_t kMissed = -1;
constexpr int32_t kAsk = -2;  // closest_hit knows

// Bricks counted in one word, ten bits an axis: each 512 - (bricks from here to the far side). Bit 9 of one
// is set when the ray has left the box; bit 31 while it may not have come into it; bit 30 while it is in the
// slab of voxels that it starts in.
constexpr uint32_t kLeft = uint32_t{1} << 9 | uint32_t{1} << 19 | uint32_t{1} << 29;
constexpr uint32_t kWaiting = uint32_t{1} << 31;
constexpr uint32_t kInside = uint32_t{1} << 30;
constexpr uint32_t kSpecial = kLeft | kWaiting | kInside;

// The directory and the bricks as halfwords and words: they lie at multiples of 4.
using Half [[gnu::may_alias]] = uint16_t;

uint32_t half_at(const uint8_t* bytes, int32_t offset) {
  // Through void: compilers for small chips warn of a cast that promises an alignment.
  return *static_cast<const Half*>(static_cast<const void*>(bytes + offset));
}

using Word [[gnu::may_alias]] = uint32_t;
uint32_t word_at(const uint8_t* bytes, int32_t offset) {
  return *static_cast<const Word*>(static_cast<const void*>(bytes + offset));
}

// Colours that were looked up: of faces of voxels, and of faces of a material.
struct Inks {
  static constexpr uint32_t kFaces = 64;
  static constexpr uint32_t kMaterials = 16;
  static constexpr uint32_t kNone = UINT32_MAX;
  struct Seen {
    uint32_t key;
    uint32_t ink;
  };
  Seen face[kFaces];
  uint32_t material[6 * kMaterials];  // material << 24 | ink
  uint32_t near_cell[2];              // where the last ray started, on a and b

  static uint32_t slot(uint32_t key) { return (key ^ key >> 6) % kFaces; }
};

// What all pixels of a band share.
struct Frame {
  const CompactTree& tree;
  const BrickMap& map;
  const Camera& camera;
  const Shading& shading;
  PixelFormat format;
  uint32_t background;
  Vec3i side;    // of the box, in bricks
  Vec3i stride;  // of the directory, in bytes
  Vec3i eye;     // from the box's lowest corner, in 1/256 voxel
  // From a tile's first pixel to the least and greatest of the affine function in whole tiles.
  Vec3i tile_low;
  Vec3i tile_high;
  Vec3i quad_low;
  Vec3i quad_high;
};

// All that rays have in common whose directions have the same signs and the same fastest axis; where they
// start changes from tile to tile.
struct Course {
  const Frame* frame;
  Inks* inks;
  // Mirrored; on a and b kOutsideQ8 beyond.
  int32_t origin[3];
  const uint8_t* directory;
  const uint8_t* bricks;
  int32_t stride[3];      // of the directory in bytes
  int32_t next_brick[3];  // the same, so that the compiler does not keep it in hand from the first use to the
                          // last
  uint32_t last[3];       // the voxel of a brick before the next brick, in place
  int32_t step[3];        // to the next voxel, in place
  uint32_t flip[3];       // 3 where mirrored
  uint32_t face[3];
  int32_t base;        // of the directory, in bytes, for slab 0
  uint32_t base_left;  // counts of bricks, for slab 0
  int c;               // the fastest axis
  unsigned mirrored;   // bit a: axis a is
  bool exact_ties;     // faces entered through an edge are the voxel's
  // Where the rays start.
  uint32_t waiting;  // kWaiting where they may start outside of the box
  uint32_t plane;    // distance from the origin, 1/256 voxel
  uint32_t behind;   // from there back to the plane of c before it, when the origin lies between two planes
  uint32_t first;    // the voxel on c, in place
  int32_t start;     // of the directory, without a and b
  uint32_t left;     // counts of bricks, without a and b
  // The affine function, mirrored.
  Camera::Vec3Q32 step_x;
  Camera::Vec3Q32 step_y;
};

// The layer of a voxel in its brick, from the address of its halfword: bricks lie at multiples of 8.
uint32_t row_of(const uint8_t* at) {
  return static_cast<uint32_t>(reinterpret_cast<size_t>(at)) & 6U;
}

// How far the voxel's place on an axis is shifted, see trace_one.
constexpr int kPlaceShift[3] = {0, 2, 1};
template <int kAxis>
constexpr uint32_t kField = 3U << kPlaceShift[kAxis];

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

#if defined(__arm__) && !defined(__ARM_FEATURE_IDIV)
constexpr bool kDivides = false;
#else
constexpr bool kDivides = true;
#endif

// dividend / divisor, both below 2^31, for a core without a divider: from the last quotient, from which that
// of a neighbouring ray is a step or two away.
uint32_t quotient(uint32_t dividend, uint32_t divisor, uint32_t* last) {
  uint32_t result = *last;
  int32_t rest = static_cast<int32_t>(dividend - result * divisor);
  for (int step = 0;; ++step) {
    if (step == 6) {
      result = dividend / divisor;
      break;
    }
    if (rest < 0) {
      rest += static_cast<int32_t>(divisor);
      --result;
    } else if (rest >= static_cast<int32_t>(divisor)) {
      rest -= static_cast<int32_t>(divisor);
      ++result;
    } else {
      break;
    }
  }
  // Kept small, so that the next product stays below 2^31.
  *last = result & 1023U;
  return result;
}

// The hit of a face of `material`, with what `shade` looks at; its ray is `ray`.
Hit face_hit(const Course& course, int axis, uint8_t material, Ray* ray) {
  Hit hit;
  hit.kind = HitKind::kHit;
  hit.axis = static_cast<int8_t>(axis);
  hit.material = material;
  ray->direction[axis] = (course.mirrored >> axis & 1U) == 0 ? 1 : -1;
  return hit;
}

// The colour at a distance: of voxel `bit` of the brick that `left` counts, entered on `axis`.
[[gnu::noinline]] int32_t depth_ink(const Course& course, int axis, uint32_t left, uint32_t bit,
                                    uint32_t direction) {
  const int32_t bricks = static_cast<int32_t>(left >> 10 * axis & 0x3FFU) - (512 - course.frame->side[axis]);
  const uint32_t voxel = (axis == 0 ? bit : axis == 1 ? bit >> 2 : bit >> 4) & 3U;
  const int32_t origin = course.origin[axis] - (axis == course.c ? 0 : kOutsideQ8);
  const int32_t distance = (4 * bricks + static_cast<int32_t>(voxel ^ course.flip[axis])) * Q8::kOne - origin;
  const Frame& frame = *course.frame;
  Ray ray;
  Hit hit = face_hit(course, axis, 0, &ray);
  hit.t_numerator = distance;
  hit.t_denominator = static_cast<int32_t>(direction) * Q8::kOne;
  return static_cast<int32_t>(ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)));
}

[[gnu::noinline]] uint32_t material_ink(const Course& course, int axis, uint8_t material) {
  const Frame& frame = *course.frame;
  Ray ray;
  const Hit hit = face_hit(course, axis, material, &ray);
  return ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)) | static_cast<uint32_t>(material)
                                                                                  << 24;
}

// The colour of a face that is not among those seen lately.
[[gnu::noinline]] int32_t look_up(const Course& course, uint32_t number, uint32_t bit, int axis) {
  const Frame& frame = *course.frame;
  const uint8_t material = frame.map.material(frame.tree, number, bit);
  const uint32_t face = course.face[axis];
  uint32_t& kept = course.inks->material[face * Inks::kMaterials + material % Inks::kMaterials];
  if (kept >> 24 != material || kept == Inks::kNone) {
    kept = material_ink(course, axis, material);
  }
  const uint32_t ink = kept & 0xFFFFFFU;
  const uint32_t key = (number << 6 | bit) << 3 | face;
  course.inks->face[Inks::slot(key)] = {key, ink};
  return static_cast<int32_t>(ink);
}

// An axis as an argument that is known when compiling.
template <int kOf>
struct Along {
  static constexpr int kAxis = kOf;
};

// One ray of direction (d_a, d_b, d_c), mirrored on the axes of kMirrored.
template <int kC, unsigned kMirrored>
[[gnu::noinline]] int32_t trace_one(const Course& course, uint32_t d_a, uint32_t d_b, uint32_t d_c) {
  constexpr int kA = kC == 0 ? 1 : 0;
  constexpr int kB = kC == 2 ? 1 : 2;
  constexpr auto kFlip = [](int axis) { return (kMirrored >> axis & 1U) != 0 ? 3U : 0U; };
  const uint32_t den = d_c << 8;
  const uint32_t at_a = static_cast<uint32_t>(course.origin[kA]) * d_c + course.plane * d_a;
  const uint32_t at_b = static_cast<uint32_t>(course.origin[kB]) * d_c + course.plane * d_b;
  if (!kDivides && static_cast<int32_t>(at_a | at_b) < 0) {
    THIMBLE_UNLIKELY;
    return kAsk;
  }
  const uint32_t cell_a = kDivides ? at_a / den : quotient(at_a, den, &course.inks->near_cell[0]);
  const uint32_t cell_b = kDivides ? at_b / den : quotient(at_b, den, &course.inks->near_cell[1]);
  if ((cell_a | cell_b) >= 1024) {
    THIMBLE_UNLIKELY;
    return static_cast<int32_t>(at_a | at_b) < 0 ? kAsk : kMissed;
  }
  uint32_t rest_a = at_a - (cell_a + 1) * den;
  uint32_t rest_b = at_b - (cell_b + 1) * den;
  const uint32_t go_a = d_a << 8;
  const uint32_t go_b = d_b << 8;

  uint32_t left = course.left + ((cell_a >> 2) << 10 * kA) + ((cell_b >> 2) << 10 * kB);
  int32_t cell = course.start + static_cast<int32_t>(cell_a >> 2) * course.stride[kA] +
                 static_cast<int32_t>(cell_b >> 2) * course.stride[kB];
  const uint32_t in_a = ((cell_a & 3U) ^ kFlip(kA)) << kPlaceShift[kA];
  const uint32_t in_b = ((cell_b & 3U) ^ kFlip(kB)) << kPlaceShift[kB];
  // Where the voxel lies: x and y as a shift of a halfword; z in the address of the halfword, bricks being at
  // multiples of 8.
  uint32_t shift = in_a | (kB == 2 ? course.first : in_b);
  const uint8_t* at = course.bricks + (kB == 2 ? in_b : course.first);
  int axis = kC;

  const auto negative = [](uint32_t value) { return static_cast<int32_t>(value) < 0; };
  const auto solid = [&]() { return (half_at(at, 0) >> shift & 1U) != 0; };
  // To the next voxel; whether it is in the next brick.
  const auto step = [&](auto along) {
    constexpr int kAxis = decltype(along)::kAxis;
    constexpr int32_t kStep = ((kMirrored >> kAxis & 1U) != 0 ? -1 : 1) * (1 << kPlaceShift[kAxis]);
    const uint32_t own = kAxis == 2 ? row_of(at) : shift & kField<kAxis>;
    if (own == ((kMirrored >> kAxis & 1U) != 0 ? 0U : kField<kAxis>)) {
      if (kAxis == 2) {
        at += 6 - 2 * static_cast<int32_t>(own);
      } else {
        shift ^= kField<kAxis>;
      }
      left += uint32_t{1} << 10 * kAxis;
      cell += course.next_brick[kAxis];
      return true;
    }
    if (kAxis == 2) {
      at += kStep;
    } else {
      shift += static_cast<uint32_t>(kStep);
    }
    return false;
  };

enter:  // a brick, by a plane of `axis`
  if ((left & kSpecial) != 0) {
    THIMBLE_UNLIKELY;
    if ((left & kLeft) != 0) {
      return kMissed;
    }
    if ((left & kInside) != 0) {
      rest_a -= course.behind * d_a;
      rest_b -= course.behind * d_b;
    }
    // 512 - bricks is the near side: below it the ray waits.
    const Vec3i& side = course.frame->side;
    uint32_t number = 0;
    if ((left & kWaiting) == 0 || ((left >> 10 * kA & 0x3FFU) >= 512U - static_cast<uint32_t>(side[kA]) &&
                                   (left >> 10 * kB & 0x3FFU) >= 512U - static_cast<uint32_t>(side[kB]))) {
      left &= ~kWaiting;
      number = half_at(course.directory, cell);
    }
    at = course.bricks + 8 * number + row_of(at);
    if ((left & kInside) != 0 && solid()) {
      return kAsk;
    }
    left &= ~kInside;
    goto entered;
  }
  at = course.bricks + 8 * half_at(course.directory, cell) + row_of(at);
entered:
  if (solid()) {
    goto hit;
  }
  if (axis != kC) {
    goto between;
  }
slab:  // from plane to plane of c
  rest_a += go_a;
  rest_b += go_b;
between:
  if (!negative(rest_a & rest_b)) {
    if (static_cast<int32_t>(rest_a) > 0) {
      if (static_cast<int32_t>(rest_b) > 0) {
        const uint32_t time_a = rest_a * d_b;
        const uint32_t time_b = rest_b * d_a;
        if (time_a < time_b) {
          goto cross_b;
        }
        if (time_a == time_b) {
          goto tie;
        }
      }
      goto cross_a;
    }
    if (static_cast<int32_t>(rest_b) > 0) {
      goto cross_b;
    }
    goto tie;
  }
  if (step(Along<kC>{})) {
    axis = kC;
    goto enter;
  }
  if (!solid()) {
    goto slab;
  }
  axis = kC;
  goto hit;
cross_a:
  rest_a -= den;
  axis = kA;
  if (step(Along<kA>{})) {
    goto enter;
  }
  if (solid()) {
    goto hit;
  }
  goto between;
cross_b:
  rest_b -= den;
  axis = kB;
  if (step(Along<kB>{})) {
    goto enter;
  }
  if (solid()) {
    goto hit;
  }
  goto between;
tie:                                 // planes crossed together: no time is spent between them
  if (rest_a == 0 || rest_b == 0) {  // with the plane of c
    if (rest_a == 0) {
      rest_a -= den;
      step(Along<kA>{});
    }
    if (rest_b == 0) {
      rest_b -= den;
      step(Along<kB>{});
    }
    step(Along<kC>{});
    axis = kC;
  } else {
    rest_a -= den;
    rest_b -= den;
    step(Along<kA>{});
    step(Along<kB>{});
    axis = kA;
    if (!course.exact_ties) {
      return kAsk;
    }
  }
  goto enter;

hit:
  // Entered by a plane of c, and perhaps by others at the same t: the lowest axis counts.
  if (axis == kC && (rest_a == 0U - den || rest_b == 0U - den)) {
    THIMBLE_UNLIKELY;
    const bool a = rest_a == 0U - den && d_a != 0;
    const bool b = rest_b == 0U - den && d_b != 0;
    if ((a || b) && !course.exact_ties) {
      return kAsk;
    }
    if (kA < kC && a) {
      axis = kA;
    } else if (kB < kC && b) {
      axis = kB;
    }
  }
  const uint32_t bit = shift + row_of(at) * 8;
  const uint32_t face = static_cast<uint32_t>(2 * axis) + (kMirrored >> axis & 1U);
  const uint32_t number = half_at(course.directory, cell);
  const uint32_t key = (number << 6 | bit) << 3 | face;
  const Inks::Seen& seen = course.inks->face[Inks::slot(key)];
  if (seen.key == key) {
    return static_cast<int32_t>(seen.ink);
  }
  if (course.frame->shading.mode != ShadeMode::kDepth) {
    return look_up(course, number, bit, axis);
  }
  return depth_ink(course, axis, left, bit, axis == kA ? d_a : axis == kB ? d_b : d_c);
}

// The directions of a tile: for each axis the least and the greatest; what rays of them have in common.
struct Fan {
  Vec3i low;
  Vec3i high;
  int c = 0;              // the fastest axis
  unsigned mirrored = 0;  // bit a: axis a is, for most
  unsigned mixed = 0;     // bit a: not for all

  // Directions from value + least to value + greatest (`margins_of`).
  Fan(const Camera::Vec3Q32& value, const Vec3i& least, const Vec3i& greatest) {
    int32_t most = -1;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t at = static_cast<int32_t>(value[axis] >> 16);
      low[axis] = (at + least[axis]) >> 16;
      high[axis] = (at + greatest[axis]) >> 16;
      const int32_t sum = low[axis] + high[axis];
      if (sum < 0) {
        mirrored |= 1U << axis;
        mixed |= high[axis] >= 0 ? 1U << axis : 0U;
      } else {
        mixed |= low[axis] < 0 ? 1U << axis : 0U;
      }
      const int32_t size = sum < 0 ? -sum : sum;
      if (size > most) {
        most = size;
        c = axis;
      }
    }
  }
  // Whether all rays go the same way along c.
  bool usable() const { return (mixed >> c & 1U) == 0 && low[c] != 0; }
};

void set_course(Course& course, unsigned mirrored, int c) {
  const Frame& frame = *course.frame;
  const VoxelBox& box = frame.map.box();
  course.c = c;
  course.mirrored = mirrored;
  course.base = 0;
  course.base_left = 0;
  int32_t stride = 2;
  const Camera::Affine& affine = frame.camera.affine();
  for (int axis = 0; axis < 3; ++axis) {
    const bool flipped = (mirrored >> axis & 1U) != 0;
    const int32_t side = frame.side[axis];
    const int32_t origin = frame.camera.eye()[axis].raw;
    const int32_t near_q8 = (flipped ? box.high[axis] : box.low[axis]) * (4 * Q8::kOne);
    course.origin[axis] = (flipped ? near_q8 - origin : origin - near_q8) + (axis == c ? 0 : kOutsideQ8);
    course.stride[axis] = flipped ? -stride : stride;
    course.next_brick[axis] = course.stride[axis];
    const int32_t from = axis == c ? 0 : -kOutsideCells / 4;
    course.base += (flipped ? (side - 1) * stride : 0) + course.stride[axis] * from;
    course.base_left += static_cast<uint32_t>(512 - side + from) << 10 * axis;
    course.flip[axis] = flipped ? 3 : 0;
    course.last[axis] = (flipped ? 0U : 3U) << kPlaceShift[axis];
    course.step[axis] = (flipped ? -1 : 1) * (1 << kPlaceShift[axis]);
    course.face[axis] = static_cast<uint32_t>(2 * axis) + (flipped ? 1U : 0U);
    course.step_x[axis] = flipped ? -affine.step_x[axis] : affine.step_x[axis];
    course.step_y[axis] = flipped ? -affine.step_y[axis] : affine.step_y[axis];
    stride *= side;
  }
}

// Rays start in the slab of voxels `slab` along c.
void set_start(Course& course, int32_t slab) {
  const int32_t distance = slab * Q8::kOne - course.origin[course.c];
  course.plane = distance > 0 ? static_cast<uint32_t>(distance) : 0;
  course.behind = distance > 0 ? 0 : static_cast<uint32_t>(-distance);
  course.first = ((static_cast<uint32_t>(slab) & 3U) ^ course.flip[course.c]) << kPlaceShift[course.c];
  course.start = course.base + course.stride[course.c] * (slab >> 2);
  course.left = (course.base_left + (static_cast<uint32_t>(slab >> 2) << 10 * course.c)) | course.waiting |
                (distance <= 0 ? kInside : 0);
}

// Slopes of a beam in 1/1024, so positions in 1/2^18 voxel.
constexpr int kSlopeBits = 10;
constexpr int kCellShift = kSlopeBits + 8;
constexpr int kBrickShift = kCellShift + 2;
// Bricks that a beam may be wide; one that is wider ends there, which is early but right.
constexpr int32_t kBeamBricks = 4;

// Where all rays of a fan are on one axis within a slab of voxels, in the box's own coordinates: from low to
// high.
struct Shadow {
  int32_t low;
  int32_t high;
  int32_t low_step;  // to the next slab
  int32_t high_step;
  int32_t low_more;  // what a further slab adds to the shadow at its lower end, at most 0
  int32_t high_more;

  void advance(int32_t voxels) {
    low += voxels * low_step;
    high += voxels * high_step;
  }
};

// Bits low .. high of the cells of a beam's bricks; high is below 4 * kBeamBricks, both may be negative.
uint32_t bits_between(int32_t low, int32_t high) {
  const int32_t from = low < 0 ? 0 : low;
  return high < from ? 0U : (2U << high) - (1U << from);
}

// Four bits as rows or as halfwords: bit y becomes bit 4 y, bit z all of halfword z.
constexpr uint16_t kRows[16] = {0x0000, 0x0001, 0x0010, 0x0011, 0x0100, 0x0101, 0x0110, 0x0111,
                                0x1000, 0x1001, 0x1010, 0x1011, 0x1100, 0x1101, 0x1110, 0x1111};
constexpr uint32_t kHalves[4] = {0, 0xFFFFU, 0xFFFF0000U, 0xFFFFFFFFU};

// A brick in the way of a beam, and where its cells begin from those of the beam's first brick on.
struct NearBrick {
  const uint8_t* bits;
  int32_t a;
  int32_t b;
};

// The first slab of voxels from `slab` on in which rays of `fan` may meet something, or the number of slabs
// when there is none. Coarse: the first of a slab of bricks. `course` is the fan's.
template <int kC, bool kCoarse>
[[gnu::noinline]] int32_t first_slab(Course& course, const Fan& fan, int32_t slab) {
  constexpr int kA = kC == 0 ? 1 : 0;
  constexpr int kB = kC == 2 ? 1 : 2;
  course.waiting = kWaiting;
  const Frame& frame = *course.frame;
  const int32_t slabs = 4 * frame.side[kC];
  const int32_t origin = course.origin[kC];
  const int32_t nearest = origin < 0 ? 0 : origin >> 8;
  slab = slab < nearest ? nearest : slab;
  if (slab >= slabs) {
    return slabs;
  }
  const bool flipped = (course.mirrored >> kC & 1U) != 0;
  const int32_t c_low = flipped ? -fan.high[kC] : fan.low[kC];
  const int32_t c_high = flipped ? -fan.low[kC] : fan.high[kC];
  // The first slab may begin behind the origin: then the bounds start from whichever is wider.
  const int32_t plane = slab * Q8::kOne - origin;
  const int32_t ahead = plane < 0 ? 0 : plane;
  const auto shadow_of = [&](int axis) {
    const int32_t low = fan.low[axis] * (1 << kSlopeBits);
    const int32_t high = fan.high[axis] * (1 << kSlopeBits);
    const int32_t low_slope = low / (low < 0 ? c_low : c_high) - 1;
    const int32_t high_slope = high / (high < 0 ? c_high : c_low) + 1;
    const int32_t from = frame.eye[axis] * (1 << kSlopeBits);
    const int32_t low_step = low_slope * Q8::kOne;
    const int32_t high_step = high_slope * Q8::kOne;
    const int32_t low_more = low_step < 0 ? low_step : 0;
    const int32_t high_more = high_step > 0 ? high_step : 0;
    return Shadow{from + (low_slope < 0 ? ahead : plane) * low_slope - 1 + low_more,
                  from + (high_slope < 0 ? plane : ahead) * high_slope + 1 + high_more,
                  low_step,
                  high_step,
                  low_more,
                  high_more};
  };
  if (fan.high[kA] > 2 * c_low || fan.low[kA] < -2 * c_low || fan.high[kB] > 2 * c_low ||
      fan.low[kB] < -2 * c_low) {
    return slab;
  }
  Shadow a = shadow_of(kA);
  Shadow b = shadow_of(kB);
  const int32_t last_a = frame.side[kA] - 1;
  const int32_t last_b = frame.side[kB] - 1;
  const int32_t stride_a = frame.stride[kA];
  const int32_t stride_b = frame.stride[kB];
  const uint8_t* directory = course.directory;
  while (slab < slabs) {
    // What of the slab of bricks is left, and the bricks that the rays may pass through there.
    const int32_t voxels = 4 - (slab & 3);
    int32_t from_a = (a.low + (voxels - 1) * a.low_more) >> kBrickShift;
    int32_t to_a = (a.high + (voxels - 1) * a.high_more) >> kBrickShift;
    int32_t from_b = (b.low + (voxels - 1) * b.low_more) >> kBrickShift;
    int32_t to_b = (b.high + (voxels - 1) * b.high_more) >> kBrickShift;
    from_a = from_a < 0 ? 0 : from_a;
    from_b = from_b < 0 ? 0 : from_b;
    if (to_a - from_a >= kBeamBricks || to_b - from_b >= kBeamBricks) {
      return slab;
    }
    to_a = to_a > last_a ? last_a : to_a;
    to_b = to_b > last_b ? last_b : to_b;
    // Those that are not empty.
    NearBrick bricks[kCoarse ? 1 : kBeamBricks * kBeamBricks];
    NearBrick* bricks_end = bricks;
    const int32_t layer = flipped ? frame.side[kC] - 1 - (slab >> 2) : slab >> 2;
    int32_t row = layer * frame.stride[kC] + from_b * stride_b + from_a * stride_a;
    for (int32_t j = from_b; j <= to_b; ++j, row += stride_b) {
      int32_t cell = row;
      for (int32_t i = from_a; i <= to_a; ++i, cell += stride_a) {
        const uint32_t number = half_at(directory, cell);
        if (number != 0) {
          if (kCoarse) {
            return slab;
          }
          *bricks_end++ = {course.bricks + 8 * number, 4 * (i - from_a), 4 * (j - from_b)};
        }
      }
    }
    if (kCoarse || bricks_end == bricks) {
      a.advance(voxels);
      b.advance(voxels);
      slab += voxels;
      continue;
    }
    // Voxel by voxel.
    const int32_t base_a = 4 * from_a;
    const int32_t base_b = 4 * from_b;
    for (const int32_t end = slab + voxels; slab < end; ++slab, a.advance(1), b.advance(1)) {
      const uint32_t cells_a = bits_between((a.low >> kCellShift) - base_a, (a.high >> kCellShift) - base_a);
      const uint32_t cells_b = bits_between((b.low >> kCellShift) - base_b, (b.high >> kCellShift) - base_b);
      const uint32_t own = (static_cast<uint32_t>(slab) & 3U) ^ course.flip[kC];
      for (const NearBrick* near = bricks; near != bricks_end; ++near) {
        const uint32_t in_a = cells_a >> near->a & 15U;
        const uint32_t in_b = cells_b >> near->b & 15U;
        uint32_t found = 0;
        if (kC == 2) {
          found = half_at(near->bits, static_cast<int32_t>(2 * own)) & (in_a * kRows[in_b]);
        } else {
          found =
              (word_at(near->bits, 0) & kHalves[in_b & 3U]) | (word_at(near->bits, 4) & kHalves[in_b >> 2]);
          found =
              (found | found >> 16) & (kC == 1 ? in_a << 4 * own : static_cast<uint32_t>(kRows[in_a]) << own);
        }
        if (found != 0) {
          // Both ends within the box: no ray waits outside.
          course.waiting =
              a.low < 0 || b.low < 0 || a.high >> kBrickShift > last_a || b.high >> kBrickShift > last_b
                  ? kWaiting
                  : 0;
          return slab;
        }
      }
    }
  }
  return slabs;
}

template <bool kCoarse>
int32_t first_slab_along(Course& course, const Fan& fan, int32_t slab) {
  return course.c == 0   ? first_slab<0, kCoarse>(course, fan, slab)
         : course.c == 1 ? first_slab<1, kCoarse>(course, fan, slab)
                         : first_slab<2, kCoarse>(course, fan, slab);
}

int32_t ask(const Frame& frame, int32_t x, int32_t y, RenderCounts* counts) {
  const Ray ray = frame.camera.ray(x, y);
  Hit hit;
  if (closest_hit_32(frame.tree, ray, &hit) != Status::kOk) {
    return kMissed;
  }
  counts->node_visits += hit.visits;
  if (hit.kind != HitKind::kHit) {
    return kMissed;
  }
  return static_cast<int32_t>(ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)));
}

template <int kC>
int32_t trace_by_signs(const Course& course, uint32_t d_a, uint32_t d_b, uint32_t d_c) {
  switch (course.mirrored) {
    case 0:
      return trace_one<kC, 0>(course, d_a, d_b, d_c);
    case 1:
      return trace_one<kC, 1>(course, d_a, d_b, d_c);
    case 2:
      return trace_one<kC, 2>(course, d_a, d_b, d_c);
    case 3:
      return trace_one<kC, 3>(course, d_a, d_b, d_c);
    case 4:
      return trace_one<kC, 4>(course, d_a, d_b, d_c);
    case 5:
      return trace_one<kC, 5>(course, d_a, d_b, d_c);
    case 6:
      return trace_one<kC, 6>(course, d_a, d_b, d_c);
    default:
      return trace_one<kC, 7>(course, d_a, d_b, d_c);
  }
}

int32_t trace_along(const Course& course, const Vec3i& d) {
  const auto size = [](int32_t value) { return static_cast<uint32_t>(value < 0 ? -value : value); };
  const uint32_t x = size(d.x);
  const uint32_t y = size(d.y);
  const uint32_t z = size(d.z);
  return course.c == 0   ? trace_by_signs<0>(course, y, z, x)
         : course.c == 1 ? trace_by_signs<1>(course, x, z, y)
                         : trace_by_signs<2>(course, x, y, z);
}

unsigned signs_of(const Vec3i& d) {
  return (d.x < 0 ? 1U : 0U) | (d.y < 0 ? 2U : 0U) | (d.z < 0 ? 4U : 0U);
}

// A rectangle of the picture that lies in one tile.
struct Tile {
  int32_t x0;
  int32_t x1;
  int32_t y0;
  int32_t y1;
};

// Tiles are kBrickTilePx high.
constexpr int32_t kTileAcrossPx = 16;
// Quads: the least tiles.
constexpr int32_t kQuadAcrossPx = 4;
constexpr int32_t kQuadDownPx = 4;
constexpr int32_t kQuadPixels = kQuadAcrossPx * kQuadDownPx;

// A quad with rays of one course: the mirrored affine function `from` (and a half) is positive all over it,
// so rounding is cutting off. Returns a negative number when any ink is none.
template <int kC, unsigned kMirrored>
[[gnu::noinline]] int32_t trace_quad(const Course& course, const Camera::Vec3Q32& from, int32_t across,
                                     int32_t down, int32_t* inks) {
  constexpr int kA = kC == 0 ? 1 : 0;
  constexpr int kB = kC == 2 ? 1 : 2;
  Vec3<uint64_t> row{static_cast<uint64_t>(from.x), static_cast<uint64_t>(from.y),
                     static_cast<uint64_t>(from.z)};
  int32_t all = 0;
  for (; down > 0; --down) {
    uint64_t a = row[kA];
    uint64_t b = row[kB];
    uint64_t c = row[kC];
    for (const int32_t* end = inks + across; inks != end; ++inks) {
      const int32_t ink =
          trace_one<kC, kMirrored>(course, static_cast<uint32_t>(a >> 32), static_cast<uint32_t>(b >> 32),
                                   static_cast<uint32_t>(c >> 32));
      *inks = ink;
      all |= ink;
      a += static_cast<uint64_t>(course.step_x[kA]);
      b += static_cast<uint64_t>(course.step_x[kB]);
      c += static_cast<uint64_t>(course.step_x[kC]);
    }
    row.x += static_cast<uint64_t>(course.step_y.x);
    row.y += static_cast<uint64_t>(course.step_y.y);
    row.z += static_cast<uint64_t>(course.step_y.z);
  }
  return all;
}

template <int kC>
int32_t trace_quad_by_signs(const Course& course, const Camera::Vec3Q32& from, int32_t across, int32_t down,
                            int32_t* inks) {
  switch (course.mirrored) {
    case 0:
      return trace_quad<kC, 0>(course, from, across, down, inks);
    case 1:
      return trace_quad<kC, 1>(course, from, across, down, inks);
    case 2:
      return trace_quad<kC, 2>(course, from, across, down, inks);
    case 3:
      return trace_quad<kC, 3>(course, from, across, down, inks);
    case 4:
      return trace_quad<kC, 4>(course, from, across, down, inks);
    case 5:
      return trace_quad<kC, 5>(course, from, across, down, inks);
    case 6:
      return trace_quad<kC, 6>(course, from, across, down, inks);
    default:
      return trace_quad<kC, 7>(course, from, across, down, inks);
  }
}

class Painter {
 public:
  Painter(const Frame& frame, Inks& inks, uint8_t* first_line, size_t stride, int32_t first_row,
          RenderCounts* counts)
      : frame_(frame), first_line_(first_line), stride_(stride), first_row_(first_row), counts_(counts) {
    course_.frame = &frame;
    course_.inks = &inks;
    course_.directory = frame.map.directory();
    course_.bricks = frame.map.bricks();
    course_.exact_ties = !frame.tree.merged();
    set_course(course_, 0, 0);
  }

  void draw_tile(const Tile& tile) {
    if (frame_.map.empty()) {
      fill(tile);
      return;
    }
    Camera::Vec3Q32 value;
    const Camera::Affine& affine = frame_.camera.affine();
    for (int axis = 0; axis < 3; ++axis) {
      value[axis] = affine.base[axis] + tile.x0 * affine.step_x[axis] + tile.y0 * affine.step_y[axis];
    }
    const Fan fan(value, frame_.tile_low, frame_.tile_high);
    int32_t slab = 0;
    if (fan.usable()) {
      use(fan.mirrored, fan.c);
      slab = first_slab_along<false>(course_, fan, 0);
      if (slab == 4 * frame_.side[fan.c]) {
        fill(tile);
        return;
      }
    }
    Camera::Vec3Q32 row = value;
    for (int32_t y = tile.y0; y < tile.y1; y += kQuadDownPx) {
      Camera::Vec3Q32 at = row;
      for (int32_t x = tile.x0; x < tile.x1; x += kQuadAcrossPx) {
        const Tile quad{x, x + kQuadAcrossPx < tile.x1 ? x + kQuadAcrossPx : tile.x1, y,
                        y + kQuadDownPx < tile.y1 ? y + kQuadDownPx : tile.y1};
        draw_quad(quad, at, fan, slab);
        for (int axis = 0; axis < 3; ++axis) {
          at[axis] += kQuadAcrossPx * affine.step_x[axis];
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        row[axis] += kQuadDownPx * affine.step_y[axis];
      }
    }
  }

 private:
  void use(unsigned mirrored, int c) {
    if (mirrored != course_.mirrored || c != course_.c) {
      set_course(course_, mirrored, c);
    }
  }

  void draw_quad(const Tile& quad, const Camera::Vec3Q32& value, const Fan& tile_fan, int32_t slab) {
    const Fan fan(value, frame_.quad_low, frame_.quad_high);
    const bool usable = fan.usable();
    if (usable) {
      use(fan.mirrored, fan.c);
      slab = first_slab_along<false>(course_, fan, tile_fan.usable() && tile_fan.c == fan.c ? slab : 0);
      if (slab == 4 * frame_.side[fan.c]) {
        fill(quad);
        return;
      }
      set_start(course_, slab);
    }
    int32_t inks[kQuadPixels];
    const int32_t across = quad.x1 - quad.x0;
    const int32_t down = quad.y1 - quad.y0;
    if (!usable || fan.mixed != 0) {
      trace_mixed(value, usable ? fan.c : -1, slab, across, down, inks);
      answer(quad, inks);
    } else {
      Camera::Vec3Q32 from;
      for (int axis = 0; axis < 3; ++axis) {
        from[axis] = ((fan.mirrored >> axis & 1U) != 0 ? -value[axis] : value[axis]) + (int64_t{1} << 31);
      }
      const int32_t all = fan.c == 0   ? trace_quad_by_signs<0>(course_, from, across, down, inks)
                          : fan.c == 1 ? trace_quad_by_signs<1>(course_, from, across, down, inks)
                                       : trace_quad_by_signs<2>(course_, from, across, down, inks);
      if (all < 0) {
        answer(quad, inks);
      }
    }
    store(quad, inks);
  }

  // A quad whose rays do not all go the same way, each with a course of its own; axis -1: none is known.
  [[gnu::noinline]] void trace_mixed(const Camera::Vec3Q32& value, int c, int32_t slab, int32_t across,
                                     int32_t down, int32_t* inks) {
    const Camera::Affine& affine = frame_.camera.affine();
    Camera::Vec3Q32 row = value;
    for (; down > 0; --down) {
      Camera::Vec3Q32 at = row;
      for (int32_t i = 0; i < across; ++i) {
        *inks = kAsk;
        if (c >= 0) {
          const Vec3i d{Camera::rounded(at.x), Camera::rounded(at.y), Camera::rounded(at.z)};
          const unsigned signs = signs_of(d);
          if (signs != course_.mirrored) {
            set_course(course_, signs, c);
            set_start(course_, slab);
          }
          *inks = trace_along(course_, d);
        }
        ++inks;
        for (int axis = 0; axis < 3; ++axis) {
          at[axis] += affine.step_x[axis];
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        row[axis] += affine.step_y[axis];
      }
    }
  }

  uint8_t* line_of(int32_t y) const { return first_line_ + stride_ * static_cast<size_t>(y - first_row_); }

  void store(const Tile& quad, const int32_t* inks) {
    const int32_t across = quad.x1 - quad.x0;
    uint8_t* line = line_of(quad.y0);
    if (frame_.format == PixelFormat::kGray4 && across == kQuadAcrossPx) {
      line += quad.x0 >> 1;
      for (int32_t y = quad.y0; y < quad.y1; ++y, line += stride_) {
        for (int32_t i = 0; i < kQuadAcrossPx / 2; ++i, inks += 2) {
          line[i] = static_cast<uint8_t>(inks[0] << 4 | inks[1]);  // NOLINT: all of a quad are set
        }
      }
      return;
    }
    for (int32_t y = quad.y0; y < quad.y1; ++y, line += stride_) {
      for (int32_t x = quad.x0; x < quad.x1; ++x) {
        store_ink(line, x, y, frame_.format, static_cast<uint32_t>(*inks++));
      }
    }
  }

  // Makes colours of what are none yet.
  [[gnu::noinline]] void answer(const Tile& quad, int32_t* inks) {
    for (int32_t y = quad.y0; y < quad.y1; ++y) {
      for (int32_t x = quad.x0; x < quad.x1; ++x, ++inks) {
        if (*inks == kAsk) {  // NOLINT: all of a quad are set
          *inks = ask(frame_, x, y, counts_);
        }
        if (*inks < 0) {
          *inks = static_cast<int32_t>(frame_.background);
          ++misses_;
        }
      }
    }
  }

  void fill(const Tile& tile) {
    const bool whole = frame_.format == PixelFormat::kGray4 && (tile.x1 - tile.x0) % kQuadAcrossPx == 0;
    for (int32_t y = tile.y0; y < tile.y1; ++y) {
      uint8_t* line = line_of(y);
      for (int32_t x = tile.x0; x < tile.x1; x += whole ? 2 : 1) {
        if (whole) {
          line[x >> 1] = static_cast<uint8_t>(frame_.background * 17);
        } else {
          store_ink(line, x, y, frame_.format, frame_.background);
        }
      }
    }
    misses_ += static_cast<uint32_t>((tile.y1 - tile.y0) * (tile.x1 - tile.x0));
  }

 public:
  uint32_t misses() const { return misses_; }

 private:
  const Frame& frame_;
  uint8_t* first_line_;
  size_t stride_;
  int32_t first_row_;
  RenderCounts* counts_;
  uint32_t misses_ = 0;
  Course course_;
};

// What rounded directions of a tile lie between, in 16.16 from its first pixel's affine function in 16.16:
// cut off after adding these, and one unit of 2^-16 either way for what was cut off before.
void margins_of(const Camera::Affine& affine, int32_t across_px, int32_t down_px, Vec3i* low, Vec3i* high) {
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t across = affine.step_x[axis] * (across_px - 1);
    const int64_t down = affine.step_y[axis] * (down_px - 1);
    const int64_t least = (across < 0 ? across : 0) + (down < 0 ? down : 0);
    const int64_t greatest = (across < 0 ? 0 : across) + (down < 0 ? 0 : down);
    // Halves go away from zero: half a unit below may be rounded down.
    (*low)[axis] = static_cast<int32_t>(least >> 16) + 0x8000 - 1;
    (*high)[axis] = static_cast<int32_t>(greatest >> 16) + 0x8000 + 2;
  }
}

}  // namespace

bool draws_fast(const BrickMap& map, const Camera& camera) {
  if (!camera.is_perspective() || camera.width_px() == 0 || camera.level() != map.level() ||
      camera.direction_bits() > kMaxBrickDirectionBits) {
    return false;
  }
  // The products of distances, measured from up to kOutsideCells beyond the world, and directions; two are
  // added.
  uint32_t distances = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t from_low = camera.eye()[axis].raw;
    const int32_t from_high = (Q8::kOne << map.level()) - from_low;
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
  return draws_fast(map, camera) ? render_band_32(tree, map, camera, shading, band, counts)
                                 : render_band(tree, camera, shading, band, counts);
}

Status render_band_32(const CompactTree& tree, const BrickMap& map, const Camera& camera,
                      const Shading& shading, const Band& band, RenderCounts* counts) {
  if (!map.belongs_to(tree)) {
    return Status::kDamaged;
  }
  if (!draws_fast(map, camera)) {
    return Status::kBadArgument;
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
  inks.near_cell[0] = 0;
  inks.near_cell[1] = 0;
  for (uint32_t& ink : inks.material) {
    ink = Inks::kNone;
  }
  Frame frame{tree, map, camera, shading, band.format, 0, {}, {}, {}, {}, {}, {}, {}};
  frame.background = ink_of(band.format, shade(Hit{}, Ray{}, camera, shading));
  for (int axis = 0; axis < 3; ++axis) {
    frame.side[axis] = map.box().high[axis] - map.box().low[axis];
    frame.eye[axis] = camera.eye()[axis].raw - map.box().low[axis] * (4 * Q8::kOne);
  }
  frame.stride = {2, 2 * frame.side.x, 2 * frame.side.x * frame.side.y};
  margins_of(camera.affine(), kTileAcrossPx, kBrickTilePx, &frame.tile_low, &frame.tile_high);
  margins_of(camera.affine(), kQuadAcrossPx, kQuadDownPx, &frame.quad_low, &frame.quad_high);
  RenderCounts done;
  Painter painter(frame, inks, band.pixels.data, stride, band.first_row, &done);
  const int32_t end = band.first_row + band.rows;
  for (int32_t y = band.first_row; y < end;) {
    const int32_t tile_end = (y / kBrickTilePx + 1) * kBrickTilePx;
    const int32_t y1 = tile_end < end ? tile_end : end;
    // Pixels of less than a byte are put into what is there, where no quad stores whole bytes.
    const bool cleared = band.format == PixelFormat::kMono1 ||
                         (band.format == PixelFormat::kGray4 && width % kQuadAcrossPx != 0);
    for (int32_t row = y; row < y1 && cleared; ++row) {
      uint8_t* line = band.pixels.data + stride * static_cast<size_t>(row - band.first_row);
      for (size_t i = 0; i < line_bytes; ++i) {
        line[i] = 0;
      }
    }
    for (int32_t x = 0; x < width; x += kTileAcrossPx) {
      const int32_t x1 = x + kTileAcrossPx < width ? x + kTileAcrossPx : width;
      painter.draw_tile({x, x1, y, y1});
    }
    y = y1;
  }
  const uint64_t rays =
      static_cast<uint64_t>(static_cast<uint32_t>(width)) * static_cast<uint32_t>(band.rows);
  done.hits = rays - painter.misses();
  if (counts != nullptr) {
    counts->rays += rays;
    counts->hits += done.hits;
    counts->node_visits += done.node_visits;
  }
  return Status::kOk;
}

}  // namespace thimble
