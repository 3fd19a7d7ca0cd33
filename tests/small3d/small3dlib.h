// A stand-in for small3dlib.h: its interface, as its own comments state it, and behind it a rasteriser in doubles of a few
// lines that draws where its conventions say, so that the tests can compile and judge what draws by it
// (tests/benchmarks/small3d). Nothing of small3dlib is in it, and it says nothing about its pictures or its speed.
#ifndef SMALL3DLIB_H
#define SMALL3DLIB_H

#include <stdint.h>

#include <algorithm>
#include <cmath>
#include <vector>

#define S3L_F 512
typedef int32_t S3L_Unit;
typedef int16_t S3L_ScreenCoord;
typedef uint16_t S3L_Index;
// matrix[column][row]; vectors are rows, multiplied from the left, and what was multiplied is divided by S3L_F.
typedef S3L_Unit S3L_Mat4[4][4];

struct S3L_Vec4 {
  S3L_Unit x, y, z, w;
};
struct S3L_Transform3D {
  S3L_Vec4 translation, rotation, scale;
};
struct S3L_Camera {
  S3L_Unit focalLength;
  S3L_Transform3D transform;
};
struct S3L_DrawConfig {
  uint8_t backfaceCulling;  // 0 none, 1 clockwise, 2 counter-clockwise
  int8_t visible;
};
struct S3L_Model3D {
  const S3L_Unit* vertices;
  S3L_Index vertexCount;
  const S3L_Index* triangles;
  S3L_Index triangleCount;
  S3L_Transform3D transform;
  S3L_Mat4* customTransformMatrix;
  S3L_DrawConfig config;
};
struct S3L_Scene {
  S3L_Model3D* models;
  S3L_Index modelCount;
  S3L_Camera camera;
};
struct S3L_PixelInfo {
  S3L_ScreenCoord x, y;
  S3L_Unit barycentric[3];
  S3L_Index modelIndex, triangleIndex;
  uint32_t triangleID;
  S3L_Unit depth;
};

static inline void S3L_PIXEL_FUNCTION(S3L_PixelInfo* pixel);

// For tests: pixels by which every triangle is moved to the right.
inline double S3L_stand_in_fault_px = 0;
inline std::vector<double> S3L_stand_in_depths;

inline void S3L_model3DInit(const S3L_Unit* vertices, S3L_Index vertex_count, const S3L_Index* triangles,
                            S3L_Index triangle_count, S3L_Model3D* model) {
  *model = {vertices, vertex_count, triangles, triangle_count, {}, nullptr, {2, 1}};
}
inline void S3L_sceneInit(S3L_Model3D* models, S3L_Index model_count, S3L_Scene* scene) {
  *scene = {models, model_count, {S3L_F, {}}};
}
inline void S3L_newFrame() {
  S3L_stand_in_depths.assign(std::size_t{S3L_RESOLUTION_X} * S3L_RESOLUTION_Y, 1e30);
}

inline void S3L_drawTriangle(const double (&corners)[3][3], S3L_PixelInfo* pixel, int culling) {
  const auto across = [](const double* a, const double* b, double x, double y) {
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
  };
  const double area = across(corners[0], corners[1], corners[2][0], corners[2][1]);
  if (area == 0 || (culling == 1 && area > 0) || (culling == 2 && area < 0)) {
    return;
  }
  double low[2] = {1e9, 1e9};
  double high[2] = {-1e9, -1e9};
  for (const auto& corner : corners) {
    for (int i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], corner[i]);
      high[i] = std::max(high[i], corner[i]);
    }
  }
  const int bottom = static_cast<int>(std::min(high[1], S3L_RESOLUTION_Y - 1.0));
  const int right = static_cast<int>(std::min(high[0], S3L_RESOLUTION_X - 1.0));
  for (int y = static_cast<int>(std::max(low[1], 0.0)); y <= bottom; ++y) {
    for (int x = static_cast<int>(std::max(low[0], 0.0)); x <= right; ++x) {
      double share[3];
      for (int i = 0; i < 3; ++i) {
        share[i] = across(corners[(i + 1) % 3], corners[(i + 2) % 3], x, y) / area;
      }
      // The inverse of the depth is what is linear on the picture.
      const double depth =
          1 / (share[0] / corners[0][2] + share[1] / corners[1][2] + share[2] / corners[2][2]);
      double& nearest =
          S3L_stand_in_depths[static_cast<std::size_t>(y) * S3L_RESOLUTION_X + static_cast<std::size_t>(x)];
      if (share[0] >= 0 && share[1] >= 0 && share[2] >= 0 && depth < nearest) {
        nearest = depth;
        pixel->x = static_cast<S3L_ScreenCoord>(x);
        pixel->y = static_cast<S3L_ScreenCoord>(y);
        S3L_PIXEL_FUNCTION(pixel);
      }
    }
  }
}

inline void S3L_drawScene(S3L_Scene scene) {
  for (S3L_Index m = 0; m < scene.modelCount; ++m) {
    const S3L_Model3D& model = scene.models[m];
    for (S3L_Index t = 0; t < model.triangleCount; ++t) {
      double corners[3][3];
      bool is_before = true;
      for (int i = 0; i < 3; ++i) {
        const S3L_Unit* const at = model.vertices + std::size_t{3} * model.triangles[3 * t + i];
        double turned[3];
        for (int column = 0; column < 3; ++column) {
          const S3L_Unit* const by = (*model.customTransformMatrix)[column];
          turned[column] =
              (double{1} * at[0] * by[0] + double{1} * at[1] * by[1] + double{1} * at[2] * by[2]) / S3L_F +
              by[3];
        }
        const double scale = scene.camera.focalLength / turned[2] * (S3L_RESOLUTION_X / 2.0) / S3L_F;
        is_before = is_before && turned[2] > S3L_F / 4.0;
        corners[i][0] = S3L_RESOLUTION_X / 2.0 + turned[0] * scale + S3L_stand_in_fault_px;
        corners[i][1] = S3L_RESOLUTION_Y / 2.0 - turned[1] * scale;
        corners[i][2] = turned[2];
      }
      S3L_PixelInfo pixel{};
      pixel.modelIndex = m;
      pixel.triangleIndex = t;
      if (is_before) {
        S3L_drawTriangle(corners, &pixel, model.config.backfaceCulling);
      }
    }
  }
}

#endif
