/// Buttons and typed bytes at given frames, as text, so that a run can be repeated.
///
///     # a comment
///     10: down left        from frame 10 on the left button is held
///     25: up left          from frame 25 on it is not
///     30: down up select   several at once
///     40: type p\n         the bytes "p" and a line feed come over the UART
///
/// Frames count from 0; a line takes effect before its frame is drawn. Lines of one frame are taken in their
/// order. Buttons: up, down, left, right, select. In typed text \n, \r, \t, \\ and \xHH are bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace thimble::tools {

class KeyScript {
 public:
  struct Step {
    std::uint32_t frame = 0;
    std::uint32_t press = 0;    ///< buttons (port.h) that go down
    std::uint32_t release = 0;  ///< and up
    std::string typed;
  };

  KeyScript() = default;
  /// Throws InputError "line L: ...".
  explicit KeyScript(std::string_view text);

  /// The steps up to frame `frame` that were not taken yet.
  std::vector<Step> take(std::uint32_t frame);

 private:
  std::vector<Step> steps_;  // by frame
  std::size_t next_ = 0;
};

}  // namespace thimble::tools
