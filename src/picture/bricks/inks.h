// Inks are colours as a frame's format stores them; those that were looked up lately are kept. Internal to src/.
#pragma once

#include "../panels.h"
#include "course.h"

namespace thimble::bricks {
namespace {

// The inks of faces of voxels, and of faces of a material, that were looked up lately.
struct Inks {
  static constexpr uint32_t kFaces = 64;
  static constexpr uint32_t kMaterials = 16;
  static constexpr uint32_t kNone = UINT32_MAX;
  struct Seen {
    uint32_t key;
    uint32_t ink;
  };
  Seen face[kFaces];
  uint32_t material[6 * kMaterials];  // material << 24 | ink
  uint32_t near_cell[2];              // where the last ray started, on a and b

  static uint32_t slot(uint32_t key) { return (key ^ key >> 6) % kFaces; }

  [[THIMBLE_HOT]] void forget() {
    for (Seen& seen : face) {
      seen.key = kNone;
    }
    near_cell[0] = 0;
    near_cell[1] = 0;
    for (uint32_t& ink : material) {
      ink = kNone;
    }
  }
};

// Formats of one byte a pixel, and of two.
constexpr bool is_byte(PixelFormat format) {
  return format == PixelFormat::kGray8 || is_format<PixelFormat::kRgb332>(format);
}
constexpr bool is_halfword(PixelFormat format) {
  return format == PixelFormat::kRgb565 || is_format<PixelFormat::kRgb565Be>(format) ||
         is_format<PixelFormat::kBgr565>(format);
}

uint32_t ink_of(PixelFormat format, Rgb8 color) {
  if (format == PixelFormat::kGray4) {
    return panels::level_of_16(gray_of(color));
  }
  if (format == PixelFormat::kMono1 || format == PixelFormat::kGray8) {
    return gray_of(color);
  }
  if (format == PixelFormat::kRgb565) {
    return (color.r & 0xF8U) << 8 | (color.g & 0xFCU) << 3 | color.b >> 3U;
  }
  if (is_format<PixelFormat::kRgb565Be>(format)) {
    return panels::rgb565_be(color);
  }
  if (is_format<PixelFormat::kBgr565>(format)) {
    return panels::bgr565(color);
  }
  if (is_format<PixelFormat::kRgb332>(format)) {
    return panels::rgb332(color);
  }
  return static_cast<uint32_t>(color.r) | static_cast<uint32_t>(color.g) << 8 |
         static_cast<uint32_t>(color.b) << 16;
}

// Stores an ink as `store_pixel` stores its colour.
[[maybe_unused]] void store_ink(uint8_t* line, int32_t x, int32_t y, PixelFormat format, uint32_t ink) {
  const uint8_t low = static_cast<uint8_t>(ink);
  if (format == PixelFormat::kGray4) {
    line[x >> 1] = static_cast<uint8_t>(line[x >> 1] | low << ((x & 1) != 0 ? 0 : 4));
  } else if (is_byte(format)) {
    line[x] = low;
  } else if (is_halfword(format)) {
    line[2 * x] = low;
    line[2 * x + 1] = static_cast<uint8_t>(ink >> 8);
  } else if (format == PixelFormat::kMono1) {
    store_pixel(line, x, y, PixelFormat::kMono1, {low, low, low});
  } else {
    const Rgb8 color{low, static_cast<uint8_t>(ink >> 8), static_cast<uint8_t>(ink >> 16)};
    if (is_panel(format)) {
      store_panel_pixel(line, x, y, format, color);
    } else {
      store_pixel(line, x, y, PixelFormat::kRgb888, color);
    }
  }
}

// Makes the hit of a face of `material`, and sets of its ray what `shade` reads.
Hit face_hit(const Course& course, int axis, uint8_t material, Ray* ray) {
  Hit hit;
  hit.kind = HitKind::kHit;
  hit.axis = static_cast<int8_t>(axis);
  hit.material = material;
  ray->direction[axis] = (course.mirrored >> axis & 1U) == 0 ? 1 : -1;
  return hit;
}

// Shades a voxel by its distance: `voxel` of the brick that `left` counts, entered on `axis`; `direction` is the ray's
// component on that axis.
[[gnu::noinline, maybe_unused]] int32_t depth_ink(const Course& course, int axis, uint32_t left,
                                                  uint32_t voxel, uint32_t direction) {
  const int32_t bricks = static_cast<int32_t>(count_of(left, axis)) - (512 - course.frame->side[axis]);
  const uint32_t place = voxel >> 2 * axis & 3U;
  const int32_t origin = course.origin[axis] - outside_q8(course, axis);
  const int32_t distance = (4 * bricks + static_cast<int32_t>(place ^ course.flip[axis])) * Q8::kOne - origin;
  const BrickFrame& frame = *course.frame;
  Ray ray;
  Hit hit = face_hit(course, axis, 0, &ray);
  hit.t_numerator = distance;
  hit.t_denominator = static_cast<int32_t>(direction) * Q8::kOne;
  return static_cast<int32_t>(ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)));
}

// Shades a face of a material; returns an entry of `Inks::material`.
[[gnu::noinline]] uint32_t material_ink(const Course& course, int axis, uint8_t material) {
  const BrickFrame& frame = *course.frame;
  Ray ray;
  const Hit hit = face_hit(course, axis, material, &ray);
  return ink_of(frame.format, shade(hit, ray, frame.camera, frame.shading)) | static_cast<uint32_t>(material)
                                                                                  << 24;
}

// Finds and keeps the ink of a face that was not seen lately: of `voxel` (64 times the brick's number, plus the voxel's
// bit), entered on `axis`.
[[gnu::noinline, maybe_unused, THIMBLE_HOT]] int32_t look_up(const Course& course, uint32_t voxel, int axis) {
  const BrickFrame& frame = *course.frame;
  const uint8_t material = frame.map.material(frame.tree, voxel >> 6, voxel & 63U);
  const uint32_t face = course.face[axis];
  uint32_t& kept = course.inks->material[face * Inks::kMaterials + material % Inks::kMaterials];
  if (kept >> 24 != material || kept == Inks::kNone) {
    kept = material_ink(course, axis, material);
  }
  const uint32_t ink = kept & 0xFFFFFFU;
  const uint32_t key = voxel << 3 | face;
  course.inks->face[Inks::slot(key)] = {key, ink};
  return static_cast<int32_t>(ink);
}

}  // namespace
}  // namespace thimble::bricks
