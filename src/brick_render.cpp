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
  static constexpr uint32_t kFaces = 64;
  static constexpr uint32_t kMaterials = 8;
  static constexpr uint32_t kNone = UINT32_MAX;
  struct Seen {
    uint32_t key;
    uint32_t ink;
  };
  Seen face[kFaces];
  uint32_t material[6 * kMaterials];  // material << 24 | ink

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
  Vec3i side;  // of the box, in bricks
  // From a tile's first pixel to the least and greatest of the affine function in whole tiles.
  Camera::Vec3Q32 tile_low;
  Camera::Vec3Q32 tile_high;
  Camera::Vec3Q32 quad_low;
  Camera::Vec3Q32 quad_high;
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
  int32_t stride[3];  // of the directory in bytes
  uint32_t last[3];   // the voxel of a brick before the next brick, in place
  int32_t step[3];    // to the next voxel, in place
  uint32_t flip[3];   // 3 where mirrored
  uint32_t face[3];
  int32_t base;        // of the directory, in bytes, for slab 0
  uint32_t base_left;  // counts of bricks, for slab 0
  int c;               // the fastest axis
  unsigned mirrored;   // bit a: axis a is
  bool exact_ties;     // faces entered through an edge are the voxel's
  // Where the rays start.
  bool inside;      // at their origins
  uint32_t plane;   // distance from the origin, 1/256 voxel
  uint32_t behind;  // from there back to the plane of c before it, when the origin lies between two planes
  uint32_t first;   // the voxel on c, in place
  int32_t start;    // of the directory, without a and b
  uint32_t left;    // counts of bricks, without a and b
  // The affine function, mirrored.
  Camera::Vec3Q32 step_x;
  Camera::Vec3Q32 step_y;
};

// Where a voxel lies in a brick: x and y as a shift of halfword z, z in bytes.
struct Place {
  uint32_t shift;
  uint32_t row;
};
constexpr int kPlaceShift[3] = {0, 2, 1};
template <int kAxis>
uint32_t& part(Place& place) {
  return kAxis == 2 ? place.row : place.shift;
}
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

struct Found {
  uint32_t brick;  // number
  uint32_t bit;
  uint32_t axis;
  uint32_t t_numerator;
  uint32_t direction;  // on that axis
};

// The colour of a face that is not among those seen lately.
[[gnu::noinline]] int32_t look_up(const Course& course, const Found& found) {
  const Frame& frame = *course.frame;
  Hit hit;
  hit.kind = HitKind::kHit;
  hit.axis = static_cast<int8_t>(found.axis);
  hit.material = frame.map.material(frame.tree, found.brick, found.bit);
  Ray ray;
  ray.direction[static_cast<int>(found.axis)] = (course.mirrored >> found.axis & 1U) == 0 ? 1 : -1;
  if (frame.shading.mode == ShadeMode::kDepth) {
    hit.t_numerator = static_cast<int32_t>(found.t_numerator);
    hit.t_denominator = static_cast<int32_t>(found.direction) * Q8::kOne;
    return static_cast<int32_t>(ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)));
  }
  const uint32_t face = course.face[found.axis];
  uint32_t& kept = course.inks->material[face * Inks::kMaterials + hit.material % Inks::kMaterials];
  if (kept >> 24 != hit.material || kept == Inks::kNone) {
    kept = ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)) |
           static_cast<uint32_t>(hit.material) << 24;
  }
  const uint32_t ink = kept & 0xFFFFFFU;
  const uint32_t key = (found.brick << 6 | found.bit) << 3 | face;
  course.inks->face[Inks::slot(key)] = {key, ink};
  return static_cast<int32_t>(ink);
}

// One ray of direction (d_a, d_b, d_c), mirrored.
template <int kC>
[[gnu::noinline]] int32_t trace_one(const Course& course, uint32_t d_a, uint32_t d_b, uint32_t d_c) {
  constexpr int kA = kC == 0 ? 1 : 0;
  constexpr int kB = kC == 2 ? 1 : 2;
  const uint32_t den = d_c << 8;
  const uint32_t at_a = static_cast<uint32_t>(course.origin[kA]) * d_c + course.plane * d_a;
  const uint32_t at_b = static_cast<uint32_t>(course.origin[kB]) * d_c + course.plane * d_b;
  const uint32_t cell_a = at_a / den;
  const uint32_t cell_b = at_b / den;
  if ((cell_a | cell_b) >= 1024) [[unlikely]] {
    return static_cast<int32_t>(at_a | at_b) < 0 ? kAsk : kMissed;
  }
  uint32_t rest_a = at_a - (cell_a + 1) * den - course.behind * d_a;
  uint32_t rest_b = at_b - (cell_b + 1) * den - course.behind * d_b;
  const uint32_t go_a = d_a << 8;
  const uint32_t go_b = d_b << 8;

  uint32_t left = course.left + ((cell_a >> 2) << 10 * kA) + ((cell_b >> 2) << 10 * kB);
  left |= ((cell_a - kOutsideCells) | (cell_b - kOutsideCells)) & kWaiting;
  int32_t cell = course.start + static_cast<int32_t>(cell_a >> 2) * course.stride[kA] +
                 static_cast<int32_t>(cell_b >> 2) * course.stride[kB];
  Place place{0, 0};
  part<kA>(place) |= ((cell_a & 3U) ^ course.flip[kA]) << kPlaceShift[kA];
  part<kB>(place) |= ((cell_b & 3U) ^ course.flip[kB]) << kPlaceShift[kB];
  part<kC>(place) |= course.first;
  const uint8_t* brick = nullptr;
  int axis = kC;

  const auto negative = [](uint32_t value) { return static_cast<int32_t>(value) < 0; };
  const auto solid = [&]() {
    return (half_at(brick, static_cast<int32_t>(place.row)) >> place.shift & 1U) != 0;
  };
  // To the next voxel; whether it is in the next brick.
  const auto step = [&]<int kAxis>() {
    uint32_t& own = part<kAxis>(place);
    if ((own & kField<kAxis>) == course.last[kAxis]) {
      own ^= kField<kAxis>;
      left += uint32_t{1} << 10 * kAxis;
      cell += course.stride[kAxis];
      return true;
    }
    own += static_cast<uint32_t>(course.step[kAxis]);
    return false;
  };

  if (course.inside && (left & (kLeft | kWaiting)) == 0) [[unlikely]] {
    brick = course.bricks + 8 * half_at(course.directory, cell);
    if (solid()) {
      return kAsk;
    }
  }

enter:  // a brick, by a plane of `axis`
  if ((left & (kLeft | kWaiting)) != 0) [[unlikely]] {
    if ((left & kLeft) != 0) {
      return kMissed;
    }
    // 512 - bricks is the near side: below it the ray waits.
    const Vec3i& side = course.frame->side;
    if ((left >> 10 * kA & 0x3FFU) < 512U - static_cast<uint32_t>(side[kA]) ||
        (left >> 10 * kB & 0x3FFU) < 512U - static_cast<uint32_t>(side[kB])) {
      brick = course.bricks;
      goto entered;
    }
    left &= ~kWaiting;
  }
  brick = course.bricks + 8 * half_at(course.directory, cell);
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
  if (!negative(rest_a)) {
    goto cross_a;
  }
  if (!negative(rest_b)) {
    goto cross_b;
  }
  if (step.template operator()<kC>()) {
    axis = kC;
    goto enter;
  }
  if (!solid()) {
    goto slab;
  }
  axis = kC;
  goto hit;
cross_a:
  if (!negative(rest_b)) {
    const uint32_t time_a = rest_a * d_b;
    const uint32_t time_b = rest_b * d_a;
    if (time_a < time_b) {
      goto cross_b;
    }
    if (time_a == time_b) {
      goto tie;
    }
  }
  if (rest_a == 0) {
    goto tie;
  }
  rest_a -= den;
  axis = kA;
  if (step.template operator()<kA>()) {
    goto enter;
  }
  if (solid()) {
    goto hit;
  }
  goto between;
cross_b:
  if (rest_b == 0) {
    goto tie;
  }
  rest_b -= den;
  axis = kB;
  if (step.template operator()<kB>()) {
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
      step.template operator()<kA>();
    }
    if (rest_b == 0) {
      rest_b -= den;
      step.template operator()<kB>();
    }
    step.template operator()<kC>();
    axis = kC;
  } else {
    rest_a -= den;
    rest_b -= den;
    step.template operator()<kA>();
    step.template operator()<kB>();
    axis = kA;
    if (!course.exact_ties) {
      return kAsk;
    }
  }
  goto enter;

hit:
  // Entered by a plane of c, and perhaps by others at the same t: the lowest axis counts.
  if (axis == kC && (rest_a == 0U - den || rest_b == 0U - den)) [[unlikely]] {
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
  const uint32_t bit = place.shift + place.row * 8;
  const uint32_t face = course.face[axis];
  const uint32_t offset = static_cast<uint32_t>(brick - course.bricks);
  const uint32_t key = (offset << 3 | bit) << 3 | face;
  const Inks::Seen& seen = course.inks->face[Inks::slot(key)];
  if (seen.key == key) {
    return static_cast<int32_t>(seen.ink);
  }
  Found found{offset >> 3, bit, static_cast<uint32_t>(axis), 0, axis == kA ? d_a : axis == kB ? d_b : d_c};
  if (course.frame->shading.mode == ShadeMode::kDepth) {
    const uint32_t bricks =
        (left >> 10 * axis & 0x3FFU) - (512U - static_cast<uint32_t>(course.frame->side[axis]));
    const uint32_t voxel = (axis == 0 ? bit : axis == 1 ? bit >> 2 : bit >> 4) & 3U;
    const int32_t origin = course.origin[axis] - (axis == kC ? 0 : kOutsideQ8);
    found.t_numerator = (4 * bricks + (voxel ^ course.flip[axis])) * Q8::kOne - static_cast<uint32_t>(origin);
  }
  return look_up(course, found);
}

// The directions of a tile: for each axis the least and the greatest; what rays of them have in common.
struct Fan {
  Vec3i low;
  Vec3i high;
  int c = 0;              // the fastest axis
  unsigned mirrored = 0;  // bit a: axis a is, for most
  unsigned mixed = 0;     // bit a: not for all

  // Directions round(value + low) .. round(value + high).
  Fan(const Camera::Vec3Q32& value, const Camera::Vec3Q32& least, const Camera::Vec3Q32& greatest) {
    int32_t most = -1;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = Camera::round(value[axis] + least[axis]);
      high[axis] = Camera::round(value[axis] + greatest[axis]);
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
    const int32_t near_q8 = (flipped ? box.max[axis] : box.min[axis]) * (4 * Q8::kOne);
    course.origin[axis] = (flipped ? near_q8 - origin : origin - near_q8) + (axis == c ? 0 : kOutsideQ8);
    course.stride[axis] = flipped ? -stride : stride;
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
  course.inside = distance <= 0;
  course.plane = distance > 0 ? static_cast<uint32_t>(distance) : 0;
  course.behind = distance > 0 ? 0 : static_cast<uint32_t>(-distance);
  course.first = ((static_cast<uint32_t>(slab) & 3U) ^ course.flip[course.c]) << kPlaceShift[course.c];
  course.start = course.base + course.stride[course.c] * (slab >> 2);
  course.left = course.base_left + (static_cast<uint32_t>(slab >> 2) << 10 * course.c);
}

// Slopes of the beam in 1/1024, so positions in 1/2^18 voxel.
constexpr int kSlopeBits = 10;
constexpr int kCellShift = kSlopeBits + 8;

// The way of all rays of a fan between two planes of c: on axes a and b from `low` to `high` at the first.
struct Beam {
  int32_t low[2];
  int32_t high[2];
  int32_t low_slope[2];
  int32_t high_slope[2];
};

// Rows of a brick's halfword from bits: bit y becomes 1 << 4 y.
constexpr uint16_t kRows[16] = {0x0000, 0x0001, 0x0010, 0x0011, 0x0100, 0x0101, 0x0110, 0x0111,
                                0x1000, 0x1001, 0x1010, 0x1011, 0x1100, 0x1101, 0x1110, 0x1111};

// Cells from .. to of an axis as bits of brick `number`, in the tree's order.
uint32_t cells_in(int32_t from, int32_t to, int32_t number, uint32_t flip) {
  int32_t low = from - 4 * number;
  int32_t high = to - 4 * number;
  low = low < 0 ? 0 : low;
  high = high > 3 ? 3 : high;
  if (flip != 0) {
    const int32_t one = low;
    low = 3 - high;
    high = 3 - one;
  }
  return (0xFU << low) & (0xFU >> (3 - high));
}

// The first slab of voxels from `slab` on in which rays of `fan` may meet something, or the number of slabs
// when there is none. Coarse: the first of a slab of bricks. `course` is the fan's.
int32_t first_slab(const Course& course, const Fan& fan, int32_t slab, bool coarse) {
  const Vec3i& side = course.frame->side;
  const int c = course.c;
  const int a = c == 0 ? 1 : 0;
  const int b = c == 2 ? 1 : 2;
  const int32_t slabs = 4 * side[c];
  const int32_t origin_c = course.origin[c];
  const int32_t nearest = origin_c < 0 ? 0 : origin_c >> 8;
  slab = slab < nearest ? nearest : slab;
  if (slab >= slabs) {
    return slabs;
  }
  const bool flipped = (course.mirrored >> c & 1U) != 0;
  const int32_t c_low = flipped ? -fan.high[c] : fan.low[c];
  const int32_t c_high = flipped ? -fan.low[c] : fan.high[c];
  Beam beam;
  // The first slab may begin behind the origin: then the bounds start from whichever is wider.
  const int32_t from_slab = slab * Q8::kOne - origin_c;
  const int32_t near_q8 = from_slab < 0 ? 0 : from_slab;
  for (int i = 0; i < 2; ++i) {
    const int axis = i == 0 ? a : b;
    const bool mirrored = (course.mirrored >> axis & 1U) != 0;
    const int32_t low = (mirrored ? -fan.high[axis] : fan.low[axis]) * (1 << kSlopeBits);
    const int32_t high = (mirrored ? -fan.low[axis] : fan.high[axis]) * (1 << kSlopeBits);
    beam.low_slope[i] = low / (low < 0 ? c_low : c_high) - 1;
    beam.high_slope[i] = high / (high < 0 ? c_high : c_low) + 1;
    if (beam.low_slope[i] < -(2 << kSlopeBits) || beam.high_slope[i] > 2 << kSlopeBits) {
      return slab;
    }
    const int32_t origin = (course.origin[axis] - kOutsideQ8) * (1 << kSlopeBits);
    beam.low[i] = origin + (beam.low_slope[i] < 0 ? near_q8 : from_slab) * beam.low_slope[i] - 1;
    beam.high[i] = origin + (beam.high_slope[i] < 0 ? from_slab : near_q8) * beam.high_slope[i] + 1;
    // From here on slopes are per slab of voxels.
    beam.low_slope[i] *= Q8::kOne;
    beam.high_slope[i] *= Q8::kOne;
  }
  const int32_t origin_of_bricks = course.base + kOutsideCells / 4 * (course.stride[a] + course.stride[b]);
  while (slab < slabs) {
    // What of the slab of bricks is left, and the bricks that the rays may pass through there.
    const int32_t voxels = 4 - (slab & 3);
    int32_t from[2];
    int32_t to[2];
    for (int i = 0; i < 2; ++i) {
      const int32_t low = beam.low[i] + (beam.low_slope[i] < 0 ? voxels * beam.low_slope[i] : 0);
      const int32_t high = beam.high[i] + (beam.high_slope[i] > 0 ? voxels * beam.high_slope[i] : 0);
      const int32_t last = side[i == 0 ? a : b] - 1;
      from[i] = low < 0 ? 0 : low >> (kCellShift + 2);
      to[i] = high >> (kCellShift + 2) < last ? high >> (kCellShift + 2) : last;
    }
    const int32_t row = origin_of_bricks + course.stride[c] * (slab >> 2);
    bool any = false;
    for (int32_t j = from[1]; j <= to[1] && !any; ++j) {
      for (int32_t i = from[0]; i <= to[0]; ++i) {
        any |= half_at(course.directory, row + i * course.stride[a] + j * course.stride[b]) != 0;
      }
    }
    if (any && coarse) {
      return slab;
    }
    if (!any) {
      for (int i = 0; i < 2; ++i) {
        beam.low[i] += voxels * beam.low_slope[i];
        beam.high[i] += voxels * beam.high_slope[i];
      }
      slab += voxels;
      continue;
    }
    // Voxel by voxel.
    for (int32_t v = 0; v < voxels; ++v, ++slab) {
      int32_t first[2];
      int32_t last[2];
      for (int i = 0; i < 2; ++i) {
        const int32_t next_low = beam.low[i] + beam.low_slope[i];
        const int32_t next_high = beam.high[i] + beam.high_slope[i];
        const int32_t low = beam.low_slope[i] < 0 ? next_low : beam.low[i];
        const int32_t high = beam.high_slope[i] > 0 ? next_high : beam.high[i];
        const int32_t most = 4 * side[i == 0 ? a : b] - 1;
        first[i] = low < 0 ? 0 : low >> kCellShift;
        last[i] = high >> kCellShift < most ? high >> kCellShift : most;
        beam.low[i] = next_low;
        beam.high[i] = next_high;
      }
      if (first[0] > last[0] || first[1] > last[1]) {
        continue;
      }
      const uint32_t own = (static_cast<uint32_t>(slab) & 3U) ^ course.flip[c];
      for (int32_t j = first[1] >> 2; j <= last[1] >> 2; ++j) {
        const uint32_t b_bits = cells_in(first[1], last[1], j, course.flip[b]);
        for (int32_t i = first[0] >> 2; i <= last[0] >> 2; ++i) {
          const uint32_t number =
              half_at(course.directory, row + i * course.stride[a] + j * course.stride[b]);
          if (number == 0) {
            continue;
          }
          const uint8_t* brick = course.bricks + 8 * number;
          const uint32_t a_bits = cells_in(first[0], last[0], i, course.flip[a]);
          uint32_t found = 0;
          if (c == 2) {
            found = half_at(brick, static_cast<int32_t>(2 * own)) & (a_bits * kRows[b_bits]);
          } else {
            for (uint32_t z = 0; z < 4; ++z) {
              if ((b_bits >> z & 1U) != 0) {
                found |= half_at(brick, static_cast<int32_t>(2 * z));
              }
            }
            found &= c == 1 ? a_bits << 4 * own : static_cast<uint32_t>(kRows[a_bits]) << own;
          }
          if (found != 0) {
            return slab;
          }
        }
      }
    }
  }
  return slabs;
}

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

int32_t trace_along(const Course& course, const Vec3i& d) {
  const auto size = [](int32_t value) { return static_cast<uint32_t>(value < 0 ? -value : value); };
  const uint32_t x = size(d.x);
  const uint32_t y = size(d.y);
  const uint32_t z = size(d.z);
  return course.c == 0   ? trace_one<0>(course, y, z, x)
         : course.c == 1 ? trace_one<1>(course, x, z, y)
                         : trace_one<2>(course, x, y, z);
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

constexpr int32_t kQuadPx = 4;

// Rows of a quad with rays of one course: the mirrored affine function is positive all over it, so rounding
// is adding a half.
template <int kC>
void trace_row(const Course& course, const Camera::Vec3Q32& from, int32_t pixels, int32_t* inks) {
  constexpr int kA = kC == 0 ? 1 : 0;
  constexpr int kB = kC == 2 ? 1 : 2;
  uint64_t a = static_cast<uint64_t>(from[kA]);
  uint64_t b = static_cast<uint64_t>(from[kB]);
  uint64_t c = static_cast<uint64_t>(from[kC]);
  for (int32_t i = 0; i < pixels; ++i) {
    inks[i] = trace_one<kC>(course, static_cast<uint32_t>(a >> 32), static_cast<uint32_t>(b >> 32),
                            static_cast<uint32_t>(c >> 32));
    a += static_cast<uint64_t>(course.step_x[kA]);
    b += static_cast<uint64_t>(course.step_x[kB]);
    c += static_cast<uint64_t>(course.step_x[kC]);
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
      slab = first_slab(course_, fan, 0, true);
      if (slab == 4 * frame_.side[fan.c]) {
        fill(tile);
        return;
      }
    }
    Camera::Vec3Q32 row = value;
    for (int32_t y = tile.y0; y < tile.y1; y += kQuadPx) {
      Camera::Vec3Q32 at = row;
      for (int32_t x = tile.x0; x < tile.x1; x += kQuadPx) {
        const Tile quad{x, x + kQuadPx < tile.x1 ? x + kQuadPx : tile.x1, y,
                        y + kQuadPx < tile.y1 ? y + kQuadPx : tile.y1};
        draw_quad(quad, at, fan, slab);
        for (int axis = 0; axis < 3; ++axis) {
          at[axis] += kQuadPx * affine.step_x[axis];
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        row[axis] += kQuadPx * affine.step_y[axis];
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
      slab = first_slab(course_, fan, tile_fan.usable() && tile_fan.c == fan.c ? slab : 0, false);
      if (slab == 4 * frame_.side[fan.c]) {
        fill(quad);
        return;
      }
      set_start(course_, slab);
    }
    int32_t inks[kQuadPx];
    const int32_t pixels = quad.x1 - quad.x0;
    if (!usable || fan.mixed != 0) {
      Camera::Vec3Q32 row = value;
      for (int32_t y = quad.y0; y < quad.y1; ++y) {
        Camera::Vec3Q32 at = row;
        for (int32_t i = 0; i < pixels; ++i) {
          inks[i] = kAsk;
          if (usable) {
            const Vec3i d{Camera::round(at.x), Camera::round(at.y), Camera::round(at.z)};
            const unsigned signs = signs_of(d);
            if (signs != course_.mirrored) {
              set_course(course_, signs, fan.c);
              set_start(course_, slab);
            }
            inks[i] = trace_along(course_, d);
          }
          for (int axis = 0; axis < 3; ++axis) {
            at[axis] += frame_.camera.affine().step_x[axis];
          }
        }
        store(quad.x0, y, inks, pixels);
        for (int axis = 0; axis < 3; ++axis) {
          row[axis] += frame_.camera.affine().step_y[axis];
        }
      }
      return;
    }
    Camera::Vec3Q32 row;
    for (int axis = 0; axis < 3; ++axis) {
      row[axis] = ((fan.mirrored >> axis & 1U) != 0 ? -value[axis] : value[axis]) + (int64_t{1} << 31);
    }
    for (int32_t y = quad.y0; y < quad.y1; ++y) {
      if (fan.c == 0) {
        trace_row<0>(course_, row, pixels, inks);
      } else if (fan.c == 1) {
        trace_row<1>(course_, row, pixels, inks);
      } else {
        trace_row<2>(course_, row, pixels, inks);
      }
      store(quad.x0, y, inks, pixels);
      for (int axis = 0; axis < 3; ++axis) {
        row[axis] += course_.step_y[axis];
      }
    }
  }

  uint8_t* line_of(int32_t y) const { return first_line_ + stride_ * static_cast<size_t>(y - first_row_); }

  void store(int32_t x, int32_t y, int32_t* inks, int32_t pixels) {
    for (int32_t i = 0; i < pixels; ++i) {
      if (inks[i] < 0) [[unlikely]] {
        if (inks[i] == kAsk) {
          inks[i] = ask(frame_, x + i, y, counts_);
        }
        if (inks[i] < 0) {
          inks[i] = static_cast<int32_t>(frame_.background);
          ++misses_;
        }
      }
    }
    uint8_t* line = line_of(y);
    if (frame_.format == PixelFormat::kGray4 && pixels == kQuadPx) {
      line += x >> 1;
      line[0] = static_cast<uint8_t>(inks[0] << 4 | inks[1]);
      line[1] = static_cast<uint8_t>(inks[2] << 4 | inks[3]);
      return;
    }
    for (int32_t i = 0; i < pixels; ++i) {
      store_ink(line, x + i, y, frame_.format, static_cast<uint32_t>(inks[i]));
    }
  }

  void fill(const Tile& tile) {
    for (int32_t y = tile.y0; y < tile.y1; ++y) {
      for (int32_t x = tile.x0; x < tile.x1; ++x) {
        store_ink(line_of(y), x, y, frame_.format, frame_.background);
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

// What the affine function adds over `pixels` columns and rows at least and at most.
void spans_of(const Camera::Affine& affine, int32_t pixels, Camera::Vec3Q32* low, Camera::Vec3Q32* high) {
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t across = affine.step_x[axis] * (pixels - 1);
    const int64_t down = affine.step_y[axis] * (pixels - 1);
    (*low)[axis] = (across < 0 ? across : 0) + (down < 0 ? down : 0);
    (*high)[axis] = (across < 0 ? 0 : across) + (down < 0 ? 0 : down);
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
  Frame frame{tree, map, camera, shading, band.format, 0, {}, {}, {}, {}, {}};
  frame.background = ink_of(band.format, shade(Hit{}, Ray{}, camera, shading));
  for (int axis = 0; axis < 3; ++axis) {
    frame.side[axis] = map.box().max[axis] - map.box().min[axis];
  }
  spans_of(camera.affine(), kBrickTilePx, &frame.tile_low, &frame.tile_high);
  spans_of(camera.affine(), kQuadPx, &frame.quad_low, &frame.quad_high);
  RenderCounts done;
  Painter painter(frame, inks, band.pixels.data, stride, band.first_row, &done);
  const int32_t end = band.first_row + band.rows;
  for (int32_t y = band.first_row; y < end;) {
    const int32_t tile_end = (y / kBrickTilePx + 1) * kBrickTilePx;
    const int32_t y1 = tile_end < end ? tile_end : end;
    for (int32_t row = y; row < y1; ++row) {
      uint8_t* line = band.pixels.data + stride * static_cast<size_t>(row - band.first_row);
      for (size_t i = 0; i < line_bytes; ++i) {
        line[i] = 0;
      }
    }
    for (int32_t x = 0; x < width; x += kBrickTilePx) {
      const int32_t x1 = x + kBrickTilePx < width ? x + kBrickTilePx : width;
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
