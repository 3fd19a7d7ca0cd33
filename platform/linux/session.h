/// One run of an application on a Linux framebuffer: what port.h's functions need, set up by main().
#pragma once

#include <stdint.h>

#include "linux/framebuffer.h"
#include "linux/keys.h"
#include "port.h"

namespace thimble::linux_port {

struct Session {
  Framebuffer* framebuffer = nullptr;
  Keys* keys = nullptr;
  Placement placement;
  port::Facts facts{};
  Bytes arena;
  ConstBytes scene;
  uint32_t most_frames = 0;  ///< 0: until somebody ends it
};

/// Runs the application on a painted stack of facts.stack_bytes with a guard below it, and returns its exit
/// status. `fault` is a sentence when there is no memory for that.
int run(const Session& session, int (*application)(), const char** fault);

}  // namespace thimble::linux_port
