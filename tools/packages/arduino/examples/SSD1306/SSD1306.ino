// A castle from flash on an SSD1306 (OLED, 128 x 64, I2C), the eye going to and fro.
// Libraries: Adafruit SSD1306, Adafruit GFX. RAM of its own: 128 bytes; stack: 6 KiB.
// scene.h is made by: thimble bake castle --size 128x64 --effects none --brick-map -o scene.h
#include <Adafruit_GFX.h>
#include <Adafruit_SSD1306.h>
#include <Wire.h>
#include <thimble.h>
#include <thimble/picture/render.h>

#include "scene.h"

constexpr int16_t kWidth = 128;
constexpr int16_t kHeight = 64;
constexpr int16_t kBandRows = 8;
constexpr uint8_t kAddress = 0x3C;  // some modules: 0x3D

Adafruit_SSD1306 display(kWidth, kHeight, &Wire, -1);
uint8_t band_pixels[thimble::band_bytes(thimble::PixelFormat::kMono1, kWidth, kBandRows)];
thimble::BakedScene scene;
thimble::BrickMap bricks;
int32_t frame = 0;

// All that knows the display: rows of bits, the leftmost pixel in a byte's highest bit, and the end of a frame.
void show_band(int16_t first_row, uint8_t* bits) {
  display.drawBitmap(0, first_row, bits, kWidth, kBandRows, SSD1306_WHITE, SSD1306_BLACK);
}
void show_frame() {
  display.display();
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
  thimble::Shading shading;  // without a palette everything is white, and only the light tells faces apart
  shading.mode = thimble::ShadeMode::kColor;
  shading.default_color = {255, 255, 255};
  thimble::Band band{thimble::Bytes(band_pixels), thimble::PixelFormat::kMono1, 0, 0, kBandRows};
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
  if (!display.begin(SSD1306_SWITCHCAPVCC, kAddress)) {
    stop("no SSD1306 answers");
  }
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
  show_frame();
}
