/// Which part of each row of a picture can show a box: all others are known to miss without their rays.
#pragma once

#include <stdint.h>

#include "thimble/base/vec.h"
#include "thimble/picture/camera.h"

namespace thimble::wide {

class RowSpans {
 public:
  struct Columns {
    int32_t first;
    int32_t end;
  };

  RowSpans(const Camera& camera, const VoxelBox& box);

  /// No ray of the row's other columns touches the box, its faces included.
  Columns of_row(int32_t row) const;

 private:
  /// By column and row, in one of three planes, on which side of a ray a corner of the box lies, times the
  /// corner's distance or the ray's length: by more than `slack` it is that side for sure.
  struct Corner {
    double at;
    double per_column;
    double per_row;
    double slack;
  };

  Corner corners_[3][4];
  int32_t width_;
};

}  // namespace thimble::wide
