// The panels of platform/examples/panels on this machine: models, whose pictures are written to ssd1306.pbm and
// st7789.ppm where the program runs. Exit status 3 where a model complains.
#include "../../platform/examples/panels/panels.h"

#include <cstdio>
#include <cstdlib>

#include "support/panel_model.h"

namespace {

using thimble::tests::ColorModel;
using thimble::tests::PageModel;

PageModel oled(PageModel::Kind::kSsd1306, 128, 64, 0);
ColorModel lcd(ColorModel::Kind::kSt7789, {240, 240, 240, 320, 0, 0, false, false, false, true});

thimble::drivers::PanelBus bus_of(int panel) {
  return panel == 0 ? oled.spi() : lcd.spi();
}

}  // namespace

bool panel_command(int panel, const std::uint8_t* bytes, std::size_t count) {
  const thimble::drivers::PanelBus bus = bus_of(panel);
  return bus.command(bus.context, bytes, count);
}
bool panel_data(int panel, const std::uint8_t* bytes, std::size_t count) {
  const thimble::drivers::PanelBus bus = bus_of(panel);
  return bus.data(bus.context, bytes, count);
}
void panel_wait(std::uint32_t milliseconds) {
  for (int panel = 0; panel < 2; ++panel) {
    const thimble::drivers::PanelBus bus = bus_of(panel);
    bus.wait_ms(bus.context, milliseconds);
  }
}

void panel_done() {
  if (!oled.fault().empty() || !lcd.fault().empty()) {
    std::fprintf(stderr, "panels: %s%s\n", oled.fault().c_str(), lcd.fault().c_str());
    std::exit(3);
  }
  if (std::FILE* file = std::fopen("ssd1306.pbm", "wb")) {
    std::fprintf(file, "P4\n128 64\n");
    const std::vector<bool> lit = oled.picture();
    for (std::size_t i = 0; i < lit.size(); i += 8) {
      unsigned byte = 0;
      for (std::size_t bit = 0; bit < 8; ++bit) {
        byte = byte << 1 | (lit[i + bit] ? 0U : 1U);  // 1 is black in a PBM
      }
      std::fputc(static_cast<int>(byte), file);
    }
    std::fclose(file);
  }
  if (std::FILE* file = std::fopen("st7789.ppm", "wb")) {
    // The module is turned by a quarter, so whoever looks at it turns it back.
    std::fprintf(file, "P6\n240 240\n255\n");
    const std::vector<std::uint8_t> seen = lcd.picture();
    for (std::size_t y = 0; y < 240; ++y) {
      for (std::size_t x = 0; x < 240; ++x) {
        std::fwrite(seen.data() + 3 * (x * 240 + (239 - y)), 1, 3, file);
      }
    }
    std::fclose(file);
  }
}
