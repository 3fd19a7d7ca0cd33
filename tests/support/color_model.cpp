// ST7735 (V0.2), ST7789 (V1.0), ILI9341 (V1.11): commands, address control, times.
#include "support/panel_model.h"

namespace thimble::tests {
namespace {

constexpr int kMirrorRows = 0x80;
constexpr int kMirrorColumns = 0x40;
constexpr int kExchange = 0x20;
constexpr int kBgr = 0x08;
constexpr std::size_t kAny = 99;

}  // namespace

ColorModel::ColorModel(Kind kind, const Glass& glass)
    : kind_(kind),
      glass_(glass),
      memory_(static_cast<std::size_t>(3 * glass.memory_width * glass.memory_height), 0xA5),
      written_(static_cast<std::size_t>(glass.memory_width * glass.memory_height), false) {}

std::size_t ColorModel::parameters_of(std::uint8_t byte) {
  struct Commands {
    Kind kind;
    std::string_view codes;
    std::size_t parameters;
  };
  constexpr Commands kCommands[] = {{Kind::kSt7735, "\x01\x10\x11\x13\x20\x21\x28\x29", 0},
                                    {Kind::kSt7735, "\x36\x3A", 1},
                                    {Kind::kSt7735, "\x2A\x2B", 4},
                                    {Kind::kSt7735, "\x2C", kAny},
                                    {Kind::kIli9341, "\xC0\xC1\xC7", 1},
                                    {Kind::kIli9341, "\xC5\xB1", 2},
                                    {Kind::kIli9341, "\xB6", 3}};
  for (const Commands& some : kCommands) {  // the first four rows are those that all have
    if ((some.kind != Kind::kIli9341 || kind_ == Kind::kIli9341) &&
        some.codes.find(static_cast<char>(byte)) != std::string_view::npos) {
      return some.parameters;
    }
  }
  if (kind_ == Kind::kSt7735 && byte == 0xB1) {
    return 3;
  }
  complain("unknown command " + std::to_string(byte));
  return 0;
}

void ColorModel::leave_write() {
  if (writes_ && !bytes_.empty() && pixel_bits_ == 16) {
    complain("a write that ends within a pixel");
  }
  if (!writes_ && bytes_.size() < wanted_) {
    complain("a command that lacks data");
  }
  writes_ = false;
  bytes_.clear();
}

void ColorModel::command(std::uint8_t byte) {
  ++bytes_sent_;
  leave_write();
  if (was_reset_) {
    expect_since(reset_at_, 5, "a command, the reset having come,");
  }
  code_ = byte;
  wanted_ = parameters_of(byte);
  if (byte == 0x01) {
    was_reset_ = true;
    reset_at_ = now_ms_;
    sleeps_ = true;
    is_on_ = false;
    inverse_ = false;
  } else if (!was_reset_) {
    complain("a command before the reset");
  } else if (byte == 0x10) {
    sleeps_ = true;
    woke_at_ = now_ms_;
  } else if (byte == 0x11) {
    expect_since(reset_at_, 120, "out of sleep, the reset having come,");
    if (woke_at_ != 0) {
      expect_since(woke_at_, 120, "out of sleep, having gone there,");
    }
    sleeps_ = false;
    woke_at_ = now_ms_;
  } else if (byte == 0x20 || byte == 0x21) {
    inverse_ = byte == 0x21;
  } else if (byte == 0x28) {
    is_on_ = false;
  } else if (byte == 0x29) {
    if (sleeps_) {
      complain("on while asleep");
    }
    expect_since(woke_at_, 120, "on, out of sleep");
    is_on_ = true;
    for (int y = 0; y < glass_.height; ++y) {
      for (int x = 0; x < glass_.width; ++x) {
        if (!written_[static_cast<std::size_t>((glass_.first_row + y) * glass_.memory_width +
                                               glass_.first_column + x)]) {
          complain("on with a memory that was never written");
          return;
        }
      }
    }
  } else if (byte == 0x2C) {
    writes_ = true;
    wanted_ = 0;
    column_ = first_column_;
    row_ = first_row_;
    pixels_left_ = static_cast<std::uint64_t>(last_column_ - first_column_ + 1) *
                   static_cast<std::uint64_t>(last_row_ - first_row_ + 1);
    if (pixel_bits_ == 0) {
      complain("pixels before their format");
    }
  }
}

void ColorModel::data(std::uint8_t byte) {
  ++bytes_sent_;
  bytes_.push_back(byte);
  if (!writes_) {
    parameter(byte);
    return;
  }
  if (pixel_bits_ == 16 && bytes_.size() == 2) {
    const unsigned packed = static_cast<unsigned>(bytes_[0]) << 8 | bytes_[1];
    const unsigned r = packed >> 11;
    const unsigned g = packed >> 5 & 63U;
    const unsigned b = packed & 31U;
    pixel(r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2);
    bytes_.clear();
  } else if (pixel_bits_ == 12 && bytes_.size() == 3) {
    pixel((bytes_[0] >> 4) * 17U, (bytes_[0] & 15U) * 17U, (bytes_[1] >> 4) * 17U);
    pixel((bytes_[1] & 15U) * 17U, (bytes_[2] >> 4) * 17U, (bytes_[2] & 15U) * 17U);
    bytes_.clear();
  }
}

void ColorModel::parameter(std::uint8_t byte) {
  if (bytes_.size() > wanted_) {
    complain("more data than command " + std::to_string(code_) + " takes");
    return;
  }
  if (bytes_.size() < wanted_) {
    return;
  }
  if (code_ == 0x36) {
    control_ = byte;
  } else if (code_ == 0x3A) {
    const int code = byte & 7;
    pixel_bits_ = code == 5 ? 16 : code == 3 && kind_ != Kind::kIli9341 ? 12 : 0;
    if (pixel_bits_ == 0 || (kind_ != Kind::kSt7735 && byte >> 4 != 5)) {
      complain("a pixel format that it does not have");
    }
  } else if (code_ == 0x2A || code_ == 0x2B) {
    const int first = bytes_[0] << 8 | bytes_[1];
    const int last = bytes_[2] << 8 | bytes_[3];
    const bool columns = (code_ == 0x2A) != ((control_ & kExchange) != 0);
    if (first > last || last >= (columns ? glass_.memory_width : glass_.memory_height)) {
      complain("a window beyond the memory");
    }
    (code_ == 0x2A ? first_column_ : first_row_) = first;
    (code_ == 0x2A ? last_column_ : last_row_) = last;
  }
}

void ColorModel::pixel(unsigned r, unsigned g, unsigned b) {
  if (pixels_left_ == 0) {
    complain("more pixels than the window has");
    return;
  }
  --pixels_left_;
  int x = (control_ & kExchange) != 0 ? row_ : column_;
  int y = (control_ & kExchange) != 0 ? column_ : row_;
  x = (control_ & kMirrorColumns) != 0 ? glass_.memory_width - 1 - x : x;
  y = (control_ & kMirrorRows) != 0 ? glass_.memory_height - 1 - y : y;
  if (x < glass_.first_column || x >= glass_.first_column + glass_.width || y < glass_.first_row ||
      y >= glass_.first_row + glass_.height) {
    complain("a pixel beside the glass");
  } else {
    const auto at = static_cast<std::size_t>(y * glass_.memory_width + x);
    const bool swapped = ((control_ & kBgr) != 0) != glass_.is_bgr;
    memory_[3 * at] = static_cast<std::uint8_t>(swapped ? b : r);
    memory_[3 * at + 1] = static_cast<std::uint8_t>(g);
    memory_[3 * at + 2] = static_cast<std::uint8_t>(swapped ? r : b);
    written_[at] = true;
  }
  if (++column_ > last_column_) {
    column_ = first_column_;
    ++row_;
  }
}

std::vector<std::uint8_t> ColorModel::picture() const {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < glass_.height; ++y) {
    for (int x = 0; x < glass_.width; ++x) {
      const int column = glass_.first_column + (glass_.mirrors_x ? glass_.width - 1 - x : x);
      const int row = glass_.first_row + (glass_.mirrors_y ? glass_.height - 1 - y : y);
      const auto at = static_cast<std::size_t>(3 * (row * glass_.memory_width + column));
      for (std::size_t c = 0; c < 3; ++c) {
        const bool flips = inverse_ != glass_.is_inverse;
        const auto value = static_cast<std::uint8_t>(flips ? 255 - memory_[at + c] : memory_[at + c]);
        rgb.push_back(is_on() ? value : std::uint8_t{0});
      }
    }
  }
  return rgb;
}

}  // namespace thimble::tests
