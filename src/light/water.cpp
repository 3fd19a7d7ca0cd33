// Moving water. src/light/WATER.md proves what is claimed here: the energy never grows, heights keep their
// limits, the volume is exact.
#include "thimble/light/water.h"

#include "../base/bits.h"
#include "../base/integers.h"
#include "../base/wide_arithmetic.h"
#include "thimble/base/memory.h"

namespace thimble {
namespace {

// Fluxes fit in 16 bits with both signs alike.
constexpr int32_t kMostFlux = 32767;
// Below this, in 1/65536 voxel, nothing can be seen: heights are shown to the nearest 1/256.
constexpr int32_t kStill = 64;
constexpr int32_t kFarthestQ8 = int32_t{1} << 21;
constexpr int32_t kLeastRadiusQ8 = 384;
constexpr int32_t kMostRadiusQ8 = int32_t{1} << 14;
constexpr int32_t kMostDepthQ8 = int32_t{1} << 14;
constexpr int32_t kMostMassQ8 = int32_t{1} << 20;
constexpr int32_t kMostSpeedQ8 = int32_t{1} << 16;

// A trial push, to find the factor that gives a wanted one.
constexpr int32_t kProbe = int32_t{1} << 28;
// 1,024 voxels; fluxes are cut long before.
constexpr uint64_t kHardestPush = uint64_t{1} << 26;
constexpr uint32_t kFourByPiQ16 = 83443;  // 4 / pi
// How often a push is halved to keep within the limits: less than nothing is left after these.
constexpr int kAttempts = 34;

bool bit_of(ConstBytes bits, size_t index) {
  return (bits[index >> 3] >> (index & 7) & 1) != 0;
}

}  // namespace

Status Water::make(const WaterConfig& config, Bytes bytes, Water* water) {
  const size_t needed = water_bytes(config.width, config.depth);
  if (needed == 0 || config.least_q8 < 0 || config.least_q8 > config.rest_q8 ||
      config.rest_q8 > config.greatest_q8 || config.greatest_q8 > kMaxWaterHeightQ8 ||
      config.wave_speed_q6 < kMinWaveSpeedQ6 || config.wave_speed_q6 > kMaxWaveSpeedQ6 ||
      config.damping_q12 < 0 || config.damping_q12 > 2048) {
    return Status::kOutOfRange;
  }
  const size_t columns = static_cast<size_t>(config.width) * static_cast<size_t>(config.depth);
  if (!config.blocked.empty() && config.blocked.size != (columns + 7) / 8) {
    return Status::kBadArgument;
  }
  if (bytes.size < needed) {
    return Status::kOutOfMemory;
  }
  uint8_t* at = bytes.data + ((0U - reinterpret_cast<uintptr_t>(bytes.data)) & 3U);
  // Largest alignment first: heights, spans of rows, fluxes.
  const auto take = [&at](size_t size) -> void* {
    uint8_t* const taken = at;
    at += size;
    return taken;
  };
  Water made;
  made.heights_ = static_cast<int32_t*>(take(4 * columns));
  made.spans_ = static_cast<RowSpan*>(take(sizeof(RowSpan) * static_cast<size_t>(config.depth)));
  made.flux_x_ = static_cast<int16_t*>(take(2 * columns));
  made.flux_y_ = static_cast<int16_t*>(take(2 * columns));
  made.width_ = config.width;
  made.depth_ = config.depth;
  made.rest_ = config.rest_q8 * 256;
  made.least_ = config.least_q8 * 256;
  made.greatest_ = config.greatest_q8 * 256;
  made.lowest_ = made.rest_;
  made.highest_ = made.rest_;
  made.speed_squared_q12_ = config.wave_speed_q6 * config.wave_speed_q6;
  // The least difference that alone turns any flux round: 2 * kMostFlux / speed^2.
  const uint32_t speed_squared = static_cast<uint32_t>(made.speed_squared_q12_);
  made.steepest_ =
      static_cast<int32_t>((uint32_t{2 * kMostFlux} * 4096U + speed_squared - 1) / speed_squared);
  made.damping_q12_ = static_cast<uint32_t>(config.damping_q12);
  for (size_t column = 0; column < columns; ++column) {
    const bool is_blocked = !config.blocked.empty() && bit_of(config.blocked, column);
    made.has_blocked_ = made.has_blocked_ || is_blocked;
    made.heights_[column] = is_blocked ? -1 : made.rest_;
    made.flux_x_[column] = 0;
    made.flux_y_[column] = 0;
  }
  for (int32_t y = 0; y < config.depth; ++y) {
    made.spans_[y] = {0, 0};
  }
  *water = made;
  return Status::kOk;
}

// --- Time

// The flux from `here` to `there` after it was `flux`. What a column may give or take through one edge is a
// quarter of what there is or of what there is room for.
inline int32_t Water::next_flux(int32_t here, int32_t there, int32_t flux) {
  const int32_t fall = clamped(here - there, -steepest_, steepest_);
  // 2^13 * 2^15 + 2^28 + 2^12 at most: below 2^30.
  const int32_t both = 8192 * flux + speed_squared_q12_ * fall;
  // The sum of old and new flux is cut towards zero: that is what never adds energy, and what damps.
  uint32_t size = static_cast<uint32_t>(absolute(both));
  size -= ((size >> 10) * damping_q12_) >> 2;  // 2^20 * 2^11
  size >>= 12;
  moving_ = moving_ || size != 0;
  const int32_t wanted = (both < 0 ? -static_cast<int32_t>(size) : static_cast<int32_t>(size)) - flux;
  // Both bounds hold 0, so only the one ahead can be in the way.
  if (wanted >= 0) {
    return lesser(wanted, lesser(lesser(here - least_, greatest_ - there) >> 2, kMostFlux));
  }
  return greater(wanted, -lesser(lesser(there - least_, greatest_ - here) >> 2, kMostFlux));
}

// Fluxes of columns first .. end - 1 of a row to their neighbours on the right and below. Between blocked
// columns, and across the border, they stay 0.
void Water::edges_of_row(int32_t y, int32_t first, int32_t end) {
  const size_t row = index(0, y);
  const bool has_below = y + 1 < depth_;
  for (int32_t x = first; x < end; ++x) {
    const size_t column = row + static_cast<size_t>(x);
    const int32_t here = heights_[column];
    if (here < 0) {
      continue;
    }
    if (x + 1 < width_ && heights_[column + 1] >= 0) {
      flux_x_[column] = static_cast<int16_t>(next_flux(here, heights_[column + 1], flux_x_[column]));
    }
    const size_t below = column + static_cast<size_t>(width_);
    if (has_below && heights_[below] >= 0) {
      flux_y_[column] = static_cast<int16_t>(next_flux(here, heights_[below], flux_y_[column]));
    }
  }
}

// Heights of columns first .. end - 1 of a row, from the fluxes; which of them are not at rest afterwards.
Water::RowSpan Water::heights_of_row(int32_t y, int32_t first, int32_t end) {
  RowSpan span{0, 0};
  const size_t row = index(0, y);
  for (int32_t x = first; x < end; ++x) {
    const size_t column = row + static_cast<size_t>(x);
    if (heights_[column] < 0) {
      continue;
    }
    const int32_t right = flux_x_[column];
    const int32_t below = flux_y_[column];
    const int32_t left = x > 0 ? flux_x_[column - 1] : 0;
    const int32_t above = y > 0 ? flux_y_[column - static_cast<size_t>(width_)] : 0;
    const int32_t height = heights_[column] + left + above - right - below;
    heights_[column] = height;
    lowest_ = lesser(lowest_, height);
    highest_ = greater(highest_, height);
    if (height != rest_ || right != 0 || below != 0) {
      visible_ = visible_ || !is_within(height - rest_, kStill) || !is_within(right, kStill) ||
                 !is_within(below, kStill);
      span.first = span.end == 0 ? static_cast<uint16_t>(x) : span.first;
      span.end = static_cast<uint16_t>(x + 1);
    }
  }
  return span;
}

void Water::step() {
  if (still_) {
    return;
  }
  lowest_ = rest_;
  highest_ = rest_;
  moving_ = false;
  visible_ = false;
  RowSpan above{0, 0};
  for (int32_t y = 0; y < depth_; ++y) {
    // What may change: what is not at rest, and its neighbours. The row above was overwritten already, the
    // row below not yet.
    const RowSpan own = spans_[y];
    const RowSpan below = y + 1 < depth_ ? spans_[y + 1] : RowSpan{0, 0};
    int32_t first = width_;
    int32_t end = 0;
    if (own.first != own.end) {
      first = greater(own.first - 1, 0);
      end = lesser(own.end + 1, width_);
    }
    const RowSpan others[2] = {above, below};
    for (const RowSpan& other : others) {
      if (other.first != other.end) {
        first = lesser(first, other.first);
        end = greater(end, other.end);
      }
    }
    above = own;
    if (first >= end) {
      continue;
    }
    edges_of_row(y, first, end);
    spans_[y] = heights_of_row(y, first, end);
    columns_updated_ += static_cast<uint32_t>(end - first);
  }
  ++steps_done_;
  if (!visible_ || (!moving_ && quiet_)) {
    lay_to_rest();
  }
  quiet_ = !moving_;
}

// Every column to the rest level. What this takes from some columns it gives to others of the same basin, as
// the volume of each has been kept exactly since all were at rest.
void Water::lay_to_rest() {
  for (int32_t y = 0; y < depth_; ++y) {
    const size_t row = index(0, y);
    for (int32_t x = spans_[y].first; x < spans_[y].end; ++x) {
      const size_t column = row + static_cast<size_t>(x);
      heights_[column] = heights_[column] < 0 ? -1 : rest_;
      flux_x_[column] = 0;
      flux_y_[column] = 0;
    }
    spans_[y] = {0, 0};
  }
  lowest_ = rest_;
  highest_ = rest_;
  still_ = true;
}

// --- Disturbance

// A push: a dome over a disc, top * (1 - s)^3 with s = (distance / radius)^2. Water goes down its slopes:
// what passes an edge is the difference of the two columns' pushes, so nothing is lost to rounding.
struct Water::Bowl {
  int32_t x_q8 = 0;
  int32_t y_q8 = 0;
  uint32_t radius_squared = 0;  // Q16: 2^17 .. 2^28
  int shift = 0;                // brings it to 2^28 .. 2^29
  int64_t top = 0;              // in 1/65536 voxel, but for the factor that `shift` leaves; up to 2^34
};

// Columns whose height or fluxes a bowl can change.
struct Water::Region {
  int32_t first_x = 0;
  int32_t end_x = 0;
  int32_t first_y = 0;
  int32_t end_y = 0;
};

Water::Bowl Water::bowl_at(int32_t x_q8, int32_t y_q8, int32_t radius_q8) {
  const int32_t radius = greater(radius_q8, kLeastRadiusQ8);
  Bowl bowl;
  bowl.x_q8 = x_q8;
  bowl.y_q8 = y_q8;
  bowl.radius_squared = static_cast<uint32_t>(radius * radius);
  bowl.shift = 29 - bits::bit_length(bowl.radius_squared);
  bowl.top = kProbe;
  return bowl;
}

// The push at a distance, its square in Q16.
int32_t Water::push(const Bowl& bowl, uint32_t squared) {
  if (squared >= bowl.radius_squared) {
    return 0;
  }
  const uint64_t left = static_cast<uint64_t>(bowl.radius_squared - squared) << bowl.shift;  // below 2^29
  const uint64_t cubed = ((left * left >> 29) * left) >> 29;
  const uint64_t size = (magnitude(bowl.top) * cubed) >> 29;
  return bowl.top < 0 ? -static_cast<int32_t>(size) : static_cast<int32_t>(size);
}

// The same above the middle of a column within the region: each difference is below 2^14 + 2^10.
int32_t Water::push_at(const Bowl& bowl, int32_t x, int32_t y) {
  const int32_t dx = 256 * x + 128 - bowl.x_q8;
  const int32_t dy = 256 * y + 128 - bowl.y_q8;
  return push(bowl, static_cast<uint32_t>(dx * dx + dy * dy));
}

// What a column loses under a push, through its open edges.
int32_t Water::loss(const Bowl& bowl, int32_t x, int32_t y) const {
  const int32_t own = push_at(bowl, x, y);
  int32_t sum = 0;
  for (int side = 0; side < 4; ++side) {
    const int32_t step = (side & 1) != 0 ? 1 : -1;
    const int32_t to_x = x + (side < 2 ? step : 0);
    const int32_t to_y = y + (side < 2 ? 0 : step);
    if (to_x >= 0 && to_x < width_ && to_y >= 0 && to_y < depth_ && !is_blocked(to_x, to_y)) {
      sum += own - push_at(bowl, to_x, to_y);
    }
  }
  return sum;
}

Water::Region Water::region(const Bowl& bowl, int32_t radius_q8) const {
  const int32_t reach = greater(radius_q8, kLeastRadiusQ8) + 256;
  return {greater((bowl.x_q8 - reach) >> 8, 0), lesser(((bowl.x_q8 + reach) >> 8) + 1, width_),
          greater((bowl.y_q8 - reach) >> 8, 0), lesser(((bowl.y_q8 + reach) >> 8) + 1, depth_)};
}

void Water::wake(const Region& region) {
  for (int32_t y = region.first_y; y < region.end_y; ++y) {
    RowSpan& span = spans_[y];
    const bool was_empty = span.first == span.end;
    span.first = static_cast<uint16_t>(was_empty ? region.first_x : lesser(span.first, region.first_x));
    span.end = static_cast<uint16_t>(was_empty ? region.end_x : greater(span.end, region.end_x));
  }
  still_ = false;
  quiet_ = false;
}

// Whether all heights in a region would keep within their limits.
bool Water::bears(const Bowl& bowl, const Region& region) const {
  for (int32_t y = region.first_y; y < region.end_y; ++y) {
    for (int32_t x = region.first_x; x < region.end_x; ++x) {
      if (!is_blocked(x, y)) {
        const int32_t height = heights_[index(x, y)] - loss(bowl, x, y);
        if (height < least_ || height > greatest_) {
          return false;
        }
      }
    }
  }
  return true;
}

Status Water::touch(int32_t x_q8, int32_t y_q8, int32_t radius_q8, int32_t depth_q8) {
  if (!is_within(x_q8, kFarthestQ8) || !is_within(y_q8, kFarthestQ8) || radius_q8 < 0 ||
      radius_q8 > kMostRadiusQ8 || !is_within(depth_q8, kMostDepthQ8)) {
    return Status::kOutOfRange;
  }
  Bowl bowl = bowl_at(x_q8, y_q8, radius_q8);
  const Region reached = region(bowl, radius_q8);
  if (reached.first_x >= reached.end_x || reached.first_y >= reached.end_y || depth_q8 == 0) {
    return Status::kOk;
  }
  // The push that sinks the column under the point by `depth_q8` where no wall is near: that of a trial, in
  // proportion. The column's loss in the trial is at least 2^28 / 8 * 12 / 64^2 / 2.
  const int32_t x = x_q8 >> 8;
  const int32_t y = y_q8 >> 8;
  const int32_t trial = 4 * push_at(bowl, x, y) - push_at(bowl, x - 1, y) - push_at(bowl, x + 1, y) -
                        push_at(bowl, x, y - 1) - push_at(bowl, x, y + 1);
  const uint64_t wanted = static_cast<uint64_t>(absolute(depth_q8)) * 256U * kProbe;  // up to 2^50
  bowl.top = with_sign_of(depth_q8, divide(wanted, static_cast<uint64_t>(trial)));
  for (int attempt = 0; !bears(bowl, reached); ++attempt) {
    if (attempt == kAttempts) {
      return Status::kOk;
    }
    bowl.top = with_sign_of(bowl.top, magnitude(bowl.top) >> 1);
  }
  for (int32_t row = reached.first_y; row < reached.end_y; ++row) {
    for (int32_t column = reached.first_x; column < reached.end_x; ++column) {
      if (!is_blocked(column, row)) {
        int32_t& height = heights_[index(column, row)];
        height -= loss(bowl, column, row);
        lowest_ = lesser(lowest_, height);
        highest_ = greater(highest_, height);
      }
    }
  }
  wake(reached);
  return Status::kOk;
}

Status Water::drop(int32_t x_q8, int32_t y_q8, int32_t radius_q8, int32_t mass_q8, int32_t speed_q8) {
  if (!is_within(x_q8, kFarthestQ8) || !is_within(y_q8, kFarthestQ8) || radius_q8 < 0 ||
      radius_q8 > kMostRadiusQ8 || mass_q8 < 0 || mass_q8 > kMostMassQ8 ||
      !is_within(speed_q8, kMostSpeedQ8)) {
    return Status::kOutOfRange;
  }
  Bowl bowl = bowl_at(x_q8, y_q8, radius_q8);
  const Region reached = region(bowl, radius_q8);
  if (reached.first_x >= reached.end_x || reached.first_y >= reached.end_y || mass_q8 == 0 || speed_q8 == 0) {
    return Status::kOk;
  }
  // The push adds up to the momentum over the disc: a dome's volume is top * pi / 4 * radius^2. 2^36 * 2^17.
  const uint64_t momentum = static_cast<uint64_t>(wide_product(mass_q8, absolute(speed_q8)));
  uint64_t top = divide(momentum * kFourByPiQ16, bowl.radius_squared);
  top = top < kHardestPush ? top : kHardestPush;
  bowl.top = with_sign_of(speed_q8, divide(top * kProbe, static_cast<uint64_t>(push(bowl, 0))));
  for (int32_t y = reached.first_y; y < reached.end_y; ++y) {
    for (int32_t x = reached.first_x; x < reached.end_x; ++x) {
      if (is_blocked(x, y)) {
        continue;
      }
      const int32_t own = push_at(bowl, x, y);
      const size_t column = index(x, y);
      if (x + 1 < width_ && !is_blocked(x + 1, y)) {
        flux_x_[column] = static_cast<int16_t>(
            clamped(flux_x_[column] + own - push_at(bowl, x + 1, y), -kMostFlux, kMostFlux));
      }
      if (y + 1 < depth_ && !is_blocked(x, y + 1)) {
        flux_y_[column] = static_cast<int16_t>(
            clamped(flux_y_[column] + own - push_at(bowl, x, y + 1), -kMostFlux, kMostFlux));
      }
    }
  }
  wake(reached);
  return Status::kOk;
}

// --- What is there

WaterSurface Water::surface(const Vec3i& corner) const {
  if (still_ && !has_blocked_) {
    return still_water(corner, width_, depth_, rest_q8());
  }
  return {corner, width_, depth_, lowest_q8(), highest_q8(), heights_, has_blocked_};
}

uint64_t Water::volume_q16() const {
  uint64_t sum = 0;
  const size_t columns = static_cast<size_t>(width_) * static_cast<size_t>(depth_);
  for (size_t column = 0; column < columns; ++column) {
    sum += static_cast<uint32_t>(greater(heights_[column], 0));
  }
  return sum;
}

uint32_t Water::state_crc32() const {
  uint32_t crc = 0;
  const size_t columns = static_cast<size_t>(width_) * static_cast<size_t>(depth_);
  uint8_t bytes[4];
  for (size_t column = 0; column < columns; ++column) {
    bits::store32(bytes, static_cast<uint32_t>(heights_[column]));
    crc = crc32(bytes, crc);
  }
  const int16_t* const along[2] = {flux_x_, flux_y_};
  for (const int16_t* const fluxes : along) {
    for (size_t column = 0; column < columns; ++column) {
      bits::store16(bytes, static_cast<uint16_t>(fluxes[column]));
      crc = crc32({bytes, 2}, crc);
    }
  }
  return crc;
}

}  // namespace thimble
