/// What a terminal sends for keys and mouse, taken apart.
///
/// It knows the sequences of xterm and what follows it: arrows and editing keys in both forms (CSI and SS3),
/// with and without modifiers, the mouse in SGR form (mode 1006), UTF-8. A sequence that it does not know is
/// passed over. It does no input of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/screen.h"

namespace thimble::host {

class TerminalInput {
 public:
  /// Takes bytes in any portions and appends what they mean. A mouse event has the cell, counted from 0, in
  /// `x_px` and `y_px`. A terminal does not tell when a key is let go, so there is no kKeyUp.
  void take(std::string_view bytes, std::vector<Event>* events);
  /// Whether the end of a sequence is missing; an escape alone may be one or the key.
  bool waits() const { return !pending_.empty(); }
  /// Nothing more came within the time that a sequence takes: what is pending was the escape key, or noise.
  void settle(std::vector<Event>* events);

 private:
  std::size_t take_one(std::string_view bytes, std::vector<Event>* events);
  std::size_t take_escape(std::string_view bytes, std::vector<Event>* events);
  void take_csi(std::string_view parameters, char final, std::vector<Event>* events);
  void take_mouse(std::string_view parameters, bool is_release, std::vector<Event>* events);

  std::string pending_;
  std::uint8_t buttons_ = 0;
};

}  // namespace thimble::host
