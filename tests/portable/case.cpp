#include "portable/case.h"

#include "thimble/base/memory.h"

namespace thimble::portable {

void Check::note(int64_t value) {
  uint8_t bytes[8];
  for (unsigned i = 0; i < 8; ++i) {
    bytes[i] = static_cast<uint8_t>(static_cast<uint64_t>(value) >> (8 * i));
  }
  note_bytes(bytes);
}

void Check::note_bytes(ConstBytes bytes) {
  crc_ = thimble::crc32(bytes, crc_);
}

void Check::note(const Hit& value) {
  const int32_t parts[] = {static_cast<int32_t>(value.kind),
                           static_cast<int32_t>(value.visits),
                           value.axis,
                           value.material,
                           value.block_level,
                           value.voxel.x,
                           value.voxel.y,
                           value.voxel.z,
                           value.t_numerator,
                           value.t_denominator};
  // Of a miss only the first two mean anything.
  const int count = value.kind == HitKind::kHit ? 10 : 2;
  for (int i = 0; i < count; ++i) {
    note(parts[i]);
  }
}

void Check::note(const Ray& value) {
  for (int axis = 0; axis < 3; ++axis) {
    note(value.origin[axis].raw);
    note(value.direction[axis]);
  }
}

bool Check::equal_64(int64_t got, int64_t wanted, What what) {
  note(got);
  if (got == wanted) {
    return true;
  }
  if (!failed_) {
    failed_ = true;
    failure_ = {what, got, wanted};
  }
  return false;
}

bool Check::equal_32(int32_t got, int32_t wanted, What what) {
  return equal_64(got, wanted, what);
}

bool Check::equal_u32(uint32_t got, uint32_t wanted, What what) {
  return equal_64(got, wanted, what);
}

bool Check::equal(const Vec3i& got, const Vec3i& wanted, What what) {
  bool same = true;
  for (int axis = 0; axis < 3; ++axis) {
    same = equal_32(got[axis], wanted[axis], what) && same;
  }
  return same;
}

bool Check::equal(const VoxelBox& got, const VoxelBox& wanted, What what) {
  const bool low = equal(got.low, wanted.low, what);
  return equal(got.high, wanted.high, what) && low;
}

bool Check::equal(const Rgb8& got, const Rgb8& wanted, What what) {
  return equal_32(got.r << 16 | got.g << 8 | got.b, wanted.r << 16 | wanted.g << 8 | wanted.b, what);
}

bool Check::equal(ConstBytes got, ConstBytes wanted, What what) {
  bool same = equal_64(static_cast<int64_t>(got.size), static_cast<int64_t>(wanted.size), what);
  for (size_t i = 0; same && i < got.size; ++i) {
    same = equal_32(got[i], wanted[i], what);
  }
  return same;
}

}  // namespace thimble::portable
