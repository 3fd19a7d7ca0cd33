// The paper's particle world on the display: a cell is a pixel, and nothing is kept but the world.
//
//   buttons   gravity pulls where they point; select blows balls away from the middle
//   w a s d   the same directions over the UART; 0 turns gravity off
//   r         begins again
//   c         the line below, now
//   q         ends, with status 0
//
// It says `steps N crc XXXXXXXX` (ParticleWorld::state_crc32) at every kToldSteps steps and at the end.
// Before anything is shown it makes that many steps once and tells the first of these lines, whatever the
// hand does: tests hold it against the host's. Then the world begins again.
#include "apps/particles_world.h"

#include "apps/apps.h"
#include "apps/ball_color.h"
#include "apps/band_turns.h"
#include "apps/place.h"
#include "apps/text.h"
#include "port.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"

namespace thimble::apps {
namespace {

constexpr int kKeysAFrame = 16;
constexpr int32_t kGravityQ16 = 6554;

struct Game : Placed {
  ParticleWorld world;
  ParticleConfig config;
  Bytes bytes;  ///< the world's
  Bands bands;
  uint32_t held = 0;  ///< buttons
};

[[gnu::noinline]] void tell_state(const ParticleWorld& world) {
  put("steps ", world.steps(), " crc ", Hex{world.state_crc32()}, "\n");
}

/// Balls only: here nobody draws walls. Formats below a byte take each pixel once, so nothing may lie below.
[[gnu::noinline]] void draw_band(const ParticleWorld& world, const Band& band, int32_t width) {
  for (uint8_t& byte : band.pixels) {
    byte = 0;
  }
  const size_t stride = row_bytes(band.format, width);
  const bool is_gray = thimble::is_gray(band.format);
  const int32_t end = band.first_row + band.rows;
  uint32_t balls_left = world.count();
  for (uint32_t id = 0; balls_left > 0; ++id) {
    Particle ball;
    if (!world.particle(id, &ball)) {
      continue;
    }
    --balls_left;
    const Rgb8 color = is_gray ? ball_gray(id, ball.asleep) : ball_color(ball.diameter, ball.asleep);
    const uint32_t* const rows = small_disc_rows(ball.diameter);
    for (int32_t row = 0; row < ball.diameter; ++row) {
      const int32_t y = ball.corner.y + row;
      if (y < band.first_row || y >= end) {
        continue;
      }
      uint8_t* const pixels = band.pixels.data + stride * row_place(band.format, y - band.first_row);
      for (int32_t column = 0; column < ball.diameter; ++column) {
        if ((rows[row] >> column & 1U) != 0) {
          store_pixel(pixels, ball.corner.x + column, y, band.format, color);
        }
      }
    }
  }
}

[[gnu::noinline]] void draw_frame(Game* game) {
  const int32_t height = display().height_px;
  for (int32_t y = 0; y < height; y += game->bands.rows) {
    const Band band = game->bands.next(y, height);
    draw_band(game->world, band, display().width_px);
    game->bands.send(band);
  }
}

/// Where a change of the buttons makes gravity pull.
void steer(Game* game) {
  const uint32_t buttons = port::buttons();
  const uint32_t directions = buttons & (port::kUp | port::kDown | port::kLeft | port::kRight);
  if (buttons != game->held && directions != 0) {
    const auto pull = [directions](uint32_t less, uint32_t more) {
      return ((directions & more) != 0 ? kGravityQ16 : 0) - ((directions & less) != 0 ? kGravityQ16 : 0);
    };
    static_cast<void>(
        game->world.set_gravity({pull(port::kLeft, port::kRight), pull(port::kUp, port::kDown)}));
  }
  game->held = buttons;
  const port::Display& screen = display();
  game->world.set_pointer((buttons & port::kSelect) != 0 ? PointerMode::kRepel : PointerMode::kNone,
                          {screen.width_px / 2, screen.height_px / 2}, screen.width_px);
}

[[gnu::noinline]] bool begin(Game* game) {
  return begin_particles(game->bytes, game->config, &game->world) == Status::kOk;
}

/// Whether to continue.
[[gnu::noinline]] bool obey(Game* game) {
  steer(game);
  for (int i = 0; i < kKeysAFrame; ++i) {
    Vec2i gravity;
    switch (port::read()) {
      case -1:
        return true;
      case 'q':
        return false;
      case 'c':
        tell_state(game->world);
        continue;
      case 'r':
        static_cast<void>(begin(game));
        continue;
      case 'w':
        gravity.y = -kGravityQ16;
        break;
      case 's':
        gravity.y = kGravityQ16;
        break;
      case 'a':
        gravity.x = -kGravityQ16;
        break;
      case 'd':
        gravity.x = kGravityQ16;
        break;
      case '0':
        break;
      default:
        continue;
    }
    static_cast<void>(game->world.set_gravity(gravity));
  }
  return true;
}

}  // namespace

int particles() {
  Arena arena(port::arena());
  Game* const game = place<Game>(&arena);
  if (game == nullptr) {
    return refuse("the arena is too small");
  }
  const port::Display& screen = display();
  // Rows of the picture first, then as many balls as what is left holds.
  const bool has_bands = game->bands.take(&arena);
  game->bytes = arena.rest();
  game->config = particles_config(screen.width_px, screen.height_px, game->bytes.size);
  if (!has_bands || game->config.capacity == 0 || !begin(game)) {
    return refuse("the arena holds no world of the display's size");
  }
  put("particles ", game->world.count(), " in ", static_cast<uint32_t>(game->config.width), " x ",
      static_cast<uint32_t>(game->config.height), ", world of ", game->world.used_bytes(), " bytes\n");

  for (uint32_t i = 0; i < kToldSteps; ++i) {
    game->world.step();
  }
  tell_state(game->world);
  if (!begin(game)) {
    return refuse("the world does not begin again");
  }
  for (uint32_t drawn = 0; port::running(drawn) && obey(game); ++drawn) {
    game->world.step();
    draw_frame(game);
    if (game->world.steps() % kToldSteps == 0) {
      tell_state(game->world);
    }
  }
  tell_state(game->world);
  return 0;
}

}  // namespace thimble::apps
