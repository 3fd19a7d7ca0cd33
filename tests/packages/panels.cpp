// The ball of the README on an SSD1306, over I2C, and on an ST7735, by the drivers of a package: prints a hash of all that
// was sent, which is one number wherever it was built.
#include "thimble/drivers/panel.h"
#include "thimble/thimble.h"
using namespace thimble;

extern "C" int putchar(int character);

namespace {

uint8_t pixels[band_bytes(PixelFormat::kRgb565Be, 160, 8)];
uint32_t sent = 2166136261U;  // FNV-1a

bool send(void*, const uint8_t* bytes, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    sent = (sent ^ bytes[i]) * 16777619U;
  }
  return true;
}
bool send_command(void*, const uint8_t* bytes, size_t count) {
  ++sent;  // D/C is low
  return send(nullptr, bytes, count);
}
void no_wait(void*, uint32_t) {}

Status make_ball(Arena& arena, CompactTree* tree) {
  Octree octree;
  Status status = Octree::make(5, 700, arena, &octree);
  for (int32_t i = 0; i < 32 * 32 * 32 && status == Status::kOk; ++i) {
    const int32_t x = i % 32 - 16;
    const int32_t y = i / 32 % 32 - 16;
    const int32_t z = i / 1024 - 16;
    if (x * x + y * y + z * z < 100) {
      status = octree.insert({x + 16, y + 16, z + 16});
    }
  }
  return status == Status::kOk ? CompactTree::make(octree, arena, tree) : status;
}

template <class Panel>
bool draw(const CompactTree& tree, PixelFormat format, Panel& panel) {
  PerspectiveView view;
  view.eye = {Q8::saturate(0), Q8::saturate(-24), Q8::saturate(36)};
  view.forward = {16, 40, -20};
  view.fov_degrees = Q16::saturate(32);
  view.width_px = panel.width_px();
  view.height_px = panel.height_px();
  Camera camera;
  if (camera.set(view, tree.level()) != Status::kOk) {
    return false;
  }
  Shading shading;
  shading.mode = ShadeMode::kColor;
  for (Band band{Bytes(pixels), format, 0, 0, 8}; band.first_row < panel.height_px(); band.first_row += 8) {
    if (render_band(tree, camera, shading, band) != Status::kOk || !panel.show(band)) {
      return false;
    }
  }
  for (int shift = 28; shift >= 0; shift -= 4) {
    putchar("0123456789abcdef"[sent >> shift & 15U]);
  }
  putchar('\n');
  return true;
}

}  // namespace

int main() {
  static uint8_t memory[8192];
  Arena arena{Bytes(memory)};
  CompactTree tree;
  if (make_ball(arena, &tree) != Status::kOk) {
    return 1;
  }
  drivers::I2cPanel<> wire(nullptr, send, no_wait);
  drivers::Ssd1306 oled;
  if (!oled.begin(wire.bus(), {128, 64}) || !draw(tree, PixelFormat::kMono1Pages, oled)) {
    return 2;
  }
  drivers::St7735 lcd;
  const drivers::PanelBus bus = {nullptr, send_command, send, no_wait};
  const bool shown =
      lcd.begin(bus, drivers::St7735::k128x160, PixelFormat::kRgb565Be, drivers::Rotation::k90) &&
      draw(tree, PixelFormat::kRgb565Be, lcd);
  return shown ? 0 : 3;
}
