// From a pixel's colour to its bytes, and what surrounds a band.
#include "../picture/band.h"
#include "../picture/panels.h"
#include "arithmetic.h"
#include "exposure.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {
namespace {

// The step, of `levels` above 0, for a channel of 0 .. kWhite: the next one up where the rest is more than
// the pixel's place in the dither.
uint32_t step_of(uint32_t channel, uint32_t levels, const LitOptions& options, int32_t x, int32_t y) {
  const uint32_t place = options.dither ? 2 * bayer_rank(x, y) + 1 : 64;  // of 128
  return (channel * levels + (128 - place) * kWhite / 128) / kWhite;
}

Rgb8 color_565(const uint32_t (&channel)[3], const LitOptions& options, int32_t x, int32_t y) {
  return {static_cast<uint8_t>(step_of(channel[0], 31, options, x, y) << 3),
          static_cast<uint8_t>(step_of(channel[1], 63, options, x, y) << 2),
          static_cast<uint8_t>(step_of(channel[2], 31, options, x, y) << 3)};
}

// The formats behind kRgb888: those with levels are dithered as the others, from all bits that there are. Paper has
// its own dither, in store_pixel, of 8 bits; without one a colour is taken as in the middle of the cell.
Rgb8 panel_color(const uint32_t (&channel)[3], uint32_t gray, PixelFormat format, const LitOptions& options,
                 int32_t x, int32_t y) {
  const auto step = [&](uint32_t value, uint32_t levels) {
    return static_cast<uint8_t>((step_of(value, levels, options, x, y) * 255 + levels / 2) / levels);
  };
  const auto grays = [&](uint32_t levels) {
    const uint8_t value = step(gray, levels);
    return Rgb8{value, value, value};
  };
  if (has_pages(format)) {
    return grays(1);
  }
  if (is_format<PixelFormat::kGray4Low>(format)) {
    return grays(15);
  }
  if (is_format<PixelFormat::kGray2>(format)) {
    return grays(3);
  }
  if (is_format<PixelFormat::kRgb444>(format)) {
    return {step(channel[0], 15), step(channel[1], 15), step(channel[2], 15)};
  }
  if (is_format<PixelFormat::kRgb332>(format)) {
    return {step(channel[0], 7), step(channel[1], 7), step(channel[2], 3)};
  }
  if (is_format<PixelFormat::kRgb565Be>(format) || is_format<PixelFormat::kBgr565>(format)) {
    return color_565(channel, options, x, y);
  }
  Rgb8 color = in_8_bits(channel);
  if (!options.dither) {
    color = panels::flat(color, format);
  }
  return color;
}

}  // namespace

Status draw_plain(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                  LitCounts* counts, const LitOptions& options) {
  RenderCounts plain;
  const Status status = render_band(tree, camera, shading, band, &plain, {options.max_visits, Width::kAuto});
  if (counts != nullptr) {
    constexpr int kPrimary = static_cast<int>(LitRayKind::kPrimary);
    counts->rays[kPrimary] += plain.rays;
    counts->hits[kPrimary] += plain.hits;
    counts->node_visits[kPrimary] += plain.node_visits;
    counts->step_limited += plain.step_limited;
  }
  return status;
}

Status check_frame(const Frame& frame, const Band& band, size_t* stride) {
  const Status status = check_band(frame.camera, frame.tree.level(), band, stride);
  if (status != Status::kOk) {
    return status;
  }
  if (frame.scene.lights.size > kMaxLights || frame.scene.surfaces.size > kMaxSurfaces ||
      frame.scene.bounces > kMaxBounces) {
    return Status::kOutOfRange;
  }
  return Status::kOk;
}

void clear_row(const Frame& frame, const Band& band, uint8_t* line) {
  const size_t bytes = row_bytes(band.format, frame.camera.width_px());
  for (size_t i = 0; i < bytes; ++i) {
    line[i] = 0;
  }
}

void store(const Frame& frame, const Band& band, uint8_t* line, int32_t x, int32_t y, const Color& color) {
  uint32_t channel[3];
  expose(color, &channel);
  const uint32_t gray = (77 * channel[0] + 150 * channel[1] + 29 * channel[2]) >> 8;
  Rgb8 stored;
  switch (band.format) {
    case PixelFormat::kMono1:
    case PixelFormat::kGray4: {
      const uint32_t levels = band.format == PixelFormat::kMono1 ? 1 : 15;
      const uint8_t value = static_cast<uint8_t>(step_of(gray, levels, frame.options, x, y) * (255 / levels));
      stored = {value, value, value};
      break;
    }
    case PixelFormat::kRgb565:
      stored = color_565(channel, frame.options, x, y);
      break;
    case PixelFormat::kGray8:
    case PixelFormat::kRgb888:
      stored = in_8_bits(channel);
      break;
    default:
      if (is_panel(band.format)) {
        stored = panel_color(channel, gray, band.format, frame.options, x, y);
      }
  }
  store_pixel(line, x, y, band.format, stored);
}

void add_counts(const LitCounts& from, LitCounts* to) {
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    to->rays[kind] += from.rays[kind];
    to->hits[kind] += from.hits[kind];
    to->node_visits[kind] += from.node_visits[kind];
  }
  to->step_limited += from.step_limited;
  if (from.pending_high_water > to->pending_high_water) {
    to->pending_high_water = from.pending_high_water;
  }
}

}  // namespace thimble::lit
