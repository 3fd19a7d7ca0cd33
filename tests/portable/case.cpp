#include "portable/case.h"

#include "thimble/crc32.h"

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

bool Check::equal_64(int64_t got, int64_t wanted, const char* expression, int line) {
  note(got);
  if (got == wanted) {
    return true;
  }
  if (failure_.expression == nullptr) {
    failure_ = {expression, line, got, wanted};
  }
  return false;
}

bool Check::equal_32(int32_t got, int32_t wanted, const char* expression, int line) {
  return equal_64(got, wanted, expression, line);
}

bool Check::equal(const Vec3i& got, const Vec3i& wanted, const char* expression, int line) {
  bool same = true;
  for (int axis = 0; axis < 3; ++axis) {
    same = equal_32(got[axis], wanted[axis], expression, line) && same;
  }
  return same;
}

bool Check::equal(const VoxelBox& got, const VoxelBox& wanted, const char* expression, int line) {
  const bool low = equal(got.min, wanted.min, expression, line);
  return equal(got.max, wanted.max, expression, line) && low;
}

bool Check::equal(const Rgb8& got, const Rgb8& wanted, const char* expression, int line) {
  return equal_32(got.r << 16 | got.g << 8 | got.b, wanted.r << 16 | wanted.g << 8 | wanted.b, expression,
                  line);
}

bool Check::equal(ConstBytes got, ConstBytes wanted, const char* expression, int line) {
  bool same = equal_64(static_cast<int64_t>(got.size), static_cast<int64_t>(wanted.size), expression, line);
  for (size_t i = 0; same && i < got.size; ++i) {
    same = equal_32(got[i], wanted[i], expression, line);
  }
  return same;
}

}  // namespace thimble::portable
