// What the Arduino examples must show first, drawn ray by ray on this machine: expected st7789|ssd1306, a line a row.
#include <cstdint>
#include <cstdio>
#include <vector>

#include "scene.h"
#include "thimble/thimble.h"
using namespace thimble;

int main() {
  BakedScene scene;
  if (BakedScene::open({thimble_scene, sizeof(thimble_scene)}, &scene) != Status::kOk) {
    return 1;
  }
  constexpr PixelFormat kFormat = EXPECTED_COLOR ? PixelFormat::kRgb565 : PixelFormat::kMono1;
  constexpr std::int32_t kWidth = EXPECTED_COLOR ? 240 : 128;
  constexpr std::int32_t kHeight = EXPECTED_COLOR ? 240 : 64;
  Camera camera;
  Shading shading;
  shading.mode = ShadeMode::kColor;
  if (EXPECTED_COLOR) {
    shading.palette = scene.palette();
  } else {
    shading.default_color = {255, 255, 255};
  }
  std::vector<std::uint8_t> pixels(band_bytes(kFormat, kWidth, kHeight));
  const Band band{Bytes{pixels.data(), pixels.size()}, kFormat, 0, 0, kHeight};
  if (set_camera(scene.camera(), kWidth, kHeight, scene.tree().level(), &camera) != Status::kOk ||
      render_band(scene.tree(), camera, shading, band) != Status::kOk) {
    return 1;
  }
  const std::size_t row = row_bytes(kFormat, kWidth);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    std::printf("%02x%s", pixels[EXPECTED_COLOR ? i ^ 1U : i], (i + 1) % row == 0 ? "\n" : "");
  }
}
