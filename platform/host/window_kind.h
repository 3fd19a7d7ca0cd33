/// @file window_kind.h
/// Whether this build has windows (-DTHIMBLE_WINDOW).
#ifndef THIMBLE_PLATFORM_HOST_WINDOW_KIND_H
#define THIMBLE_PLATFORM_HOST_WINDOW_KIND_H

namespace thimble::host {

/// The window system that windows are of; null where the build has none, and open_window always throws.
const char* window_kind();

}  // namespace thimble::host

#endif
