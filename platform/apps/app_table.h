/// The applications that a host can run, by name.
#pragma once

#include "thimble/base/memory.h"

namespace thimble::apps {

struct Application {
  const char* name;
  int (*run)();
  bool wants_scene;  ///< whether it draws the scene in flash
  bool is_to_watch;  ///< whether it is made to be watched, rather than for what it writes over the UART
  /// Whether it takes pixels by name over the UART: `@X,Y.` for one that is pressed on or moved over with the
  /// first button of a mouse, `!X,Y.` for another button.
  bool takes_pointer = false;
  bool asks_port =
      false;  ///< whether it draws frames that the port may draw in the core's place (port::draw)
  const char* keys =
      "";  ///< what it takes over the UART, lines for a person; w, a, s, d as capitals, since they are buttons
};

/// All of them; may be empty.
Span<const Application> applications();
/// The application of that name, or null.
const Application* find_application(const char* name);

}  // namespace thimble::apps
