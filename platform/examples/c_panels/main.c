// A baked model on an SSD1306 and an ST7789 by their drivers, in C99: what ../panels does in C++, with the same functions of
// the board. RAM: a band of 3,840 bytes. scene.h is made by
//   thimble bake MODEL.vox --size 128x64 -o scene.h
#include "../panels/panels.h"
#include "scene.h"
#include "thimble/drivers/panel_c.h"

enum { kRows = 8, kOled = 0, kLcd = 1 };
static uint8_t pixels[240 * 2 * kRows];

// The board's functions for the panel whose number `context` points to, as a driver calls them.
static bool command(void* context, const uint8_t* bytes, size_t count) {
  return panel_command(*(const int*)context, bytes, count);
}
static bool data(void* context, const uint8_t* bytes, size_t count) {
  return panel_data(*(const int*)context, bytes, count);
}
static void wait_ms(void* context, uint32_t milliseconds) {
  (void)context;
  panel_wait(milliseconds);
}

// Draws a frame as large as a panel and sends it band by band.
static int32_t draw(const thimble_scene_t* scene, int32_t format, int32_t side_x, int32_t side_y,
                    thimble_page_panel_t* oled, thimble_color_panel_t* lcd) {
  thimble_view_t view;
  thimble_camera_t camera;
  thimble_shading_t shading;
  thimble_band_t band = {pixels, sizeof pixels, 0, format, 0, kRows};
  int32_t status = thimble_scene_view(scene, &view);
  if (status == THIMBLE_OK) status = thimble_scene_camera(scene, &view, side_x, side_y, &camera);
  if (status == THIMBLE_OK) status = thimble_scene_shading(scene, &shading);
  for (; band.first_row < side_y && status == THIMBLE_OK; band.first_row += kRows) {
    status = thimble_scene_render(scene, &camera, &shading, &band);
    if (status == THIMBLE_OK && !(oled ? thimble_page_panel_show(oled, &band) : thimble_color_panel_show(lcd, &band)))
      status = THIMBLE_BAD_ARGUMENT;  // nobody there, or not this panel
  }
  return status;
}

int main(void) {
  static int numbers[] = {kOled, kLcd};
  const thimble_panel_bus_t buses[] = {{&numbers[0], command, data, wait_ms}, {&numbers[1], command, data, wait_ms}};
  thimble_page_panel_t oled;
  thimble_color_panel_t lcd;
  thimble_scene_t scene;
  int32_t status = thimble_scene_open(&scene, thimble_scene, sizeof thimble_scene);
  if (!thimble_ssd1306_begin(&oled, &buses[kOled], 128, 64, -1, 0) ||
      !thimble_st7789_begin(&lcd, &buses[kLcd], THIMBLE_ST7789_240X240, THIMBLE_FORMAT_RGB565_BE, 1))
    return 1;
  if (status == THIMBLE_OK) status = draw(&scene, THIMBLE_FORMAT_MONO1_PAGES, 128, 64, &oled, NULL);
  if (status == THIMBLE_OK) status = draw(&scene, THIMBLE_FORMAT_RGB565_BE, 240, 240, NULL, &lcd);
  panel_done();
  return (int)status;
}
