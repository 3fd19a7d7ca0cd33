// Sixty balls that fall, bounce and come to rest in 4.1 KB, band included.
#include "../display.h"
#include "thimble/picture/render.h"
#include "thimble/plane/particles.h"
using namespace thimble;

namespace {

constexpr uint32_t kBalls = 60;
constexpr int32_t kMostDiameter = 8;
uint8_t world_bytes[particles_bytes(kDisplayWidth, kDisplayHeight, kBalls, kMostDiameter)];
uint8_t pixels[band_bytes(PixelFormat::kGray4, kDisplayWidth, kDisplayBandRows)];

Status fill(ParticleWorld* world) {
  ParticleConfig config;  // gravity pulls down the picture; a collision keeps 0.8 of the speed
  config.width = kDisplayWidth;
  config.height = kDisplayHeight;
  config.capacity = kBalls;
  config.most_diameter = kMostDiameter;
  Status status = ParticleWorld::make(config, Bytes(world_bytes), world);
  if (status == Status::kOk) {
    world->draw_wall({30, 48}, {80, 40}, 1);
  }
  for (uint32_t i = 0; i < kBalls && status == Status::kOk; ++i) {
    status = world->spawn_random(65536);  // up to a cell a step
  }
  return status;
}

/// The field that the balls collide in is the picture: a bit a pixel.
void draw(const BitField& field) {
  for (int32_t y = 0; y < kDisplayHeight; ++y) {
    uint8_t* const row = pixels + row_bytes(PixelFormat::kGray4, kDisplayWidth) * (y % kDisplayBandRows);
    for (int32_t x = 0; x < kDisplayWidth; x += 2) {
      const int left = field.test({x, y}) ? 0xF0 : 0;
      const int right = field.test({x + 1, y}) ? 0x0F : 0;
      row[x / 2] = static_cast<uint8_t>(left | right);
    }
    if ((y + 1) % kDisplayBandRows == 0) {
      display_send(y + 1 - kDisplayBandRows, kDisplayBandRows, pixels, sizeof(pixels));
    }
  }
}

}  // namespace

int main() {
  ParticleWorld world;
  const Status status = fill(&world);
  for (uint32_t frame = 0; status == Status::kOk && display_wait(frame); ++frame) {
    draw(world.field());
    world.step();  // costs nothing for balls that lie still
  }
  return static_cast<int>(status);
}
