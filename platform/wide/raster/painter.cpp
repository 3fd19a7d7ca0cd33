#include "wide/raster/painter.h"

#include <string.h>

#include <algorithm>

#include "wide/raster/exact.h"

namespace thimble::wide {
namespace {

// Shades a hit on a face, with some ray that could hit it.
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
  const bool is_gray = shading.mode == ShadeMode::kDepth;
  gray_scale_.code = is_gray ? GrayScale::Code::kGray : GrayScale::Code::kFace;
  if (shading.mode == ShadeMode::kColor && !lists.materials().empty()) {
    // Beyond the palette all materials have one colour.
    material_count_ = static_cast<uint32_t>(shading.palette.size < 255 ? shading.palette.size : 255) + 1;
  }
  for (uint32_t material = 0; material < material_count_; ++material) {
    const uint8_t shown =
        material_count_ == 1 ? lists.tree().uniform_material() : static_cast<uint8_t>(material);
    for (unsigned face = 0; face < 6 && !is_gray; ++face) {
      colors_[material][face] = color_of_face(face, shown, camera, shading);
    }
  }
  has_bytes_ = find_bytes();
}

const GrayScale* TilePainter::gray_scale() const {
  // Above this margin more than one pixel in twenty-five is found again in integers; finding all greys at the end then
  // takes less time.
  constexpr float kMostMargin = 0.02F;
  if (lists_.has_blocks()) {
    return nullptr;
  }
  const bool is_apt = gray_scale_.code == GrayScale::Code::kGray
                          ? gray_scale_.floats_tell && gray_scale_.margin < kMostMargin
                          : shading_.mode != ShadeMode::kColor || lists_.materials().empty();
  return is_apt ? &gray_scale_ : nullptr;
}

// Fills rows that follow one another. Of large pieces memset and memcpy do not read what they are about to write; of rows
// by themselves they do, which takes twice the time.
void TilePainter::fill_piece(uint8_t* to, size_t size) const {
  if (background_ == Rgb8{}) {
    memset(to, 0, size);  // black is 0 in all formats
    return;
  }
  const size_t pixel = static_cast<size_t>(bits_per_pixel(band_.format) / 8);
  const size_t most = pixel * 8192;  // stays in a first-level cache
  store_pixel(to, 0, 0, band_.format, background_);
  for (size_t filled = pixel; filled < size;) {
    const size_t more = std::min({filled, most, size - filled});
    memcpy(to + filled, to, more);
    filled += more;
  }
}

// Fills the rows of the tile. Where pixels share bytes they are or'ed into zeros, so covered pixels must stay 0.
void TilePainter::fill_background(const WideFrame& frame, const Depths& depths) const {
  const int32_t width = camera_.width_px();
  const size_t bytes = row_bytes(band_.format, width);
  const bool is_whole = bits_per_pixel(band_.format) % 8 == 0;
  const bool is_one_piece = stride_ == bytes && !has_pages(band_.format);
  if (is_one_piece && (is_whole || background_ == Rgb8{})) {
    fill_piece(line(frame.tile.y0), bytes * static_cast<size_t>(frame.tile.y1 - frame.tile.y0));
    return;
  }
  const uint8_t* filled = nullptr;  // a row like all others
  for (int32_t y = frame.tile.y0; y < frame.tile.y1; ++y) {
    uint8_t* const to = line(y);
    if (filled != nullptr) {
      memcpy(to, filled, bytes);
      continue;
    }
    if (begins_bytes(band_.format, y)) {
      memset(to, 0, bytes);
    }
    if (background_ == Rgb8{}) {
      continue;
    }
    for (int32_t x = 0; x < width; ++x) {
      if (is_whole || (depths.covered[depths.word(x, y)] >> (x & 31) & 1U) == 0) {
        store_pixel(to, x, y, band_.format, background_);
      }
    }
    filled = is_whole ? to : nullptr;
  }
}

void TilePainter::store_colors(const Pixels& pixels, const Rgb8* colors) const {
  for (uint32_t i = 0; i < pixels.count; ++i) {
    store_pixel(line(pixels.y[i]), pixels.x[i], pixels.y[i], band_.format, colors[i]);
  }
}

void TilePainter::paint_grays(const WideFrame& frame, const Pixels& pixels) const {
  uint8_t grays[kMostPixels + 64];
  find_grays(frame, pixels, gray_scale_, grays);
  if (band_.format == PixelFormat::kGray8) {
    for (uint32_t i = 0; i < pixels.count; ++i) {
      line(pixels.y[i])[pixels.x[i]] = grays[i];
    }
    return;
  }
  Rgb8 colors[kMostPixels];
  for (uint32_t i = 0; i < pixels.count; ++i) {
    colors[i] = {grays[i], grays[i], grays[i]};
  }
  store_colors(pixels, colors);
}

void TilePainter::find_colors(const WideFrame& frame, const Pixels& pixels, Rgb8* colors) const {
  uint8_t codes[kMostPixels + 64];
  find_faces(frame, pixels, codes);
  const uint32_t most = material_count_ - 1;
  const uint8_t* const materials = material_count_ == 1 ? nullptr : lists_.materials().data;
  for (uint32_t i = 0; i < pixels.count; ++i) {
    const uint32_t material = materials == nullptr ? 0 : materials[pixels.number[i]];
    colors[i] = colors_[material < most ? material : most][codes[i]];
  }
}

void TilePainter::paint(const WideFrame& frame, const Depths& depths, Pixels* pixels) const {
  unpack(depths, pixels);
  if (lists_.has_blocks()) {
    for (uint32_t i = 0; i < pixels->count; ++i) {
      pixels->level[i] = level_of(lists_.entries()[pixels->number[i]]);
      const bool is_block = !lists_.merged().empty() && lists_.merged()[pixels->number[i]] != 0;
      pixels->voxels[i] = pixels->level[i] > 0 && !is_block ? 1 : 0;
    }
  }
  if (shading_.mode == ShadeMode::kDepth) {
    paint_grays(frame, *pixels);
    return;
  }
  Rgb8 colors[kMostPixels];
  if (shading_.mode == ShadeMode::kMono) {
    for (uint32_t i = 0; i < pixels->count; ++i) {
      colors[i] = {255, 255, 255};
    }
  } else {
    find_colors(frame, *pixels, colors);
  }
  store_colors(*pixels, colors);
}

Rgb8 TilePainter::color_of_code(unsigned code) const {
  const uint8_t gray = static_cast<uint8_t>(code);
  if (code == 0) {
    return background_;
  }
  return gray_scale_.code == GrayScale::Code::kGray ? Rgb8{gray, gray, gray}
         : shading_.mode == ShadeMode::kMono        ? Rgb8{255, 255, 255}
                                                    : colors_[0][code - 1];
}

// Finds the bytes of codes. Returns whether a code alone decides a pixel's bytes in this format.
bool TilePainter::find_bytes() {
  const PixelFormat format = band_.format;
  const bool is_gray = gray_scale_.code == GrayScale::Code::kGray;
  const bool is_16 =
      format == PixelFormat::kRgb565 || format == PixelFormat::kRgb565Be || format == PixelFormat::kBgr565;
  const bool is_kept = format == PixelFormat::kGray8 || format == PixelFormat::kRgb888;
  if (bits_per_pixel(format) % 8 != 0 || (is_gray && !is_16 && !is_kept)) {
    return false;
  }
  bytes_.size = bits_per_pixel(format) / 8;
  bytes_.is_gray = is_gray;
  bytes_.high_first = format == PixelFormat::kRgb565Be;
  for (unsigned code = 0; code < (is_gray ? 1U : 7U); ++code) {
    uint8_t pixel[3] = {};
    store_pixel(pixel, 0, 0, format, color_of_code(code));
    for (int i = 0; i < bytes_.size; ++i) {
      bytes_.of[i][code] = pixel[i];
    }
  }
  return true;
}

uint64_t TilePainter::paint_codes(const WideFrame& frame, const Depths& depths) const {
  const int32_t width = camera_.width_px();
  uint64_t hits = 0;
  if (depths.is_touched != nullptr) {
    fill_background(frame, depths);
    return put_touched(depths, width, bytes_, line(frame.tile.y0), stride_);
  }
  if (has_bytes_) {
    for (int32_t y = frame.tile.y0; y < frame.tile.y1; ++y) {
      hits += put_colors(depths, y, width, bytes_, line(y));
    }
    return hits;
  }
  // A table gives each pixel's colour: a branch on its code would be mispredicted.
  Rgb8 colors[256];
  const unsigned codes_used = gray_scale_.code == GrayScale::Code::kGray ? 256U : 7U;
  for (unsigned code = 0; code < codes_used; ++code) {
    colors[code] = color_of_code(code);
  }
  uint8_t stored[256];  // for formats of one byte a pixel
  const bool is_byte = bits_per_pixel(band_.format) == 8;
  for (unsigned code = 0; is_byte && code < 256; ++code) {
    store_pixel(stored + code, 0, 0, band_.format, colors[code]);
  }
  const CodeBytes same{1, true, false, {}};
  uint8_t codes[kMaxPicturePx];
  for (int32_t y = frame.tile.y0; y < frame.tile.y1; ++y) {
    uint8_t* const to = line(y);
    const uint32_t count = put_colors(depths, y, width, same, codes);
    hits += count;
    if (begins_bytes(band_.format, y)) {
      memset(to, 0, row_bytes(band_.format, width));
    }
    if (count == 0 && background_ == Rgb8{}) {
      continue;  // black is 0 in all formats
    }
    for (int32_t x = 0; is_byte && x < width; ++x) {
      to[x] = stored[codes[x]];
    }
    for (int32_t x = 0; !is_byte && x < width; ++x) {
      store_pixel(to, x, y, band_.format, colors[codes[x]]);
    }
  }
  return hits;
}

uint64_t TilePainter::paint_tile(const WideFrame& frame, const Depths& depths) const {
  if (depths.gray_scale != nullptr) {
    return paint_codes(frame, depths);
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
  fill_background(frame, depths);
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
