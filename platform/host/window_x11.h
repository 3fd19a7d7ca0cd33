/// A screen in a window of the X Window System, by libX11 alone.
///
/// The picture is magnified by a whole number, as far as the window has room; in a window smaller than the
/// picture it is made smaller. It stays sharp: no pixel is mixed with its neighbour when it is magnified.
#pragma once

#include <memory>

#include "host/screen.h"

namespace thimble::host {

/// The window system that windows are of; null where the build has none (-DTHIMBLE_WINDOW=OFF), and open_window always
/// throws.
const char* window_kind();

/// Opens a window on $DISPLAY. Throws ScreenError where there is none, or none with 8 bits a colour.
std::unique_ptr<Screen> open_window(const ScreenOptions& options);

}  // namespace thimble::host
