/// @file panel_c.h
/// The drivers of displays (panel.h) for C99: what thimble_c.h draws goes to the panel band by band.
///
///     thimble_page_panel_t panel;
///     thimble_panel_i2c_t wire;
///     thimble_panel_bus_t bus = thimble_panel_i2c_bus(&wire, 0, write, wait_ms);
///     thimble_ssd1306_begin(&panel, &bus, 128, 64, -1, 0);
///     thimble_page_panel_show(&panel, &band);  // of THIMBLE_FORMAT_MONO1_PAGES
///
/// A driver is plain bytes that you put where you like, and keeps nothing elsewhere; a bus is copied into it. All bytes 0 it
/// shows nothing. Functions return false where the board's function did, and for arguments that the panel does not take,
/// null among them; then nothing was sent. Units, geometries and sources: panel.h.
#ifndef THIMBLE_DRIVERS_PANEL_C_H
#define THIMBLE_DRIVERS_PANEL_C_H

#include "../thimble_c.h"

#ifdef __cplusplus
typedef bool thimble_bool_t;
extern "C" {
#else
typedef _Bool thimble_bool_t;
#endif

/// The board's functions. `context` is handed to each of them. They say whether the panel took the bytes.
typedef struct thimble_panel_bus {
  void* context;
  thimble_bool_t (*command)(void* context, const uint8_t* bytes, size_t count);  ///< with D/C low
  thimble_bool_t (*data)(void* context, const uint8_t* bytes, size_t count);     ///< with D/C high
  void (*wait_ms)(void* context, uint32_t milliseconds);
} thimble_panel_bus_t;

/// A panel on I2C. Made by thimble_panel_i2c_bus.
typedef struct THIMBLE_HANDLE thimble_panel_i2c {
  void* opaque[3];
} thimble_panel_i2c_t;
/// An SSD1306, SH1106 or ST7567, of one bit.
typedef struct THIMBLE_HANDLE thimble_page_panel {
  void* opaque[sizeof(void*) > 4 ? 6 : 8];
} thimble_page_panel_t;
/// An ST7735, ST7789 or ILI9341, in colours.
typedef struct THIMBLE_HANDLE thimble_color_panel {
  void* opaque[sizeof(void*) > 4 ? 7 : 9];
} thimble_color_panel_t;

/// The bus of a panel at one address of I2C: `write` sends one transfer of at most 32 bytes there. `wire` outlives the
/// panel's use.
thimble_panel_bus_t thimble_panel_i2c_bus(thimble_panel_i2c_t* wire, void* context,
                                          thimble_bool_t (*write)(void* context, const uint8_t* bytes,
                                                                  size_t count),
                                          void (*wait_ms)(void* context, uint32_t milliseconds));

/// Each sets its panel up, clears it and turns it on. `first_column`: -1, or what PageGeometry says; `quarter_turns`
/// clockwise, 0 or 2.
thimble_bool_t thimble_ssd1306_begin(thimble_page_panel_t* panel, const thimble_panel_bus_t* bus,
                                     int32_t width_px, int32_t height_px, int32_t first_column,
                                     int32_t quarter_turns);
thimble_bool_t thimble_sh1106_begin(thimble_page_panel_t* panel, const thimble_panel_bus_t* bus,
                                    int32_t width_px, int32_t height_px, int32_t first_column,
                                    int32_t quarter_turns);
thimble_bool_t thimble_st7567_begin(thimble_page_panel_t* panel, const thimble_panel_bus_t* bus,
                                    int32_t width_px, int32_t height_px, int32_t first_column,
                                    int32_t quarter_turns);

/// Modules, by the names of panel.h.
enum thimble_st7735_module {
  THIMBLE_ST7735_128X160 = 0,
  THIMBLE_ST7735_128X160_RED = 1,
  THIMBLE_ST7735_128X160_GREEN = 2,
  THIMBLE_ST7735_128X128_GREEN = 3,
  THIMBLE_ST7735_80X160 = 4
};
enum thimble_st7789_module {
  THIMBLE_ST7789_240X320 = 0,
  THIMBLE_ST7789_240X240 = 1,
  THIMBLE_ST7789_135X240 = 2,
  THIMBLE_ST7789_170X320 = 3
};
/// `format`: THIMBLE_FORMAT_RGB565_BE, or THIMBLE_FORMAT_RGB444, which an ILI9341 has not; `quarter_turns` clockwise, 0 to 3.
thimble_bool_t thimble_st7735_begin(thimble_color_panel_t* panel, const thimble_panel_bus_t* bus,
                                    int32_t module, int32_t format, int32_t quarter_turns);
thimble_bool_t thimble_st7789_begin(thimble_color_panel_t* panel, const thimble_panel_bus_t* bus,
                                    int32_t module, int32_t format, int32_t quarter_turns);
thimble_bool_t thimble_ili9341_begin(thimble_color_panel_t* panel, const thimble_panel_bus_t* bus,
                                     int32_t format, int32_t quarter_turns);

/// Sends the rows of a band, as wide as the (turned) panel and in its format.
thimble_bool_t thimble_page_panel_show(thimble_page_panel_t* panel, const thimble_band_t* band);
thimble_bool_t thimble_color_panel_show(thimble_color_panel_t* panel, const thimble_band_t* band);

#ifdef __cplusplus
}
#endif

#endif
