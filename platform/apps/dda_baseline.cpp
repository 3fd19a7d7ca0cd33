#include "dda_baseline.h"

#include "thimble/trace/ray.h"

namespace thimble::apps {
namespace {

// Distances along a ray in 16.16, in lengths of its direction scaled to 1/65536.
constexpr uint32_t kFar = 0x7FFFFFFF;

uint32_t scaled(uint32_t distance_q8, uint32_t per_voxel_q16) {
  const uint64_t product = uint64_t{distance_q8} * per_voxel_q16 >> 8;
  return product < kFar ? static_cast<uint32_t>(product) : kFar;
}

// One ray: what is constant over the frame, then what changes.
struct Rays {
  const uint8_t* bits;
  int32_t origin_q8[3];
  int32_t low[3];
  int32_t high[3];
  int32_t stride[3];
};

// The face met, 2 * axis + side, or -1.
int32_t trace_dda(const Rays& rays, const int32_t (&direction)[3]) {
  uint32_t delta[3];
  uint32_t enter = 0;
  uint32_t leave = kFar;
  int32_t axis = 0;
  for (int a = 0; a < 3; ++a) {
    const int32_t d = direction[a];
    const int32_t below = rays.low[a] * 256 - rays.origin_q8[a];
    const int32_t above = rays.high[a] * 256 - rays.origin_q8[a];
    if (d == 0) {
      if (below > 0 || above <= 0) {
        return -1;
      }
      delta[a] = kFar;
      continue;
    }
    const uint32_t size = static_cast<uint32_t>(d < 0 ? -d : d);
    delta[a] = (uint32_t{1} << 28) / size;  // 16.16 for directions of 12 bits
    const int32_t near_q8 = d > 0 ? below : -above;
    const int32_t far_q8 = d > 0 ? above : -below;
    if (far_q8 <= 0) {
      return -1;
    }
    if (near_q8 > 0) {
      const uint32_t t = scaled(static_cast<uint32_t>(near_q8), delta[a]);
      if (t > enter) {
        enter = t;
        axis = a;
      }
    }
    const uint32_t t = scaled(static_cast<uint32_t>(far_q8), delta[a]);
    leave = t < leave ? t : leave;
  }
  if (enter >= leave) {
    return -1;
  }
  uint32_t next[3];
  int32_t address = 0;
  int32_t step[3];
  for (int a = 0; a < 3; ++a) {
    const int32_t d = direction[a];
    // Where the ray is at `enter`, in 1/256 voxel.
    const int32_t at = rays.origin_q8[a] + static_cast<int32_t>(int64_t{d} * enter >> 20);
    int32_t cell = at >> 8;
    if (enter != 0 && a == axis) {
      cell = d > 0 ? rays.low[a] : rays.high[a] - 1;
    }
    cell = cell < rays.low[a] ? rays.low[a] : cell >= rays.high[a] ? rays.high[a] - 1 : cell;
    const int32_t plane = (d > 0 ? cell + 1 : cell) * 256 - rays.origin_q8[a];
    next[a] = d == 0 ? kFar : scaled(static_cast<uint32_t>(plane < 0 ? -plane : plane), delta[a]);
    address += cell * rays.stride[a];
    step[a] = d < 0 ? -rays.stride[a] : rays.stride[a];
  }
  uint32_t x = next[0];
  uint32_t y = next[1];
  uint32_t z = next[2];
  const uint8_t* bits = rays.bits;
  const uint32_t dx = delta[0];
  const uint32_t dy = delta[1];
  const uint32_t dz = delta[2];
  for (;;) {
    if ((bits[address >> 3] >> (address & 7) & 1) != 0) {
      return 2 * axis + (direction[axis] < 0 ? 1 : 0);
    }
    if (x < y) {
      if (x < z) {
        if (x >= leave) {
          return -1;
        }
        address += step[0];
        x += dx;
        axis = 0;
        continue;
      }
    } else if (y < z) {
      if (y >= leave) {
        return -1;
      }
      address += step[1];
      y += dy;
      axis = 1;
      continue;
    }
    if (z >= leave) {
      return -1;
    }
    address += step[2];
    z += dz;
    axis = 2;
  }
}

}  // namespace

bool fill_bit_world(const CompactTree& tree, Bytes out, BitWorld* world) {
  if (tree.level() > 8 || out.size < bit_world_bytes(tree.level())) {
    return false;
  }
  for (uint8_t& byte : out) {
    byte = 0;
  }
  const int level = tree.level();
  const int32_t side = int32_t{1} << level;
  for (int32_t z = 0; z < side; ++z) {
    for (int32_t y = 0; y < side; ++y) {
      for (int32_t x = 0; x < side; ++x) {
        const Ray ray{{Q8::from_raw(256 * x + 128), Q8::from_raw(256 * y + 128), Q8::from_raw(256 * z + 128)},
                      {1, 0, 0}};
        Hit hit;
        if (closest_hit(tree, ray, &hit) == Status::kOk && hit.kind == HitKind::kHit && hit.axis < 0) {
          const auto bit = static_cast<uint32_t>(x + (y << level) + (z << 2 * level));
          out[bit >> 3] = static_cast<uint8_t>(out[bit >> 3] | 1U << (bit & 7));
        }
      }
    }
  }
  *world = {out.data, level, tree.bounds()};
  return true;
}

uint32_t draw_dda(const BitWorld& world, const Camera& camera, const uint8_t (&face_gray)[6],
                  uint8_t background, int32_t first_row, int32_t rows, uint8_t* pixels) {
  Rays rays{};
  rays.bits = world.bits;
  // Directions in 12 bits, from the camera's own bits; per pixel an addition in 16.16 each.
  const int shift = 16 - (12 - camera.direction_bits());
  int32_t row_start[3];
  int32_t across[3];
  int32_t down[3];
  for (int axis = 0; axis < 3; ++axis) {
    rays.origin_q8[axis] = camera.eye()[axis].raw;
    rays.low[axis] = world.bounds.low[axis];
    rays.high[axis] = world.bounds.high[axis];
    rays.stride[axis] = int32_t{1} << (axis * world.level);
    const Camera::Affine& affine = camera.affine();
    // Half a unit, so that cutting off rounds.
    row_start[axis] =
        static_cast<int32_t>((affine.base[axis] + first_row * affine.step_y[axis]) >> shift) + 0x8000;
    across[axis] = static_cast<int32_t>(affine.step_x[axis] >> shift);
    down[axis] = static_cast<int32_t>(affine.step_y[axis] >> shift);
  }
  uint32_t hits = 0;
  for (int32_t row = 0; row < rows; ++row) {
    int32_t at[3] = {row_start[0], row_start[1], row_start[2]};
    uint32_t pair = 0;
    for (int32_t x = 0; x < camera.width_px(); ++x) {
      const int32_t direction[3] = {at[0] >> 16, at[1] >> 16, at[2] >> 16};
      const int32_t face = trace_dda(rays, direction);
      uint32_t gray = background;
      if (face >= 0) {
        gray = face_gray[face];
        ++hits;
      }
      pair = pair << 4 | gray;
      if ((x & 1) != 0) {
        *pixels++ = static_cast<uint8_t>(pair);
      }
      at[0] += across[0];
      at[1] += across[1];
      at[2] += across[2];
    }
    if ((camera.width_px() & 1) != 0) {
      *pixels++ = static_cast<uint8_t>(pair << 4);
    }
    for (int axis = 0; axis < 3; ++axis) {
      row_start[axis] += down[axis];
    }
  }
  return hits;
}

}  // namespace thimble::apps
