/// A screen in a terminal: two pixels a cell, by the upper half block and its ground.
///
/// It needs a terminal that takes xterm's sequences and UTF-8, which nearly all do, also over ssh and in tmux
/// and screen. Colours have 24 bits where $COLORTERM says `truecolor` or `24bit` (or $TERM ends in
/// `-direct`), else they are the nearest of xterm's 256. Only cells that change are sent. The terminal does
/// not tell when a key is let go: it counts as held for a moment after each press or repeat.
#pragma once

#include <memory>

#include "host/screen.h"

namespace thimble::host {

/// Takes over the terminal that the program was started from. Throws ScreenError where there is none, where
/// its $TERM is `dumb`, and while another one is open.
std::unique_ptr<Screen> open_terminal(const ScreenOptions& options);

}  // namespace thimble::host
