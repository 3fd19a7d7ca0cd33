// A fox from flash on an ST7789 (colour, 240 x 240, SPI), the eye going to and fro.
// Libraries: Adafruit ST7735 and ST7789, Adafruit GFX. RAM of its own: 7,680 bytes; stack: 6 KiB.
// scene.h is made by: thimble bake fox --size 240x240 --effects none --brick-map -o scene.h
#include <Adafruit_GFX.h>
#include <Adafruit_ST7789.h>
#include <SPI.h>
#include <thimble.h>
#include <thimble/picture/render.h>

#include "scene.h"

constexpr int16_t kWidth = 240;
constexpr int16_t kHeight = 240;
constexpr int16_t kBandRows = 16;
constexpr int8_t kSelectPin = 10;
constexpr int8_t kDataPin = 9;
constexpr int8_t kResetPin = 8;

Adafruit_ST7789 display(kSelectPin, kDataPin, kResetPin);
alignas(2) uint8_t band_pixels[thimble::band_bytes(thimble::PixelFormat::kRgb565, kWidth, kBandRows)];
thimble::BakedScene scene;
thimble::BrickMap bricks;
int32_t frame = 0;

// All that knows the display: rows of pixels as numbers of 16 bits.
void show_band(int16_t first_row, uint8_t* pixels) {
  display.drawRGBBitmap(0, first_row, reinterpret_cast<uint16_t*>(pixels), kWidth, kBandRows);
}

void stop(const char* why) {
  Serial.println(why);
  for (;;) {
    delay(1000);
  }
}

// Draws the scene with the eye moved sideways by some 1/256 voxel.
thimble::Status draw(int32_t sideways_q8) {
  thimble::SceneCamera from = scene.camera();
  if (sideways_q8 != 0) {
    from.eye.x = thimble::Q8::from_raw(from.eye.x.raw + sideways_q8);
    from.forward = {};  // look at the target from there
  }
  thimble::Camera camera;
  thimble::Status status = thimble::set_camera(from, kWidth, kHeight, scene.tree().level(), &camera);
  thimble::Shading shading;
  shading.mode = thimble::ShadeMode::kColor;
  shading.palette = scene.palette();
  thimble::Band band{thimble::Bytes(band_pixels), thimble::PixelFormat::kRgb565, 0, 0, kBandRows};
  for (; band.first_row < kHeight && status == thimble::Status::kOk; band.first_row += kBandRows) {
    status = thimble::render_band(scene.tree(), bricks, camera, shading, band);
    if (status == thimble::Status::kOk) {
      show_band(static_cast<int16_t>(band.first_row), band_pixels);
    }
  }
  return status;
}

void setup() {
  Serial.begin(115200);
  display.init(kWidth, kHeight);
  thimble::Status status = thimble::BakedScene::open({thimble_scene, sizeof(thimble_scene)}, &scene);
  if (status == thimble::Status::kOk) {
    status = thimble::BrickMap::open(scene.section(thimble::SectionKind::kBrickMap), &bricks);
  }
  if (status != thimble::Status::kOk) {
    stop(thimble::status_text(status));
  }
}

void loop() {
  const int32_t place = frame++ % 256;  // 0 .. 64 .. -64 .. 0 voxels
  const int32_t sideways = place < 64 ? place : place < 192 ? 128 - place : place - 256;
  const thimble::Status status = draw(sideways * 256);
  if (status != thimble::Status::kOk) {
    stop(thimble::status_text(status));
  }
}
