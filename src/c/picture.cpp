#include "picture.h"

#include "thimble/trace/secondary_ray.h"

namespace thimble::c_face {
namespace {

static_assert(THIMBLE_MISS == static_cast<int>(HitKind::kMiss) &&
              THIMBLE_HIT == static_cast<int>(HitKind::kHit) &&
              THIMBLE_STOPPED == static_cast<int>(HitKind::kStepLimit));
static_assert(THIMBLE_SHADE_DEPTH == static_cast<int>(ShadeMode::kDepth) &&
              THIMBLE_SHADE_NORMAL == static_cast<int>(ShadeMode::kNormal) &&
              THIMBLE_SHADE_COLOR == static_cast<int>(ShadeMode::kColor) &&
              THIMBLE_SHADE_MONO == static_cast<int>(ShadeMode::kMono));
static_assert(sizeof(Rgb8) == 3 && alignof(Rgb8) == 1, "the palette is read where it lies");

static_assert(THIMBLE_FORMAT_MONO1 == static_cast<int>(PixelFormat::kMono1) &&
              THIMBLE_FORMAT_GRAY4 == static_cast<int>(PixelFormat::kGray4) &&
              THIMBLE_FORMAT_GRAY8 == static_cast<int>(PixelFormat::kGray8) &&
              THIMBLE_FORMAT_RGB565 == static_cast<int>(PixelFormat::kRgb565) &&
              THIMBLE_FORMAT_RGB888 == static_cast<int>(PixelFormat::kRgb888) &&
              THIMBLE_FORMAT_RGB565_BE == static_cast<int>(PixelFormat::kRgb565Be) &&
              THIMBLE_FORMAT_BGR565 == static_cast<int>(PixelFormat::kBgr565) &&
              THIMBLE_FORMAT_RGB444 == static_cast<int>(PixelFormat::kRgb444) &&
              THIMBLE_FORMAT_MONO1_PAGES == static_cast<int>(PixelFormat::kMono1Pages) &&
              THIMBLE_FORMAT_GRAY4_LOW == static_cast<int>(PixelFormat::kGray4Low) &&
              THIMBLE_FORMAT_GRAY2 == static_cast<int>(PixelFormat::kGray2) &&
              THIMBLE_FORMAT_PAPER3 == static_cast<int>(PixelFormat::kPaper3) &&
              THIMBLE_FORMAT_PAPER7 == static_cast<int>(PixelFormat::kPaper7) &&
              THIMBLE_FORMAT_RGB332 == static_cast<int>(PixelFormat::kRgb332));
static_assert(kPixelFormats == THIMBLE_FORMAT_RGB332 + 1, "enum thimble_format lacks a format");

// floor(2^32 * numerator / denominator): numerator 0 .. 2^24, denominator 1 .. 2^28. One 32-bit division and
// 32 steps.
int64_t fraction_q32(uint32_t numerator, uint32_t denominator) {
  const uint32_t whole = numerator / denominator;
  uint32_t left = numerator - whole * denominator;
  uint32_t bits = 0;
  for (int step = 0; step < 32; ++step) {
    left <<= 1;
    bits <<= 1;
    if (left >= denominator) {
      left -= denominator;
      bits |= 1U;
    }
  }
  return static_cast<int64_t>(uint64_t{whole} << 32 | bits);
}

}  // namespace

void tell_hit(const Ray& ray, const Hit& hit, thimble_hit_t* to) {
  *to = {};
  to->kind = static_cast<int32_t>(hit.kind);
  to->axis = -1;
  to->t_denominator = 1;
  to->visits = hit.visits;
  if (hit.kind != HitKind::kHit) {
    return;
  }
  to->voxel = to_c(hit.voxel);
  to->axis = hit.axis < 0 ? -1 : static_cast<uint8_t>(hit.axis);
  to->side = hit.axis < 0 ? 0 : looks_to_smaller(ray, hit) ? -1 : 1;
  to->material = hit.material;
  to->block_level = hit.block_level;
  to->t_numerator = hit.t_numerator;
  to->t_denominator = hit.t_denominator;
  to->t_q32 = fraction_q32(static_cast<uint32_t>(hit.t_numerator), static_cast<uint32_t>(hit.t_denominator));
  to->point_q8 = to_c(start_on_face(ray, hit));
}

bool take_shading(const thimble_shading_t* from, Shading* to) {
  if (from == nullptr || from->mode < THIMBLE_SHADE_DEPTH || from->mode > THIMBLE_SHADE_MONO ||
      (from->palette_rgb == nullptr && from->palette_colors != 0)) {
    return false;
  }
  to->mode = static_cast<ShadeMode>(from->mode);
  to->palette = {reinterpret_cast<const Rgb8*>(from->palette_rgb), from->palette_colors};
  to->default_color = {from->default_rgb[0], from->default_rgb[1], from->default_rgb[2]};
  to->background = {from->background_rgb[0], from->background_rgb[1], from->background_rgb[2]};
  to->near_q8 = from->near_q8;
  to->far_q8 = from->far_q8;
  for (int face = 0; face < 6; ++face) {
    to->face_light[face] = from->face_light[face];
  }
  return true;
}

bool take_band(const thimble_band_t* from, Band* to) {
  if (from == nullptr || !is_format(from->format) || (from->pixels == nullptr && from->size_bytes != 0)) {
    return false;
  }
  *to = {{from->pixels, from->size_bytes},
         static_cast<PixelFormat>(from->format),
         from->stride_bytes,
         from->first_row,
         from->rows};
  return true;
}

}  // namespace thimble::c_face

extern "C" size_t thimble_band_bytes(int32_t format, int32_t width_px, int32_t rows) {
  using namespace thimble;
  if (!c_face::is_format(format) || width_px < 0 || width_px > kMaxPicturePx || rows < 0 ||
      rows > kMaxPicturePx) {
    return 0;
  }
  return band_bytes(static_cast<PixelFormat>(format), width_px, rows);
}

extern "C" int32_t thimble_band_row_multiple(int32_t format) {
  using namespace thimble;
  return c_face::is_format(format) ? band_row_multiple(static_cast<PixelFormat>(format)) : 0;
}
