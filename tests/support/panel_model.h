/// Models of display controllers: they take what a driver sends, hold its memory, and
/// give back what somebody before the glass sees. What a controller does not know, or forbids, is a fault.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "thimble/drivers/panel.h"

namespace thimble::tests {

/// Counts milliseconds, and holds what went wrong first.
class PanelModel {
 public:
  const std::string& fault() const { return fault_; }
  std::uint64_t bytes_sent() const { return bytes_sent_; }
  void wait(std::uint32_t milliseconds) { now_ms_ += milliseconds; }
  drivers::PanelBus spi();

 protected:
  ~PanelModel() = default;
  virtual void command(std::uint8_t byte) = 0;
  virtual void data(std::uint8_t byte) = 0;
  void complain(const std::string& what) { fault_ = fault_.empty() ? what : fault_; }
  /// Only what follows at least that long after `since` is allowed.
  void expect_since(std::uint64_t since, std::uint64_t least_ms, const std::string& what) {
    if (now_ms_ - since < least_ms) {
      complain(what + " after " + std::to_string(now_ms_ - since) + " ms");
    }
  }

  std::string fault_;
  std::uint64_t now_ms_ = 0;
  std::uint64_t bytes_sent_ = 0;
};

/// SSD1306, SH1106, ST7567. An SSD1306 may be scrolling when it is set up, and its module of 72 x 40 has no resistor
/// that sets the segments' current.
class PageModel final : public PanelModel {
 public:
  enum class Kind : std::uint8_t { kSsd1306, kSh1106, kSt7567 };
  PageModel(Kind kind, int width, int height, int first_column);

  /// One transfer over I2C, control byte and all.
  bool i2c(const std::uint8_t* bytes, std::size_t count);
  /// Lit pixels before the glass, rows from the top; all dark while the display is off.
  std::vector<bool> picture() const;
  bool is_on() const { return is_on_; }
  int contrast() const { return contrast_; }
  std::size_t longest_transfer() const { return longest_; }

 private:
  void command(std::uint8_t byte) override;
  void finish(const std::vector<std::uint8_t>& command);
  void turn_on();
  void data(std::uint8_t byte) override;
  std::optional<std::size_t> parameters_of(std::uint8_t byte);

  Kind kind_;
  int width_;
  int height_;
  int first_column_;
  int columns_;
  std::vector<std::uint8_t> memory_;  // page by page
  std::vector<bool> written_;
  std::vector<std::uint8_t> pending_;
  std::size_t wanted_ = 0;
  std::size_t longest_ = 0;
  int column_ = 0;
  int page_ = 0;
  int window_[4] = {0, 127, 0, 7};  // SSD1306: columns, pages
  bool horizontal_ = false;
  bool segments_backward_ = false;
  bool rows_backward_ = false;
  bool inverse_ = false;
  bool all_on_ = false;
  bool is_on_ = false;
  bool has_pump_ = false;
  bool may_scroll_ = true;
  bool has_reference_ = false;
  int power_ = 0;
  int multiplex_ = 64;
  int row_pins_ = -1;
  int contrast_ = -1;
  std::uint64_t power_since_ = 0;
};

/// ST7735, ST7789, ILI9341.
class ColorModel final : public PanelModel {
 public:
  enum class Kind : std::uint8_t { kSt7735, kSt7789, kIli9341 };
  /// The glass: which rectangle of the memory it shows, and how it sits on it.
  struct Glass {
    int width;
    int height;
    int memory_width;
    int memory_height;
    int first_column;
    int first_row;
    bool mirrors_x;
    bool mirrors_y;
    bool is_bgr;
    bool is_inverse;
  };
  ColorModel(Kind kind, const Glass& glass);

  /// r, g, b of every pixel before the glass, turned by nothing: as the module's pins say. Black while off.
  std::vector<std::uint8_t> picture() const;
  bool is_on() const { return is_on_ && !sleeps_; }

 private:
  void command(std::uint8_t byte) override;
  void data(std::uint8_t byte) override;
  void parameter(std::uint8_t byte);
  void pixel(unsigned r, unsigned g, unsigned b);
  void leave_write();
  std::size_t parameters_of(std::uint8_t byte);

  Kind kind_;
  Glass glass_;
  std::vector<std::uint8_t> memory_;  // r, g, b
  std::vector<bool> written_;
  std::vector<std::uint8_t> bytes_;
  std::uint8_t code_ = 0;
  std::size_t wanted_ = 0;
  bool writes_ = false;
  int pixel_bits_ = 0;
  int control_ = 0;
  int first_column_ = 0;
  int last_column_ = 0;
  int first_row_ = 0;
  int last_row_ = 0;
  int column_ = 0;
  int row_ = 0;
  std::uint64_t pixels_left_ = 0;
  bool sleeps_ = true;
  bool is_on_ = false;
  bool inverse_ = false;
  bool was_reset_ = false;
  std::uint64_t reset_at_ = 0;
  std::uint64_t woke_at_ = 0;
};

/// Calls test(panel) with a new driver of that number among the panels.
template <class... Panels, class Kind, class Test>
void with_panel(Kind kind, const Test& test) {
  int number = 0;
  const auto with = [&](auto panel) {
    if (number++ == static_cast<int>(kind)) {
      test(panel);
    }
  };
  (with(Panels()), ...);
}

}  // namespace thimble::tests
