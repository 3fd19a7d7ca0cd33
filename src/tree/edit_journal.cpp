// Edits of many voxels, and taking them back. An entry of the journal is x, y, z and what stood there, 16 bits each; the
// entry behind an edit's last has kMark for x, and how many there are.
#include "../base/bits.h"
#include "compact_header.h"
#include "thimble/tree/edited_world.h"

namespace thimble {
namespace {

constexpr uint64_t kMark = 0xFFFF;
constexpr int32_t kMostCorner = int32_t{1} << 20;

uint64_t entry_of(const Vec3i& voxel, int material) {
  return static_cast<uint64_t>(voxel.x) | static_cast<uint64_t>(voxel.y) << 16 |
         static_cast<uint64_t>(voxel.z) << 32 | static_cast<uint64_t>(material + 1) << 48;
}

// Whether the middle of the voxel lies in the ellipsoid within the box: exact, as each side is below 2^10.
bool is_in_ellipsoid(const VoxelBox& box, const Vec3i& voxel) {
  uint64_t sum = 0;
  uint64_t whole = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t side = box.high[axis] - box.low[axis];
    const int64_t off = 2 * (int64_t{voxel[axis]} - box.low[axis]) + 1 - side;
    // sum / whole is the sum of off^2 / side^2 of the axes up to this.
    const auto side_2 = static_cast<uint64_t>(side * side);
    sum = sum * side_2 + static_cast<uint64_t>(off * off) * whole;
    whole *= side_2;
  }
  return sum <= whole;
}

}  // namespace

int EditedWorld::material(const Vec3i& voxel) const {
  return is_in_world(voxel, tree_.level()) ? material_within(voxel) : kEmpty;
}

Status EditedWorld::make_voxel(const Vec3i& voxel, int material) {
  return material == kEmpty ? clear(voxel) : set(voxel, static_cast<uint8_t>(material));
}

// There is room, voxel by voxel: what a `clear` of a block opens was open before the `set` that closed it, which wanted a
// leaf besides; what a `set` adds was there before the `clear`; and a solid brick's kind stays.
void EditedWorld::take_back(EditJournal* journal, size_t to) {
  while (journal->size_ != to) {
    --journal->size_;
    const uint64_t entry = bits::load64(journal->bytes_.data + EditJournal::kEntryBytes * journal->size_);
    const Vec3i voxel{static_cast<int32_t>(entry & 0xFFFF), static_cast<int32_t>(entry >> 16 & 0xFFFF),
                      static_cast<int32_t>(entry >> 32 & 0xFFFF)};
    (void)make_voxel(voxel, static_cast<int>(entry >> 48) - 1);
  }
}

Status EditedWorld::edit(const VoxelBox& box, EditShape shape, int material, EditJournal* journal) {
  VoxelBox inside = box;
  const int32_t world_side = int32_t{1} << tree_.level();
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t low = box.low[axis];
    const int32_t high = box.high[axis];
    if (low < -kMostCorner || low > kMostCorner || high < -kMostCorner || high > kMostCorner ||
        high - low > kMostEditSide) {
      return Status::kOutOfRange;
    }
    inside.low[axis] = low < 0 ? 0 : low;
    inside.high[axis] = high > world_side ? world_side : high;
  }
  if (tree_.bytes() == nullptr || material < kEmpty || material > 255) {
    return Status::kBadArgument;
  }
  const size_t begin = journal->size_;
  if (begin == journal->capacity()) {
    return Status::kOutOfMemory;
  }
  for (int32_t z = inside.low.z; z < inside.high.z; ++z) {
    for (int32_t y = inside.low.y; y < inside.high.y; ++y) {
      for (int32_t x = inside.low.x; x < inside.high.x; ++x) {
        const Vec3i voxel{x, y, z};
        const int before = material_within(voxel);
        if (before == material || (shape == EditShape::kBall && !is_in_ellipsoid(box, voxel))) {
          continue;
        }
        const Status status =
            journal->size_ + 1 < journal->capacity() ? make_voxel(voxel, material) : Status::kOutOfMemory;
        if (status != Status::kOk) {
          take_back(journal, begin);
          return status;
        }
        bits::store64(journal->bytes_.data + EditJournal::kEntryBytes * journal->size_,
                      entry_of(voxel, before));
        ++journal->size_;
      }
    }
  }
  bits::store64(journal->bytes_.data + EditJournal::kEntryBytes * journal->size_,
                kMark | static_cast<uint64_t>(journal->size_ - begin) << 16);
  ++journal->size_;
  return Status::kOk;
}

Status EditedWorld::undo(EditJournal* journal) {
  if (journal->size_ == 0) {
    return Status::kBadArgument;
  }
  const uint64_t mark = bits::load64(journal->bytes_.data + EditJournal::kEntryBytes * (journal->size_ - 1));
  const uint64_t count = mark >> 16;
  if ((mark & kMark) != kMark || count > journal->size_ - 1) {
    return Status::kBadArgument;
  }
  --journal->size_;
  take_back(journal, journal->size_ - static_cast<size_t>(count));
  return Status::kOk;
}

}  // namespace thimble
