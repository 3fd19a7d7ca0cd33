// SSD1306 (Rev 1.1, section 9), SH1106 (V2.3, "Commands"), ST7567 ("Instruction Table").
#include <algorithm>

#include "support/panel_model.h"

namespace thimble::tests {
namespace {

std::string hex(unsigned byte) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  return {kDigits[byte >> 4 & 15U], kDigits[byte & 15U]};
}

}  // namespace

PageModel::PageModel(Kind kind, int width, int height, int first_column)
    : kind_(kind),
      width_(width),
      height_(height),
      first_column_(first_column),
      columns_(kind == Kind::kSsd1306 ? 128 : 132),
      memory_(static_cast<std::size_t>(columns_) * 8, 0xA5),
      written_(memory_.size(), false) {}

drivers::PanelBus PanelModel::spi() {
  drivers::PanelBus bus;
  bus.context = static_cast<PanelModel*>(this);
  bus.command = [](void* self, const std::uint8_t* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      static_cast<PanelModel*>(self)->command(bytes[i]);
    }
    return true;
  };
  bus.data = [](void* self, const std::uint8_t* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      static_cast<PanelModel*>(self)->data(bytes[i]);
    }
    return true;
  };
  bus.wait_ms = [](void* self, std::uint32_t milliseconds) {
    static_cast<PanelModel*>(self)->wait(milliseconds);
  };
  return bus;
}

bool PageModel::i2c(const std::uint8_t* bytes, std::size_t count) {
  longest_ = std::max(longest_, count);
  if (count < 2 || (bytes[0] != 0x00 && bytes[0] != 0x40)) {
    complain("a transfer without a control byte");
    return false;
  }
  for (std::size_t i = 1; i < count; ++i) {
    bytes[0] == 0x00 ? command(bytes[i]) : data(bytes[i]);
  }
  return true;
}

// Bytes that follow a command; nothing where the controller knows no such command.
std::optional<std::size_t> PageModel::parameters_of(std::uint8_t byte) {
  const bool st7567 = kind_ == Kind::kSt7567;
  const bool ssd1306 = kind_ == Kind::kSsd1306;
  if (byte == 0x81) {
    return 1;
  }
  if (!st7567 &&
      (byte == 0xA8 || byte == 0xD3 || byte == 0xD5 || byte == 0xD9 || byte == 0xDA || byte == 0xDB)) {
    return 1;
  }
  if (ssd1306 && (byte == 0x20 || byte == 0x8D || byte == 0xAD)) {
    return 1;
  }
  if (ssd1306 && (byte == 0x21 || byte == 0x22)) {
    return 2;
  }
  if (kind_ == Kind::kSh1106 && byte == 0xAD) {
    return 1;
  }
  const bool is_known =
      byte <= 0x1F || (byte >= 0x40 && byte <= 0x7F) || byte == 0xA0 || byte == 0xA1 ||
      (byte >= 0xA4 && byte <= 0xA7) || byte == 0xAE || byte == 0xAF || (byte >= 0xB0 && byte <= 0xB7) ||
      byte == 0xC0 || byte == 0xC8 || byte == 0xE3 || (ssd1306 && byte == 0x2E) ||
      (kind_ == Kind::kSh1106 && byte >= 0x30 && byte <= 0x33) ||
      (st7567 && ((byte >= 0x20 && byte <= 0x2F) || byte == 0xA2 || byte == 0xA3 || byte == 0xE2));
  if (!is_known) {
    complain("unknown command " + hex(byte));
    return std::nullopt;
  }
  return 0;
}

void PageModel::command(std::uint8_t byte) {
  ++bytes_sent_;
  if (pending_.empty()) {
    const std::optional<std::size_t> parameters = parameters_of(byte);
    if (!parameters) {
      return;
    }
    wanted_ = 1 + *parameters;
  }
  pending_.push_back(byte);
  if (pending_.size() == wanted_) {
    finish(pending_);
    pending_.clear();
  }
}

void PageModel::turn_on() {
  if (is_on_) {
    return;
  }
  if (kind_ == Kind::kSt7567) {
    if (power_ != 7) {
      complain("on without booster, regulator and follower");
    }
    expect_since(power_since_, 10, "on, the follower having been started,");
  } else {
    if (!has_pump_) {
      complain("on without the pump");
    }
    if (kind_ == Kind::kSsd1306 && may_scroll_) {
      complain("on while it may scroll");
    }
    if (kind_ == Kind::kSsd1306 && width_ == 72 && !has_reference_) {
      complain("on without a reference for its current");
    }
    if (multiplex_ != height_ || row_pins_ != (height_ > 32 ? 0x12 : 0x02)) {
      complain("on with the rows of another panel");
    }
  }
  if (contrast_ < 0) {
    complain("on without a contrast");
  }
  is_on_ = true;
  // Whatever is shown was written.
  for (int page = 0; page < height_ / 8; ++page) {
    for (int x = 0; x < width_; ++x) {
      const int first =
          segments_backward_ == (kind_ != Kind::kSt7567) ? first_column_ : columns_ - width_ - first_column_;
      if (!written_[static_cast<std::size_t>(page * columns_ + first + x)]) {
        complain("on with a memory that was never written");
        return;
      }
    }
  }
}

void PageModel::finish(const std::vector<std::uint8_t>& command) {
  const unsigned code = command[0];
  const bool st7567 = kind_ == Kind::kSt7567;
  if (code == 0xAE || code == 0xAF) {
    code == 0xAF ? turn_on() : static_cast<void>(is_on_ = false);
  } else if (code == 0xA0 || code == 0xA1) {
    segments_backward_ = code == 0xA1;
  } else if (code == 0xC0 || code == 0xC8) {
    rows_backward_ = code == 0xC8;
  } else if (code == 0xA4 || code == 0xA5) {
    all_on_ = code == 0xA5;
  } else if (code == 0xA6 || code == 0xA7) {
    inverse_ = code == 0xA7;
  } else if (code == 0x81) {
    contrast_ = command[1];
    if (st7567 && contrast_ > 63) {
      complain("a contrast beyond 63");
    }
  } else if (code >= 0xB0 && code <= 0xB7) {
    page_ = static_cast<int>(code & 7U);
  } else if (code == 0xA8) {
    multiplex_ = command[1] + 1;
  } else if (code == 0xDA) {
    row_pins_ = command[1];
  } else if (code == 0x8D) {
    has_pump_ = command[1] == 0x14;
  } else if (code == 0x2E && !st7567) {
    may_scroll_ = false;
  } else if (code == 0xAD && kind_ == Kind::kSsd1306) {
    has_reference_ = (command[1] & 0x10) != 0;
  } else if (code == 0xAD) {
    if (is_on_) {
      complain("the converter switched while on");
    }
    has_pump_ = command[1] == 0x8B;
  } else if (code == 0x20 && !st7567) {
    horizontal_ = command[1] == 0;
  } else if (code == 0x21 || code == 0x22) {
    const int most = code == 0x21 ? 127 : 7;
    const std::size_t at = code == 0x21 ? 0 : 2;
    if (!horizontal_ && code == 0x21 && kind_ == Kind::kSsd1306) {
      complain("a window without horizontal addressing");
    }
    if (!st7567) {
      window_[at] = command[1];
      window_[at + 1] = command[2];
      if (command[1] > command[2] || command[2] > most) {
        complain("a window beyond the memory");
      }
      column_ = window_[0];
      page_ = window_[2];
    }
  } else if (st7567 && code >= 0x28 && code <= 0x2F) {
    const int power = static_cast<int>(code & 7U);
    if ((power & ~power_) == 0 || (power_ != 0 && now_ms_ - power_since_ < 10)) {
      complain("the supplies were not started one after another");
    }
    power_ = power;
    power_since_ = now_ms_;
  } else if (st7567 && code == 0xE2) {
    power_ = 0;
    is_on_ = false;
  } else if (code <= 0x0F) {
    column_ = (column_ & 0xF0) | static_cast<int>(code);
  } else if (code <= 0x1F) {
    column_ = (column_ & 0x0F) | static_cast<int>(code & 15U) << 4;
  }
}

void PageModel::data(std::uint8_t byte) {
  ++bytes_sent_;
  if (!pending_.empty()) {
    complain("data within a command");
  }
  if (column_ >= columns_ || page_ > 7) {
    complain("data beyond the memory");
    return;
  }
  const auto at = static_cast<std::size_t>(page_ * columns_ + column_);
  memory_[at] = byte;
  written_[at] = true;
  ++column_;
  if (kind_ == Kind::kSsd1306 && horizontal_ && column_ > window_[1]) {
    column_ = window_[0];
    page_ = page_ < window_[3] ? page_ + 1 : window_[2];
  }
}

std::vector<bool> PageModel::picture() const {
  std::vector<bool> lit(static_cast<std::size_t>(width_ * height_));
  // Modules are mounted so that they stand upright with their segments the one way (SSD1306, SH1106: backward) and the
  // rows backward.
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const bool upright = segments_backward_ == (kind_ != Kind::kSt7567);
      const int column = upright ? first_column_ + x : columns_ - 1 - first_column_ - x;
      const int row = rows_backward_ ? y : height_ - 1 - y;
      const bool bit = (memory_[static_cast<std::size_t>(row / 8 * columns_ + column)] >> row % 8 & 1) != 0;
      lit[static_cast<std::size_t>(y * width_ + x)] = is_on_ && (all_on_ || bit != inverse_);
    }
  }
  return lit;
}

}  // namespace thimble::tests
