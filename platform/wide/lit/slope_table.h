/// @file slope_table.h
/// Slopes of surfaces, for a thread: the core's lit::surface_normal, number by number, with what the points
/// of a face share kept from one to the next.
///
/// All but the gradient depends on the voxel, its face and the body alone: the window, made solid where it is
/// a shell, and the window with the surface's edges cut off, for the way in which it was followed last. Each
/// face has one place in the table, and shares it with others: there stands the one that was asked about
/// last.
#ifndef THIMBLE_PLATFORM_WIDE_LIT_SLOPE_TABLE_H
#define THIMBLE_PLATFORM_WIDE_LIT_SLOPE_TABLE_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/light/host/asked.h"
#include "thimble/light/host/slope_window.h"

namespace thimble::wide {

/// The bits of a window along an axis, upwards or downwards: bit w of a column is the voxel w steps from the
/// window's lower end, or from its upper one. By the other two axes, the higher one first.
struct ColumnBits {
  uint16_t at[lit::kSlopeSide][lit::kSlopeSide];
};

/// What is known of a face.
struct KnownSlope {
  static constexpr uint8_t kNone = 0xFF;

  Vec3i voxel;              ///< that has the points
  uint32_t visits = 0;      ///< that its window took
  uint16_t index_q12 = 0;   ///< of the body
  uint8_t face = kNone;     ///< 2 * axis, and 1 more where it looks to larger coordinates
  uint8_t course = kNone;   ///< the same of the way in which the surface was followed last
  bool keeps_face = false;  ///< there the normal is the face's own
  bool is_cut = false;      ///< there `cut` is other than `columns`
  ColumnBits columns;       ///< along the face's axis, outwards
  ColumnBits cut;           ///< along the course
};

/// A window as it was read: the same for eight voxels.
struct KnownWindow {
  lit::SlopeWindow window;
  uint32_t visits = 0;     ///< that it took
  uint16_t index_q12 = 0;  ///< of the body
  bool is_known = false;
};

class SlopeTable {
 public:
  SlopeTable() = default;
  /// `places` for `count` faces, a power of two, and a quarter as many windows; they outlive it.
  SlopeTable(const lit::Frame& frame, KnownSlope* places, KnownWindow* windows, uint32_t count)
      : frame_(&frame), places_(places), windows_(windows), count_(count) {}

  /// As lit::surface_normal. What is known already adds the visits that it took, so that counts do not depend
  /// on what was asked before, nor on which thread was asked.
  Vec3i normal(const Vec3Q8& at, const Face& face, uint16_t index_q12, uint32_t* visits);

 private:
  KnownSlope& find(const Vec3i& voxel, const Face& face, uint16_t index_q12);
  const KnownWindow& window_at(const Vec3i& low, uint16_t index_q12);

  const lit::Frame* frame_ = nullptr;
  KnownSlope* places_ = nullptr;
  KnownWindow* windows_ = nullptr;
  uint32_t count_ = 0;
};

}  // namespace thimble::wide

#endif
