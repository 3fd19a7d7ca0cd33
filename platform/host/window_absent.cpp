// In place of window_x11.cpp in a build without libX11.
#include "host/screen.h"

namespace thimble::host {

const char* window_kind() {
  return nullptr;
}

std::unique_ptr<Screen> open_window(const ScreenOptions& /*options*/) {
  throw ScreenError("this build has no windows (-DTHIMBLE_WINDOW=OFF)");
}

}  // namespace thimble::host
