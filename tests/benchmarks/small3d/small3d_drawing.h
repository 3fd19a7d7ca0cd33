/// @file small3d_drawing.h
/// A voxel model drawn by small3dlib (Miloslav Ciz; one header, integers only), as it stands: 320 x 240 pixels, a full
/// depth buffer, triangles at the near plane cut.
///
/// One program includes this once, since small3dlib is declarations and code at once. THIMBLE_SMALL3DLIB_HEADER may name
/// another header with its interface, for tests.
#ifndef THIMBLE_TESTS_BENCHMARKS_SMALL3D_DRAWING_H
#define THIMBLE_TESTS_BENCHMARKS_SMALL3D_DRAWING_H

#include <cmath>
#include <cstdint>
#include <vector>

#include "benchmarks/small3d/voxel_faces.h"
#include "thimble/picture/camera.h"

// clang-format off
#define S3L_RESOLUTION_X 320
#define S3L_RESOLUTION_Y 240
#define S3L_PIXEL_FUNCTION thimble_small3d_pixel
#define S3L_Z_BUFFER 1
#define S3L_NEAR_CROSS_STRATEGY 2
#ifndef THIMBLE_SMALL3DLIB_HEADER
#define THIMBLE_SMALL3DLIB_HEADER <small3dlib.h>
#endif
#include THIMBLE_SMALL3DLIB_HEADER
// clang-format on

namespace thimble::benchmarks {

inline constexpr int kSmall3dWidthPx = S3L_RESOLUTION_X;
inline constexpr int kSmall3dHeightPx = S3L_RESOLUTION_Y;
inline constexpr std::size_t kSmall3dPixels = std::size_t{kSmall3dWidthPx} * kSmall3dHeightPx;

/// Rectangles in one of its models, whose vertices have numbers of 16 bits.
inline constexpr std::uint32_t kRectsAModel = 16000;

/// What the pixel function writes to: it is told of pixels one by one, and nothing else.
struct Small3dTarget {
  std::uint16_t* pixels = nullptr;
  std::uint32_t* rects = nullptr;  ///< the rectangle of each pixel; null while time is measured
  const std::uint16_t* colors = nullptr;
};
inline Small3dTarget small3d_target;

/// What only trying tells of a version: which triangles it takes for the back, and where in a pixel its corners lie.
struct Small3dTuning {
  std::uint8_t culling = 2;
  double right_px = 0;
  double down_px = 0;
};

class Small3dDrawing {
 public:
  /// `colors`: RGB565 of each rectangle, kept by the caller.
  Small3dDrawing(const VoxelFaces& faces, const std::vector<std::uint16_t>& colors) : colors_(&colors) {
    const std::vector<FaceRect>& rects = faces.rects();
    for (std::size_t first = 0; first < rects.size(); first += kRectsAModel) {
      Part part;
      for (std::size_t i = first; i < rects.size() && i < first + kRectsAModel; ++i) {
        add(rects[i], &part);
      }
      parts_.push_back(std::move(part));
    }
    for (const Part& part : parts_) {
      S3L_Model3D model;
      S3L_model3DInit(part.corners.data(), static_cast<S3L_Index>(part.corners.size() / 3),
                      part.triangles.data(), static_cast<S3L_Index>(part.triangles.size() / 3), &model);
      models_.push_back(model);
    }
  }
  Small3dDrawing(const Small3dDrawing&) = delete;
  Small3dDrawing& operator=(const Small3dDrawing&) = delete;

  /// Corners, triangles and the depth buffer.
  std::size_t bytes() const {
    std::size_t sum = kSmall3dPixels * sizeof(S3L_Unit);
    for (const Part& part : parts_) {
      sum += part.corners.size() * sizeof(S3L_Unit) + part.triangles.size() * sizeof(S3L_Index);
    }
    return sum;
  }

  /// A frame, the background included. `rects` may be null. `camera` has its 320 x 240 pixels.
  void draw(const Camera& camera, const Small3dTuning& tuning, std::uint16_t background,
            std::uint16_t* pixels, std::uint32_t* rects) {
    for (std::size_t i = 0; i < kSmall3dPixels; ++i) {
      pixels[i] = background;
    }
    for (std::size_t i = 0; rects != nullptr && i < kSmall3dPixels; ++i) {
      rects[i] = VoxelFaces::kNone;
    }
    small3d_target = {pixels, rects, colors_->data()};
    S3L_Scene scene;
    S3L_sceneInit(models_.data(), static_cast<S3L_Index>(models_.size()), &scene);
    set_camera(camera, tuning, &scene);
    S3L_newFrame();
    S3L_drawScene(scene);
  }

 private:
  struct Part {
    std::vector<S3L_Unit> corners;
    std::vector<S3L_Index> triangles;
  };
  // A voxel has 64 of its units before the camera's matrix and 512 behind it: so the matrix, whose numbers are
  // 1/512, turns finer than it otherwise could.
  static constexpr int kUnitsAVoxel = 64;
  static constexpr int kFiner = S3L_F / kUnitsAVoxel;

  static void add(const FaceRect& rect, Part* part) {
    const int a = (rect.axis + 1) % 3;
    const int b = (rect.axis + 2) % 3;
    const std::size_t first = part->corners.size() / 3;
    // Round the rectangle, as seen from outside.
    for (int corner = 0; corner < 4; ++corner) {
      const int turn = rect.up ? corner : 3 - corner;
      Vec3i at = rect.low;
      at[rect.axis] += rect.up ? 1 : 0;
      at[a] = turn == 1 || turn == 2 ? rect.high[a] + 1 : rect.low[a];
      at[b] = turn >= 2 ? rect.high[b] + 1 : rect.low[b];
      for (int axis = 0; axis < 3; ++axis) {
        part->corners.push_back(at[axis] * kUnitsAVoxel);
      }
    }
    for (const unsigned corner : {0U, 1U, 2U, 0U, 2U, 3U}) {
      part->triangles.push_back(static_cast<S3L_Index>(first + corner));
    }
  }

  // Its own camera stays where it begins, looking along z, since its angles are 1/512 of a turn; the models' matrix
  // takes them before it.
  void set_camera(const Camera& camera, const Small3dTuning& tuning, S3L_Scene* scene) {
    const Camera::Affine& rays = camera.affine();
    double across[3];
    double down[3];
    double ahead[3];
    for (int axis = 0; axis < 3; ++axis) {
      const auto step_x = static_cast<double>(rays.step_x[axis]);
      const auto step_y = static_cast<double>(rays.step_y[axis]);
      across[axis] = step_x;
      down[axis] = step_y;
      ahead[axis] = static_cast<double>(rays.base[axis]) + (kSmall3dWidthPx - 1) / 2.0 * step_x +
                    (kSmall3dHeightPx - 1) / 2.0 * step_y;
    }
    const auto length = [](const double* v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); };
    const double focal_px = length(ahead) / length(across);
    const double focal = focal_px * 2 * S3L_F / kSmall3dWidthPx;
    const auto whole_focal = static_cast<S3L_Unit>(std::lround(focal));
    const double rest = focal / static_cast<double>(whole_focal);
    double rows[3][4];
    for (int axis = 0; axis < 3; ++axis) {
      const double z = ahead[axis] / length(ahead);
      rows[0][axis] = rest * (across[axis] / length(across) + z * tuning.right_px / focal_px);
      rows[1][axis] = rest * (-down[axis] / length(down) - z * tuning.down_px / focal_px);
      rows[2][axis] = z;
    }
    for (auto& row : rows) {
      row[3] = 0;
      for (int axis = 0; axis < 3; ++axis) {
        row[3] -= row[axis] * camera.eye()[axis].raw / 256.0;
      }
    }
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) {
        const double one = column == row ? S3L_F : 0;
        const double value = column == 3 ? one : rows[column][row] * (row < 3 ? kFiner : 1) * S3L_F;
        matrix_[column][row] = static_cast<S3L_Unit>(std::lround(value));
      }
    }
    for (S3L_Model3D& model : models_) {
      model.customTransformMatrix = &matrix_;
      model.config.backfaceCulling = tuning.culling;
    }
    scene->camera.focalLength = whole_focal;
  }

  const std::vector<std::uint16_t>* colors_;
  std::vector<Part> parts_;
  std::vector<S3L_Model3D> models_;
  S3L_Mat4 matrix_{};
};

/// Pixels of `rects` that show another rectangle than the exact picture, of the rectangles that it shows.
inline std::size_t wrong_pixels(const std::vector<std::uint32_t>& exact,
                                const std::vector<std::uint32_t>& rects) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    wrong += exact[i] == rects[i] ? 0U : 1U;
  }
  return wrong;
}

/// The tuning with the fewest wrong pixels: both sides for the back, and corners moved by no or half a pixel.
inline Small3dTuning tune(Small3dDrawing* drawing, const Camera& camera,
                          const std::vector<std::uint32_t>& exact) {
  std::vector<std::uint16_t> pixels(kSmall3dPixels);
  std::vector<std::uint32_t> rects(kSmall3dPixels);
  Small3dTuning best;
  std::size_t fewest = kSmall3dPixels + 1;
  for (const int culling : {1, 2}) {
    for (const int right : {-1, 0, 1}) {
      for (const int down : {-1, 0, 1}) {
        const Small3dTuning tuning{static_cast<std::uint8_t>(culling), right / 2.0, down / 2.0};
        drawing->draw(camera, tuning, 0, pixels.data(), rects.data());
        const std::size_t wrong = wrong_pixels(exact, rects);
        if (wrong < fewest) {
          fewest = wrong;
          best = tuning;
        }
      }
    }
  }
  return best;
}

}  // namespace thimble::benchmarks

// What small3dlib calls for each pixel that is nearer than what was there.
static inline void thimble_small3d_pixel(S3L_PixelInfo* pixel) {
  using namespace thimble::benchmarks;
  const auto at = static_cast<std::size_t>(pixel->y) * kSmall3dWidthPx + static_cast<std::size_t>(pixel->x);
  const std::uint32_t rect = std::uint32_t{pixel->modelIndex} * kRectsAModel + pixel->triangleIndex / 2U;
  small3d_target.pixels[at] = small3d_target.colors[rect];
  if (small3d_target.rects != nullptr) {
    small3d_target.rects[at] = rect;
  }
}

#endif
