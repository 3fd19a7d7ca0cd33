#include "wide/painter.h"

#include <string.h>

#include "wide/exact.h"

namespace thimble::wide {
namespace {

// Shades a hit on that face, with some ray that could make it.
Rgb8 color_of_face(unsigned face, uint8_t material, const Camera& camera, const Shading& shading) {
  Hit hit;
  hit.kind = HitKind::kHit;
  hit.axis = static_cast<int8_t>(face / 2);
  hit.material = material;
  Ray ray;
  ray.direction[static_cast<int>(face / 2)] = face % 2 != 0 ? -1 : 1;
  return shade(hit, ray, camera, shading);
}

}  // namespace

TilePainter::TilePainter(const VoxelLists& lists, const Camera& camera, const Shading& shading,
                         const Band& band)
    : lists_(lists),
      camera_(camera),
      shading_(shading),
      band_(band),
      stride_(band.stride_bytes == 0 ? row_bytes(band.format, camera.width_px()) : band.stride_bytes),
      background_(shade(Hit{}, Ray{}, camera, shading)),
      gray_scale_(gray_scale_of(camera, shading)) {
  for (unsigned face = 0; face < 6; ++face) {
    faces_[face] = color_of_face(face, lists.tree().uniform_material(), camera, shading);
  }
}

const GrayScale* TilePainter::gray_scale() const {
  // Where more than one pixel in twenty-five is tested again, finding all greys at the end takes less time.
  constexpr float kMostMargin = 0.02F;
  const bool is_apt = shading_.mode == ShadeMode::kDepth && !lists_.has_blocks() &&
                      lists_.tree().level() <= kCubeLevel && gray_scale_.floats_tell &&
                      gray_scale_.margin < kMostMargin;
  return is_apt ? &gray_scale_ : nullptr;
}

// Fills the row. In formats of less than a byte, pixels are or'ed into zeros, so covered ones must stay 0.
void TilePainter::fill_background(uint8_t* to, int32_t y, const Depths& depths) const {
  const int32_t width = camera_.width_px();
  const size_t bytes = row_bytes(band_.format, width);
  const bool is_gray = background_.r == background_.g && background_.g == background_.b;
  if (background_ == Rgb8{} || (is_gray && band_.format == PixelFormat::kRgb888) ||
      band_.format == PixelFormat::kGray8) {
    if (begins_bytes(band_.format, y)) {
      memset(to, gray_of(background_), bytes);
    }
    return;
  }
  if (begins_bytes(band_.format, y)) {
    memset(to, 0, bytes);
  }
  for (int32_t x = 0; x < width; ++x) {
    if ((depths.covered[depths.word(x, y)] >> (x & 31) & 1U) == 0) {
      store_pixel(to, x, y, band_.format, background_);
    }
  }
}

void TilePainter::paint(const WideFrame& frame, const Depths& depths, Pixels* pixels) const {
  const uint32_t count = pixels->count;
  unpack(depths, pixels);
  Rgb8 colors[kMostPixels];
  if (shading_.mode == ShadeMode::kMono) {
    for (uint32_t i = 0; i < count; ++i) {
      colors[i] = {255, 255, 255};
    }
  } else {
    if (lists_.has_blocks()) {
      for (uint32_t i = 0; i < count; ++i) {
        pixels->level[i] = level_of(lists_.entries()[pixels->number[i]]);
        const bool is_block = !lists_.merged().empty() && lists_.merged()[pixels->number[i]] != 0;
        pixels->voxels[i] = pixels->level[i] > 0 && !is_block ? 1 : 0;
      }
    }
    uint8_t codes[kMostPixels + 64];
    if (shading_.mode == ShadeMode::kDepth) {
      find_grays(frame, *pixels, gray_scale_, codes);
      if (band_.format == PixelFormat::kGray8) {
        for (uint32_t i = 0; i < count; ++i) {
          line(pixels->y[i])[pixels->x[i]] = codes[i];
        }
        return;
      }
      if (band_.format == PixelFormat::kRgb888) {
        for (uint32_t i = 0; i < count; ++i) {
          uint8_t* const to = line(pixels->y[i]) + 3 * static_cast<size_t>(pixels->x[i]);
          to[0] = to[1] = to[2] = codes[i];
        }
        return;
      }
      for (uint32_t i = 0; i < count; ++i) {
        colors[i] = {codes[i], codes[i], codes[i]};
      }
    } else {
      find_faces(frame, *pixels, codes);
      const bool by_face = shading_.mode == ShadeMode::kNormal || lists_.materials().empty();
      for (uint32_t i = 0; i < count; ++i) {
        colors[i] = by_face
                        ? faces_[codes[i]]
                        : color_of_face(codes[i], lists_.materials()[pixels->number[i]], camera_, shading_);
      }
    }
  }
  if (band_.format == PixelFormat::kRgb888) {
    for (uint32_t i = 0; i < count; ++i) {
      store_pixel(line(pixels->y[i]), pixels->x[i], pixels->y[i], PixelFormat::kRgb888, colors[i]);
    }
    return;
  }
  for (uint32_t i = 0; i < count; ++i) {
    store_pixel(line(pixels->y[i]), pixels->x[i], pixels->y[i], band_.format, colors[i]);
  }
}

uint64_t TilePainter::paint_grays(const WideFrame& frame, const Depths& depths) const {
  const int32_t width = camera_.width_px();
  uint64_t hits = 0;
  if (band_.format == PixelFormat::kGray8) {
    for (int32_t y = frame.tile.y0; y < frame.tile.y1; ++y) {
      hits += put_grays(depths, y, width, gray_of(background_), line(y));
    }
    return hits;
  }
  uint8_t grays[kMaxPicturePx];
  for (int32_t y = frame.tile.y0; y < frame.tile.y1; ++y) {
    uint8_t* const to = line(y);
    hits += put_grays(depths, y, width, 0, grays);
    if (band_.format == PixelFormat::kRgb888) {
      for (int32_t x = 0; x < width; ++x) {
        const uint8_t gray = grays[x];
        to[3 * x] = gray == 0 ? background_.r : gray;
        to[3 * x + 1] = gray == 0 ? background_.g : gray;
        to[3 * x + 2] = gray == 0 ? background_.b : gray;
      }
      continue;
    }
    if (begins_bytes(band_.format, y)) {
      memset(to, 0, row_bytes(band_.format, width));
    }
    for (int32_t x = 0; x < width; ++x) {
      store_pixel(to, x, y, band_.format, grays[x] == 0 ? background_ : Rgb8{grays[x], grays[x], grays[x]});
    }
  }
  return hits;
}

uint64_t TilePainter::paint_tile(const WideFrame& frame, const Depths& depths) const {
  if (depths.gray_scale != nullptr) {
    return paint_grays(frame, depths);
  }
  Pixels pixels;
  pixels.any_levels = lists_.has_blocks();
  if (pixels.any_levels) {
    memset(pixels.level, 0, sizeof(pixels.level));
    memset(pixels.voxels, 0, sizeof(pixels.voxels));
  }
  uint64_t hits = 0;
  const auto paint_those = [&] {
    if (pixels.count != 0) {
      paint(frame, depths, &pixels);
    }
    hits += pixels.count;
    pixels.count = 0;
  };
  for (int32_t y = frame.tile.y0; y < frame.tile.y1; ++y) {
    fill_background(line(y), y, depths);
  }
  for (int32_t left = 0; left < camera_.width_px(); left += 32) {
    int32_t row = frame.tile.y0;
    while ((row = find_covered(depths, left, row, frame.tile.y1, &pixels)) < frame.tile.y1) {
      paint_those();
    }
  }
  paint_those();
  return hits;
}

}  // namespace thimble::wide
