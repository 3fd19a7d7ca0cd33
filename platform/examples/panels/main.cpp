// A baked model on two displays by their drivers: an SSD1306 of 128 x 64 and an ST7789 of 240 x 240. RAM: a band of
// 3,840 bytes. scene.h is made by
//   thimble bake MODEL.vox --size 128x64 -o scene.h
#include "panels.h"
#include "scene.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/drivers/panel.h"
#include "thimble/picture/render.h"
using namespace thimble;

namespace {

constexpr int32_t kRows = 8;
uint8_t pixels[band_bytes(PixelFormat::kRgb565Be, 240, kRows)];

// The board's functions for one of the panels, as a driver calls them.
template <int kPanel>
drivers::PanelBus bus() {
  drivers::PanelBus made;
  made.command = [](void*, const uint8_t* bytes, size_t count) {
    return panel_command(kPanel, bytes, count);
  };
  made.data = [](void*, const uint8_t* bytes, size_t count) { return panel_data(kPanel, bytes, count); };
  made.wait_ms = [](void*, uint32_t milliseconds) { panel_wait(milliseconds); };
  return made;
}

/// Draws a frame as large as the panel and sends it band by band.
template <class Panel>
Status draw(const BakedScene& scene, PixelFormat format, Panel& panel) {
  Camera camera;
  Status status =
      set_camera(scene.camera(), panel.width_px(), panel.height_px(), scene.tree().level(), &camera);
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = scene.palette();
  Band band{Bytes(pixels), format, 0, 0, kRows};
  for (; band.first_row < panel.height_px() && status == Status::kOk; band.first_row += kRows) {
    status = render_band(scene.tree(), camera, shading, band);
    if (status == Status::kOk && !panel.show(band)) {
      status = Status::kBadArgument;  // nobody there, or not this panel
    }
  }
  return status;
}

}  // namespace

int main() {
  BakedScene scene;
  Status status = BakedScene::open({thimble_scene, sizeof(thimble_scene)}, &scene);
  drivers::Ssd1306 oled;
  drivers::St7789 lcd;
  if (status == Status::kOk &&
      (!oled.begin(bus<0>(), {128, 64}) ||
       !lcd.begin(bus<1>(), drivers::St7789::k240x240, PixelFormat::kRgb565Be, drivers::Rotation::k90))) {
    return 1;
  }
  if (status == Status::kOk) {
    status = draw(scene, PixelFormat::kMono1Pages, oled);
  }
  if (status == Status::kOk) {
    status = draw(scene, PixelFormat::kRgb565Be, lcd);
  }
  panel_done();
  return static_cast<int>(status);
}
