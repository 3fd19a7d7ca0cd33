#include "thimble/drivers/panel_c.h"

#include "thimble/drivers/panel.h"

namespace thimble::drivers {
namespace {

// Sets a panel up beside the handle, which is as it was unless all went well.
template <class Panel, class Handle, class... Arguments>
bool begin_panel(Handle* handle, const thimble_panel_bus_t* bus, int32_t quarter_turns,
                 const Arguments&... arguments) {
  static_assert(sizeof(Panel) <= sizeof(Handle));
  static_assert(__is_trivially_copyable(Panel), "C copies handles as bytes");
  if (handle == nullptr || bus == nullptr || bus->command == nullptr || bus->data == nullptr ||
      bus->wait_ms == nullptr || quarter_turns < 0 || quarter_turns > 3) {
    return false;
  }
  Panel panel;
  if (!panel.begin({bus->context, bus->command, bus->data, bus->wait_ms}, arguments...,
                   static_cast<Rotation>(quarter_turns))) {
    return false;
  }
  __builtin_memcpy(handle, &panel, sizeof panel);  // as bytes, which makes an object of them
  return true;
}

template <class Panel, size_t kModules>
bool begin_module(thimble_color_panel_t* handle, const thimble_panel_bus_t* bus,
                  const ColorGeometry (&modules)[kModules], int32_t module, int32_t format,
                  int32_t quarter_turns) {
  return module >= 0 && static_cast<size_t>(module) < kModules && format >= 0 && format < kPixelFormats &&
         begin_panel<Panel>(handle, bus, quarter_turns, modules[module], static_cast<PixelFormat>(format));
}

// A handle of zeros is a panel without rows, which takes no band.
template <class Panel, class Handle>
bool show(Handle* handle, const thimble_band_t* band) {
  if (handle == nullptr || band == nullptr || band->pixels == nullptr || band->format < 0 ||
      band->format >= kPixelFormats) {
    return false;
  }
  return reinterpret_cast<Panel*>(handle)->show({{band->pixels, band->size_bytes},
                                                 static_cast<PixelFormat>(band->format),
                                                 band->stride_bytes,
                                                 band->first_row,
                                                 band->rows});
}

}  // namespace
}  // namespace thimble::drivers

using namespace thimble::drivers;

extern "C" {

thimble_panel_bus_t thimble_panel_i2c_bus(thimble_panel_i2c_t* wire, void* context,
                                          bool (*write)(void*, const uint8_t*, size_t),
                                          void (*wait_ms)(void*, uint32_t)) {
  using Wire = I2cPanel<>;
  static_assert(sizeof(Wire) <= sizeof(thimble_panel_i2c_t));
  if (wire == nullptr || write == nullptr || wait_ms == nullptr) {
    return {};
  }
  const Wire made(context, write, wait_ms);
  __builtin_memcpy(wire, &made, sizeof made);
  const PanelBus bus = reinterpret_cast<Wire*>(wire)->bus();
  return {bus.context, bus.command, bus.data, bus.wait_ms};
}

bool thimble_ssd1306_begin(thimble_page_panel_t* panel, const thimble_panel_bus_t* bus, int32_t width_px,
                           int32_t height_px, int32_t first_column, int32_t quarter_turns) {
  return begin_panel<Ssd1306>(panel, bus, quarter_turns, PageGeometry{width_px, height_px, first_column});
}
bool thimble_sh1106_begin(thimble_page_panel_t* panel, const thimble_panel_bus_t* bus, int32_t width_px,
                          int32_t height_px, int32_t first_column, int32_t quarter_turns) {
  return begin_panel<Sh1106>(panel, bus, quarter_turns, PageGeometry{width_px, height_px, first_column});
}
bool thimble_st7567_begin(thimble_page_panel_t* panel, const thimble_panel_bus_t* bus, int32_t width_px,
                          int32_t height_px, int32_t first_column, int32_t quarter_turns) {
  return begin_panel<St7567>(panel, bus, quarter_turns, PageGeometry{width_px, height_px, first_column});
}

bool thimble_st7735_begin(thimble_color_panel_t* panel, const thimble_panel_bus_t* bus, int32_t module,
                          int32_t format, int32_t quarter_turns) {
  static constexpr ColorGeometry kModules[] = {St7735::k128x160, St7735::k128x160Red, St7735::k128x160Green,
                                               St7735::k128x128Green, St7735::k80x160};
  return begin_module<St7735>(panel, bus, kModules, module, format, quarter_turns);
}
bool thimble_st7789_begin(thimble_color_panel_t* panel, const thimble_panel_bus_t* bus, int32_t module,
                          int32_t format, int32_t quarter_turns) {
  static constexpr ColorGeometry kModules[] = {St7789::k240x320, St7789::k240x240, St7789::k135x240,
                                               St7789::k170x320};
  return begin_module<St7789>(panel, bus, kModules, module, format, quarter_turns);
}
bool thimble_ili9341_begin(thimble_color_panel_t* panel, const thimble_panel_bus_t* bus, int32_t format,
                           int32_t quarter_turns) {
  static constexpr ColorGeometry kModules[] = {Ili9341::k240x320};
  return begin_module<Ili9341>(panel, bus, kModules, 0, format, quarter_turns);
}

bool thimble_page_panel_show(thimble_page_panel_t* panel, const thimble_band_t* band) {
  return show<PagePanel>(panel, band);
}
bool thimble_color_panel_show(thimble_color_panel_t* panel, const thimble_band_t* band) {
  return show<ColorPanel>(panel, band);
}

}  // extern "C"
