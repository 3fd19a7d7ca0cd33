// Which bricks have nothing behind them towards a distant light: all bricks that a ray from somewhere in one can pass
// through, layer by layer along the axis on which the light's rays move fastest. Of level 9 and 10 how far along that axis
// rays may meet something, for each cell of a plane across them.
#include "../base/bits.h"
#include "../picture/bricks/layout.h"
#include "../picture/bricks/sun_plane.h"
#include "../tree/deep_map.h"
#include "thimble/light/host/optics.h"
#include "thimble/light/map_render.h"
#include "thimble/tree/edited_world.h"

namespace thimble {

using bricks::SunPlane;

size_t SunBricks::bytes(const BrickMap& map) {
  const Vec3i& low = map.box().low;
  const Vec3i& high = map.box().high;
  if (DeepMap::is_deep(map.level())) {
    // Along the light's fastest axis, whichever that is, cells move by as many as there are layers at most.
    const Vec3i side{high.x - low.x, high.y - low.y, high.z - low.z};
    int32_t most = 0;
    for (int c = 0; c < 3; ++c) {
      const int32_t cells = (side[c == 0 ? 1 : 0] + side[c] + 1) * (side[c == 2 ? 1 : 2] + side[c] + 1);
      most = cells > most ? cells : most;
    }
    return static_cast<size_t>(most);
  }
  return (static_cast<size_t>((high.x - low.x) * (high.y - low.y) * (high.z - low.z)) + 7) / 8;
}

Status SunBricks::make(const BrickMap& map, const Vec3i& towards, Bytes room, SunBricks* sun) {
  const size_t size = bytes(map);
  if (map.directory() == nullptr || towards == Vec3i{}) {
    return Status::kBadArgument;
  }
  if (room.size < size || (size != 0 && room.data == nullptr)) {
    return Status::kOutOfMemory;
  }
  const bool is_deep = DeepMap::is_deep(map.level());
  for (size_t i = 0; i < size; ++i) {
    room[i] = is_deep ? SunPlane::kAll : 0;
  }
  SunBricks result;
  result.bits_ = room.data;
  result.directory_ = map.directory();
  result.stamp_ = map.stamp();
  result.towards_ = towards;
  for (int axis = 0; axis < 3; ++axis) {
    result.side_[axis] = map.box().high[axis] - map.box().low[axis];
  }
  result.cells_ = static_cast<uint32_t>(result.side_.x * result.side_.y * result.side_.z);
  if (is_deep) {
    result.set_deep();
  }
  *sun = result;
  return Status::kOk;
}

// How the light's rays move in the mirrored numbering, where they go up on all axes: fastest along c.
struct SunBricks::Way {
  explicit Way(const Vec3i& towards) {
    const Vec3i direction = shorten(towards);
    for (int axis = 0; axis < 3; ++axis) {
      flipped[axis] = direction[axis] < 0;
      d[axis] = flipped[axis] ? -direction[axis] : direction[axis];
      c = d[axis] > d[c] ? axis : c;
    }
    a = c == 0 ? 1 : 0;
    b = c == 2 ? 1 : 2;
  }
  // A ray that is k layers further on has moved by more than k - 1 and less than k + 1 bricks along c, and d_a / d_c times
  // that along another axis: at least and at most so many bricks.
  int32_t least(int axis, int32_t k) const { return (k == 0 ? 0 : k - 1) * d[axis] / d[c]; }
  int32_t most(int axis, int32_t k) const { return ((k + 1) * d[axis] + d[c] - 1) / d[c]; }
  // Of level 9 and 10, for a box of so many bricks.
  SunPlane plane(const Vec3i& side) const {
    SunPlane result;
    result.set(0, d[a] * (1 << 16) / d[c], side[a], side[c]);
    result.set(1, d[b] * (1 << 16) / d[c], side[b], side[c]);
    return result;
  }

  int32_t d[3];
  bool flipped[3];
  int c = 0;
  int a;
  int b;
};

bool SunBricks::prove(uint32_t bricks) {
  const uint32_t left = cells_ - done_;
  const uint32_t end = done_ + (bricks < left ? bricks : left);
  for (; done_ < end; ++done_) {
    prove_cell(done_);
  }
  return done_ < cells_;
}

void SunBricks::set_deep() {
  const SunPlane plane = Way(towards_).plane(side_);
  is_deep_ = true;
  cells_ = static_cast<uint32_t>(plane.count[0] * plane.count[1]);
}

// Lowers a cell of the plane to the last layer in which its rays may pass a brick that is not empty.
void SunBricks::lower(uint32_t cell) {
  const Way way(towards_);
  const SunPlane plane = way.plane(side_);
  const auto width = static_cast<uint32_t>(plane.count[0]);
  const int32_t at[2] = {static_cast<int32_t>(cell % width), static_cast<int32_t>(cell / width)};
  const uint32_t empty_page = bricks::empty_page_of(side_);
  // Whether rays of the cell may pass something from layer `first` to `last`; of whole pages, if several.
  const auto meets = [&](int32_t first, int32_t last) {
    Vec3i low;
    Vec3i high;
    const auto set = [&](int on, int32_t from, int32_t to) {
      from = from < 0 ? 0 : from;
      to = to < side_[on] ? to : side_[on] - 1;
      low[on] = way.flipped[on] ? side_[on] - 1 - to : from;
      high[on] = way.flipped[on] ? side_[on] - 1 - from : to;
      return from <= to;
    };
    if (!set(way.c, first, last) || !set(way.a, plane.first(0, at[0], first), plane.last(0, at[0], last)) ||
        !set(way.b, plane.first(1, at[1], first), plane.last(1, at[1], last))) {
      return false;
    }
    if (first != last) {
      return !bricks::has_empty_pages(directory_, empty_page, low, high);
    }
    for (int32_t z = low.z; z <= high.z; ++z) {
      for (int32_t y = low.y; y <= high.y; ++y) {
        for (int32_t x = low.x; x <= high.x; ++x) {
          if (bricks::number_at<true>(directory_, x + (y << 8) + (z << 16)) != 0) {
            return true;
          }
        }
      }
    }
    return false;
  };
  int32_t layers = bits_[cell] == SunPlane::kAll ? side_[way.c] : bits_[cell];
  while (layers > 0) {
    // Goes by pages where one ends.
    const int32_t own = way.flipped[way.c] ? side_[way.c] - layers : layers;
    const int32_t some = (own & 3) == 0 && layers > 3 ? 4 : 1;
    if (!meets(layers - some, layers - 1)) {
      layers -= some;
    } else if (some == 1 || meets(layers - 1, layers - 1)) {
      break;
    } else {
      --layers;
    }
  }
  bits_[cell] = static_cast<uint8_t>(layers < SunPlane::kAll ? layers : SunPlane::kAll);
}

void SunBricks::prove_cell(uint32_t cell) {
  if constexpr (kDeepWorlds) {
    if (is_deep_) {
      lower(cell);
      return;
    }
  }
  const auto width = static_cast<uint32_t>(side_.x);
  const auto depth = static_cast<uint32_t>(side_.y);
  const uint32_t row = cell / width;
  if (is_free({static_cast<int32_t>(cell % width), static_cast<int32_t>(row % depth),
               static_cast<int32_t>(row / depth)})) {
    bits_[cell >> 3] = static_cast<uint8_t>(bits_[cell >> 3] | 1U << (cell & 7U));
  }
}

bool SunBricks::is_free(const Vec3i& brick) const {
  const Way way(towards_);
  int32_t at[3];
  int32_t step[3];
  int32_t stride = 2;
  int32_t offset = 0;
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = way.flipped[axis] ? side_[axis] - 1 - brick[axis] : brick[axis];
    offset += brick[axis] * stride;
    step[axis] = way.flipped[axis] ? -stride : stride;
    stride *= side_[axis];
  }
  const int a = way.a;
  const int b = way.b;
  for (int32_t k = 0; at[way.c] + k < side_[way.c]; ++k) {
    const int32_t last_a = side_[a] - 1 - at[a];
    const int32_t last_b = side_[b] - 1 - at[b];
    const int32_t from_a = way.least(a, k);
    const int32_t from_b = way.least(b, k);
    int32_t to_a = way.most(a, k);
    int32_t to_b = way.most(b, k);
    if (from_a > last_a || from_b > last_b) {
      return true;
    }
    to_a = to_a < last_a ? to_a : last_a;
    to_b = to_b < last_b ? to_b : last_b;
    for (int32_t j = from_b; j <= to_b; ++j) {
      for (int32_t i = from_a; i <= to_a; ++i) {
        const bool itself = k == 0 && i == 0 && j == 0;
        if (!itself && bits::load16(directory_ + offset + k * step[way.c] + i * step[a] + j * step[b]) != 0) {
          return false;
        }
      }
    }
  }
  return true;
}

// ---- worlds that are edited

// Of level 9 and 10: calls each(cell) for the cells of a row of the plane whose rays may pass a box of bricks.
template <class Each>
void SunBricks::each_in_row(const Way& way, const VoxelBox& box, int32_t row, uint32_t first,
                            const Each& each) const {
  const SunPlane plane = way.plane(side_);
  int32_t low[2];
  int32_t high[2];
  for (int k = 0; k < 2; ++k) {
    const int axis = k == 0 ? way.a : way.b;
    const int32_t last = plane.count[k] - 1;
    low[k] = box.low[axis] - (box.high[way.c] * plane.slope[k] >> 16) + plane.lead[k] - 2;
    high[k] = box.high[axis] - (box.low[way.c] * plane.slope[k] >> 16) + plane.lead[k];
    low[k] = low[k] < 0 ? 0 : low[k];
    high[k] = high[k] < last ? high[k] : last;
  }
  const int32_t from = low[0] + static_cast<int32_t>(first);
  for (int32_t i = from; i <= high[0] && row >= low[1] && row <= high[1]; ++i) {
    if (!each(static_cast<uint32_t>(row * plane.count[0] + i))) {
      return;
    }
  }
}

// Calls each(cell) for the bricks of a layer from which rays may come to a box of bricks, both mirrored, from the
// `first` of them on, until it is false.
template <class Each>
void SunBricks::each_behind(const Way& way, const VoxelBox& box, int32_t layer, uint32_t first,
                            const Each& each) const {
  if constexpr (kDeepWorlds) {
    if (is_deep_) {
      each_in_row(way, box, layer, first, each);
      return;
    }
  }
  const int32_t k_most = box.high[way.c] - 1 - layer;
  if (k_most < 0) {
    return;
  }
  const int32_t k_least = box.low[way.c] > layer ? box.low[way.c] - layer : 0;
  int32_t low[3] = {};
  int32_t size[3] = {};
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == way.c) {
      continue;
    }
    const int32_t from = box.low[axis] - way.most(axis, k_most);
    const int32_t end = box.high[axis] - way.least(axis, k_least);
    low[axis] = from < 0 ? 0 : from;
    size[axis] = end > low[axis] ? end - low[axis] : 0;
  }
  const auto width = static_cast<uint32_t>(size[way.a]);
  const uint32_t count = width * static_cast<uint32_t>(size[way.b]);
  for (uint32_t number = first; number < count; ++number) {
    int32_t at[3];
    at[way.c] = layer;
    at[way.a] = low[way.a] + static_cast<int32_t>(number % width);
    at[way.b] = low[way.b] + static_cast<int32_t>(number / width);
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = way.flipped[axis] ? side_[axis] - 1 - at[axis] : at[axis];
    }
    if (!each(static_cast<uint32_t>((at[2] * side_.y + at[1]) * side_.x + at[0]))) {
      return;
    }
  }
}

bool SunBricks::follow(const EditedWorld& world, uint32_t bricks) {
  if (bits_ == nullptr || world.map().directory() != directory_) {
    return false;
  }
  const Way way(towards_);
  const int32_t layers = is_deep_ ? way.plane(side_).count[1] : side_[way.c];
  if (world.map().stamp() != stamp_) {
    // What was changed since these bits were last right is within the box, if it was empty then or later.
    const bool known = static_cast<int32_t>(world.changed_from() - stamp_) <= 0;
    const bool is_new = edited_.empty();
    VoxelBox box;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t low = known ? world.changed().low[axis] >> 2 : 0;
      const int32_t high = known ? (world.changed().high[axis] + 3) >> 2 : side_[axis];
      box.low[axis] = way.flipped[axis] ? side_[axis] - high : low;
      box.high[axis] = way.flipped[axis] ? side_[axis] - low : high;
      edited_.low[axis] = is_new || box.low[axis] < edited_.low[axis] ? box.low[axis] : edited_.low[axis];
      edited_.high[axis] =
          is_new || box.high[axis] > edited_.high[axis] ? box.high[axis] : edited_.high[axis];
    }
    const auto most =
        static_cast<uint8_t>(box.high[way.c] < SunPlane::kAll ? box.high[way.c] : SunPlane::kAll);
    for (int32_t layer = 0; layer < layers; ++layer) {
      each_behind(way, box, layer, 0, [&](uint32_t cell) {
        if (is_deep_) {
          bits_[cell] = bits_[cell] < most ? most : bits_[cell];
        } else {
          bits_[cell >> 3] = static_cast<uint8_t>(bits_[cell >> 3] & ~(1U << (cell & 7U)));
        }
        return true;
      });
    }
    stamp_ = world.map().stamp();
    layers_left_ = static_cast<uint32_t>(layers) + 1;  // the one that was begun is looked at again
  }
  const uint32_t left = cells_ - done_;
  if (prove(bricks)) {
    return true;
  }
  bricks -= bricks < left ? bricks : left;
  while (layers_left_ != 0) {
    each_behind(way, edited_, layer_, in_layer_, [this, &bricks](uint32_t cell) {
      if (bricks == 0) {
        return false;
      }
      --bricks;
      ++in_layer_;
      if (is_deep_ || (uint32_t{bits_[cell >> 3]} >> (cell & 7U) & 1U) == 0) {
        prove_cell(cell);
      }
      return true;
    });
    if (bricks == 0) {
      return true;
    }
    --layers_left_;
    in_layer_ = 0;
    layer_ = layer_ + 1 < layers ? layer_ + 1 : 0;
  }
  edited_ = {};
  return false;
}

}  // namespace thimble
