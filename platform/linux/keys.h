/// Keys from the kernel's input devices (evdev, /dev/input/event*), and letters from standard input.
#pragma once

#include <stdint.h>

#include <deque>
#include <string>
#include <vector>

namespace thimble::linux_port {

/// What is held down, and what was typed.
class Keys {
 public:
  Keys() = default;
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;
  ~Keys();

  /// Opens every device in `folder` that has keys; those that may not be read are passed over. Returns how
  /// many were opened. Looked at again by `poll` when a device goes away, not when one comes.
  int open_all(const std::string& folder);

  /// Takes in all that has come since, from the devices and from standard input; does not wait.
  void poll();

  /// port::Button bits of the arrow keys, return and space that are down.
  uint32_t buttons() const { return buttons_; }
  /// The next letter that was typed, or -1.
  int read();

 private:
  void take(uint16_t code, int32_t value);

  std::vector<int> devices_;
  std::deque<char> typed_;
  uint32_t buttons_ = 0;
  bool input_open_ = true;
};

}  // namespace thimble::linux_port
