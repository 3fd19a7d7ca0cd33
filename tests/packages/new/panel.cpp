// What a panel shows that got what wires.h tells: panel ssd1306|st7789|st7735 <UART >PICTURE (.pbm, .ppm). Status 1 where the
// controller would not take it.
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "support/panel_model.h"

namespace {

using namespace thimble::tests;

// Feeds the model line by line. `send` gets what is no wait.
template <class Model, class Send>
void feed(Model* model, const Send& send) {
  char what = 0;
  std::string hex;
  while (std::cin >> what >> hex) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
      bytes.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
    }
    if (what == 'w') {
      model->wait(bytes[0]);
    } else {
      send(what, bytes);
    }
  }
}

int shown(const PanelModel& model, const std::string& head, const std::vector<std::uint8_t>& picture) {
  if (!model.fault().empty()) {
    std::fprintf(stderr, "panel: %s\n", model.fault().c_str());
    return 1;
  }
  std::fputs(head.c_str(), stdout);
  std::fwrite(picture.data(), 1, picture.size(), stdout);
  return 0;
}

int show_page() {
  PageModel model(PageModel::Kind::kSsd1306, 128, 64, 0);
  feed(&model, [&](char, const std::vector<std::uint8_t>& bytes) { model.i2c(bytes.data(), bytes.size()); });
  const std::vector<bool> lit = model.picture();
  std::vector<std::uint8_t> bytes(lit.size() / 8);
  for (std::size_t i = 0; i < lit.size(); ++i) {  // 1 is black in a PBM
    bytes[i / 8] = static_cast<std::uint8_t>(bytes[i / 8] | (lit[i] ? 0U : 0x80U >> i % 8));
  }
  return shown(model, "P4\n128 64\n", bytes);
}

// Turned by a quarter, so whoever looks at it turns it back.
int show_color(ColorModel::Kind kind, const ColorModel::Glass& glass) {
  ColorModel model(kind, glass);
  feed(&model, [&](char what, const std::vector<std::uint8_t>& bytes) {
    const thimble::drivers::PanelBus bus = model.spi();
    (what == 'c' ? bus.command : bus.data)(bus.context, bytes.data(), bytes.size());
  });
  const std::vector<std::uint8_t> seen = model.picture();
  const auto width = static_cast<std::size_t>(glass.height);
  const auto height = static_cast<std::size_t>(glass.width);
  std::vector<std::uint8_t> picture;
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t at = 3 * (x * height + (height - 1 - y));
      picture.insert(picture.end(), {seen[at], seen[at + 1], seen[at + 2]});
    }
  }
  return shown(model, "P6\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n", picture);
}

}  // namespace

int main(int count, char** arguments) {
  const std::string kind = count > 1 ? arguments[1] : "";
  if (kind == "ssd1306") {
    return show_page();
  }
  return kind == "st7789"
             ? show_color(ColorModel::Kind::kSt7789, {240, 240, 240, 320, 0, 0, false, false, false, true})
             : show_color(ColorModel::Kind::kSt7735, {128, 160, 128, 160, 0, 0, true, true, false, false});
}
