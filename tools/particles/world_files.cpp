#include "particles/world_files.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "apps/ball_color.h"
#include "host/canvas.h"
#include "output/tables.h"

namespace thimble::tools {

std::string state_csv(const ParticleWorld& world) {
  std::string text(kStateColumns);
  text += '\n';
  for_each_ball(world, [&](const Particle& ball) {
    std::array<char, 128> line{};
    std::snprintf(line.data(), line.size(), "%u,%d,%d,%d,%d,%d,%d\n", static_cast<unsigned>(ball.id),
                  ball.x_q16, ball.y_q16, ball.vx_q16, ball.vy_q16, ball.radius_q16, ball.asleep ? 1 : 0);
    text += line.data();
  });
  return text;
}

std::string particle_stats(const PopulatedWorld& populated, const PlayedCounts& counts, double step_seconds) {
  const ParticleWorld& world = populated.world();
  JsonRow json;
  put_all(&json, "width", world.config().width, "height", world.config().height, "seed",
          populated.options().seed, "steps", counts.steps, "particles", world.count(), "asleep",
          world.asleep(), "collisions", counts.ball_hits + counts.wall_hits, "ball_hits", counts.ball_hits,
          "wall_hits", counts.wall_hits, "moves", counts.moves, "mask_tests", counts.mask_tests, "woken",
          counts.woken, "bytes", world.used_bytes(), "field_bytes", world.field().used_bytes(), "capacity",
          world.config().capacity, "step_seconds", step_seconds, "state_crc32",
          crc_text(world.state_crc32()));
  return json_text(json);
}

std::string particle_summary(const PopulatedWorld& populated, const PlayedCounts& counts,
                             double step_seconds) {
  const ParticleWorld& world = populated.world();
  const double step_us = 1e6 * step_seconds / static_cast<double>(counts.steps);
  const std::string time = counts.steps == 0 ? "" : ", " + fixed(step_us, 2) + " us a step";
  return counted(world.count(), "ball") + ", " + counted(counts.steps, "step") + time + "; asleep " +
         grouped(world.asleep()) + ", collisions " + grouped(counts.ball_hits + counts.wall_hits) + "; " +
         grouped(world.used_bytes()) + " bytes; state " + crc_text(world.state_crc32()) + "\n";
}

namespace {

constexpr Rgb8 kGround{10, 12, 18};
constexpr Rgb8 kText{228, 232, 238};

}  // namespace

void draw_world(const PopulatedWorld& populated, std::vector<std::uint8_t>* rgb) {
  const ParticleWorld& world = populated.world();
  const BitField& field = world.field();
  const std::size_t row_bytes = 3 * static_cast<std::size_t>(field.width());
  rgb->resize(row_bytes * static_cast<std::size_t>(field.height()));
  const auto put = [&](std::int32_t x, std::int32_t y, Rgb8 color) {
    store_pixel(rgb->data() + row_bytes * static_cast<std::size_t>(y), x, y, PixelFormat::kRgb888, color);
  };
  for (std::int32_t y = 0; y < field.height(); ++y) {
    for (std::int32_t x = 0; x < field.width(); ++x) {
      const bool is_set = (field.cells_32(x >> 5, y) >> (x & 31) & 1U) != 0;
      put(x, y, is_set ? apps::kWallColor : kGround);
    }
  }
  for_each_ball(world, [&](const Particle& ball) {
    const Rgb8 color = populated.color_of(ball);
    const std::uint32_t* const rows = small_disc_rows(ball.diameter);
    for (std::int32_t row = 0; row < ball.diameter; ++row) {
      for (std::int32_t column = 0; column < ball.diameter; ++column) {
        if ((rows[row] >> column & 1U) != 0) {
          put(ball.corner.x + column, ball.corner.y + row, color);
        }
      }
    }
  });
}

void draw_figures(std::int32_t width_px, std::int32_t height_px, std::string_view text,
                  std::vector<std::uint8_t>* rgb) {
  const host::TextSize size = host::text_size(text);
  const std::int32_t scale =
      std::clamp(width_px / (3 * host::kGlyphWidthPx * std::max(size.columns, 1)), 1, 3);
  host::Canvas canvas;
  canvas.resize(width_px, height_px);
  host::draw_text(&canvas, 5 * scale, 5 * scale, scale, kText, text);
  for (std::size_t pixel = 0; pixel < canvas.pixels.size(); ++pixel) {
    if (canvas.pixels[pixel] == kText) {
      store_pixel(rgb->data() + 3 * pixel, 0, 0, PixelFormat::kRgb888, kText);
    }
  }
}

Image field_image(const BitField& field) {
  Image image{field.width(), field.height(), PixelFormat::kMono1, {}};
  const std::size_t stride = row_bytes(PixelFormat::kMono1, field.width());
  image.pixels.assign(stride * static_cast<std::size_t>(field.height()), 0);
  for (std::int32_t y = 0; y < field.height(); ++y) {
    std::uint8_t* const row = image.pixels.data() + stride * static_cast<std::size_t>(y);
    for (std::int32_t x = 0; x < field.width(); ++x) {
      if (!field.test({x, y})) {
        store_pixel(row, x, y, PixelFormat::kMono1, {255, 255, 255});
      }
    }
  }
  return image;
}

}  // namespace thimble::tools
