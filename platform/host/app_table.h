/// @file app_table.h
/// The applications that the simulator can run, by name.
#ifndef THIMBLE_PLATFORM_HOST_APP_TABLE_H
#define THIMBLE_PLATFORM_HOST_APP_TABLE_H

#include "thimble/span.h"

namespace thimble::host {

struct Application {
  const char* name;
  int (*run)();
  bool wants_scene;  ///< whether it draws the scene in flash
  bool is_to_watch;  ///< whether it is made to be watched, rather than for what it writes over the UART
};

/// All of them; may be empty.
Span<const Application> applications();

}  // namespace thimble::host

#endif
