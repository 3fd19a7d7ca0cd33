/// Finds slopes of surfaces for one thread: the core's lit::surface_normal, number by number. What the points of a face
/// share is kept from one point to the next.
///
/// Only the gradient depends on the point. The voxel, its face and the body alone decide the window, made solid where
/// it is a shell, and the window with the surface's edges cut off, for the way in which it was followed last. Each
/// face has one place in the table, which it shares with other faces; the place holds the face that was looked up
/// last.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/light/host/asked.h"
#include "thimble/light/host/slope_window.h"

namespace thimble::wide {

/// What is known of a face.
struct KnownSlope {
  static constexpr uint8_t kNone = 0xFF;

  Vec3i voxel;              ///< the voxel that has the face
  uint32_t visits = 0;      ///< visits that reading its window took
  uint16_t index_q12 = 0;   ///< the body's index
  uint8_t face = kNone;     ///< 2 * axis, and 1 more where it looks to larger coordinates
  uint8_t course = kNone;   ///< the way in which the surface was followed last, numbered like `face`
  bool keeps_face = false;  ///< on that course the normal is the face's own
  bool is_cut = false;      ///< on that course `cut` differs from `window`
  lit::SlopeWindow window;  ///< with shells made solid
  lit::SlopeWindow cut;     ///< with edges cut off on the course
};

/// A window as it was read, which eight voxels share.
struct KnownWindow {
  lit::SlopeWindow window;
  uint32_t visits = 0;     ///< visits that reading it took
  uint16_t index_q12 = 0;  ///< the body's index
  bool is_known = false;
};

class SlopeTable {
 public:
  SlopeTable() = default;
  /// `places` for `count` faces, a power of two, and a quarter as many windows; they outlive it.
  SlopeTable(const lit::Frame& frame, KnownSlope* places, KnownWindow* windows, uint32_t count)
      : frame_(&frame), places_(places), windows_(windows), count_(count) {}

  /// Does as lit::surface_normal. A known slope adds the visits that it once took, so that counts do not depend on what
  /// was looked up before, nor on the thread.
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
