// Which bricks have nothing behind them towards a distant light: all bricks that a ray from somewhere in one can pass
// through, layer by layer along the axis on which the light's rays move fastest.
#include "../base/bits.h"
#include "../tree/deep_map.h"
#include "thimble/light/host/optics.h"
#include "thimble/light/map_render.h"

namespace thimble {

size_t SunBricks::bytes(const BrickMap& map) {
  if (DeepMap::is_deep(map.level())) {
    return 0;
  }
  const Vec3i& low = map.box().low;
  const Vec3i& high = map.box().high;
  return (static_cast<size_t>((high.x - low.x) * (high.y - low.y) * (high.z - low.z)) + 7) / 8;
}

Status SunBricks::make(const BrickMap& map, const Vec3i& towards, Bytes room, SunBricks* sun) {
  const size_t size = bytes(map);
  if (map.directory() == nullptr || towards == Vec3i{}) {
    return Status::kBadArgument;
  }
  if (DeepMap::is_deep(map.level())) {
    return Status::kOutOfRange;
  }
  if (room.size < size || (size != 0 && room.data == nullptr)) {
    return Status::kOutOfMemory;
  }
  for (size_t i = 0; i < size; ++i) {
    room[i] = 0;
  }
  SunBricks result;
  result.bits_ = room.data;
  result.directory_ = map.directory();
  result.towards_ = towards;
  for (int axis = 0; axis < 3; ++axis) {
    result.side_[axis] = map.box().high[axis] - map.box().low[axis];
  }
  result.cells_ = static_cast<uint32_t>(result.side_.x * result.side_.y * result.side_.z);
  *sun = result;
  return Status::kOk;
}

bool SunBricks::prove(uint32_t bricks) {
  const uint32_t left = cells_ - done_;
  const uint32_t end = done_ + (bricks < left ? bricks : left);
  const auto width = static_cast<uint32_t>(side_.x);
  const auto depth = static_cast<uint32_t>(side_.y);
  for (; done_ < end; ++done_) {
    const uint32_t row = done_ / width;
    if (is_free({static_cast<int32_t>(done_ % width), static_cast<int32_t>(row % depth),
                 static_cast<int32_t>(row / depth)})) {
      bits_[done_ >> 3] = static_cast<uint8_t>(bits_[done_ >> 3] | 1U << (done_ & 7U));
    }
  }
  return done_ < cells_;
}

// In the mirrored numbering, where rays go up on all axes: a ray from brick (a, b, c) that is k layers further on has
// moved by more than k - 1 and less than k + 1 bricks along c, and d_a / d_c times that along a.
bool SunBricks::is_free(const Vec3i& brick) const {
  const Vec3i direction = shorten(towards_);
  int32_t d[3];
  int32_t at[3];
  int32_t step[3];
  int c = 0;
  int32_t stride = 2;
  int32_t offset = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const bool flipped = direction[axis] < 0;
    d[axis] = flipped ? -direction[axis] : direction[axis];
    c = d[axis] > d[c] ? axis : c;
    at[axis] = flipped ? side_[axis] - 1 - brick[axis] : brick[axis];
    offset += brick[axis] * stride;
    step[axis] = flipped ? -stride : stride;
    stride *= side_[axis];
  }
  const int a = c == 0 ? 1 : 0;
  const int b = c == 2 ? 1 : 2;
  for (int32_t k = 0; at[c] + k < side_[c]; ++k) {
    const int32_t back = k == 0 ? 0 : k - 1;
    const int32_t last_a = side_[a] - 1 - at[a];
    const int32_t last_b = side_[b] - 1 - at[b];
    const int32_t from_a = back * d[a] / d[c];
    const int32_t from_b = back * d[b] / d[c];
    int32_t to_a = ((k + 1) * d[a] + d[c] - 1) / d[c];
    int32_t to_b = ((k + 1) * d[b] + d[c] - 1) / d[c];
    if (from_a > last_a || from_b > last_b) {
      return true;
    }
    to_a = to_a < last_a ? to_a : last_a;
    to_b = to_b < last_b ? to_b : last_b;
    for (int32_t j = from_b; j <= to_b; ++j) {
      for (int32_t i = from_a; i <= to_a; ++i) {
        const bool itself = k == 0 && i == 0 && j == 0;
        if (!itself && bits::load16(directory_ + offset + k * step[c] + i * step[a] + j * step[b]) != 0) {
          return false;
        }
      }
    }
  }
  return true;
}

}  // namespace thimble
