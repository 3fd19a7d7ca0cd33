#include "host/window_kind.h"

namespace thimble::host {

const char* window_kind() {
  return "X11";
}

}  // namespace thimble::host
