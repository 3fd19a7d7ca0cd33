// A ball on the display that the board's devicetree chooses (zephyr,display), the eye going to and fro: 10 KiB of RAM
// for the world, a band of rows, and 4 KiB of stack. Panels of 16 or 24 bits a pixel.
#include <zephyr/device.h>
#include <zephyr/drivers/display.h>
#include <zephyr/kernel.h>
#include <zephyr/sys/printk.h>
#include <zephyr/version.h>

#include "thimble/thimble.h"
using namespace thimble;

namespace {

constexpr int32_t kMostWidth = 320;
constexpr int32_t kMostRows = 8;
uint8_t memory[10240];
alignas(4) uint8_t pixels[kMostWidth * kMostRows * 3];

// Both orders of the bytes of a pixel of 16 bits have a format; which has which changed in Zephyr 4.4.
#if ZEPHYR_VERSION_CODE >= ZEPHYR_VERSION(4, 4, 0)
constexpr display_pixel_format kHighByteFirst = PIXEL_FORMAT_RGB_565X;
constexpr display_pixel_format kLowByteFirst = PIXEL_FORMAT_RGB_565;
#else
constexpr display_pixel_format kHighByteFirst = PIXEL_FORMAT_RGB_565;
constexpr display_pixel_format kLowByteFirst = PIXEL_FORMAT_BGR_565;
#endif

void swap_bytes(size_t size) {
  for (size_t i = 0; i + 1 < size; i += 2) {
    const uint8_t low = pixels[i];
    pixels[i] = pixels[i + 1];
    pixels[i + 1] = low;
  }
}

/// All that knows the display: rows of the picture, which are free again when it returns.
int show(const device* panel, const display_capabilities& panel_is, const Band& band) {
  if (panel_is.current_pixel_format == kHighByteFirst) {
    swap_bytes(band.pixels.size);
  }
  display_buffer_descriptor rows{};
  rows.buf_size = static_cast<uint32_t>(band.pixels.size);
  rows.width = panel_is.x_resolution;
  rows.height = static_cast<uint16_t>(band.rows);
  rows.pitch = rows.width;
  return display_write(panel, 0, static_cast<uint16_t>(band.first_row), &rows, pixels);
}

Status build(CompactTree* tree) {
  Arena arena{Bytes(memory)};
  Octree octree;
  Status status = Octree::make(5, 700, arena, &octree);
  for (int32_t i = 0; i < 32 * 32 * 32 && status == Status::kOk; ++i) {
    const int32_t x = i % 32 - 16, y = i / 32 % 32 - 16, z = i / 1024 - 16;
    if (x * x + y * y + z * z < 100) {
      status = octree.insert({x + 16, y + 16, z + 16});
    }
  }
  return status == Status::kOk ? CompactTree::make(octree, arena, tree) : status;
}

Status draw(const CompactTree& tree, int32_t sideways, const device* panel,
            const display_capabilities& panel_is) {
  PerspectiveView view;
  view.eye = {Q8::saturate(sideways), Q8::saturate(-24), Q8::saturate(36)};
  view.forward = {16 - sideways, 40, -20};
  view.fov_degrees = Q16::saturate(32);
  view.width_px = panel_is.x_resolution;
  view.height_px = panel_is.y_resolution;
  Camera camera;
  Status status = camera.set(view, tree.level());
  Shading shading;
  shading.mode = ShadeMode::kColor;
  const bool wide = panel_is.current_pixel_format == PIXEL_FORMAT_RGB_888;
  Band band;
  band.format = wide ? PixelFormat::kRgb888 : PixelFormat::kRgb565;
  for (; band.first_row < view.height_px && status == Status::kOk; band.first_row += band.rows) {
    const int32_t left = view.height_px - band.first_row;
    band.rows = left < kMostRows ? left : kMostRows;
    band.pixels = Bytes(pixels).subspan(0, band_bytes(band.format, view.width_px, band.rows));
    status = render_band(tree, camera, shading, band);
    if (status == Status::kOk && show(panel, panel_is, band) != 0) {
      printk("thimble: the display takes no rows from %d\n", static_cast<int>(band.first_row));
    }
  }
  return status;
}

}  // namespace

int main() {
  const device* panel = DEVICE_DT_GET(DT_CHOSEN(zephyr_display));
  if (!device_is_ready(panel)) {
    printk("thimble: the display is not ready\n");
    return 1;
  }
  display_capabilities panel_is{};
  display_get_capabilities(panel, &panel_is);
  const display_pixel_format format = panel_is.current_pixel_format;
  if (format != kHighByteFirst && format != kLowByteFirst && format != PIXEL_FORMAT_RGB_888) {
    printk("thimble: this sample draws RGB_565 and RGB_888; the display has format %d\n",
           static_cast<int>(format));
    return 1;
  }
  if (panel_is.x_resolution > kMostWidth) {
    printk("thimble: kMostWidth is %d; the display has %d columns\n", static_cast<int>(kMostWidth),
           panel_is.x_resolution);
    return 1;
  }
  CompactTree tree;
  Status status = build(&tree);
  display_blanking_off(panel);
  for (int32_t step = 0; status == Status::kOk; step = (step + 1) % 32) {
    status = draw(tree, step < 16 ? step : 32 - step, panel, panel_is);
    k_sleep(K_MSEC(1));
  }
  printk("thimble: %s\n", status_text(status));
  return 1;
}
