/// @file app_table.h
/// The applications that a host can run, by name.
#ifndef THIMBLE_PLATFORM_APPS_APP_TABLE_H
#define THIMBLE_PLATFORM_APPS_APP_TABLE_H

#include "thimble/span.h"

namespace thimble::apps {

struct Application {
  const char* name;
  int (*run)();
  bool wants_scene;  ///< whether it draws the scene in flash
  bool is_to_watch;  ///< whether it is made to be watched, rather than for what it writes over the UART
};

/// All of them; may be empty.
Span<const Application> applications();

}  // namespace thimble::apps

#endif
