// Frames by bricks on the target: an application of its own, because they want more stack than the other cases.
#include "apps/apps.h"
#include "apps/cases.h"
#include "portable/result_crc.h"

namespace thimble::apps {

int bricks() {
  return run_cases("bricks", portable::kBrickGroups, portable::kBrickCrc32, portable::kBrickCrc32,
                   portable::kLitArenaBytes);
}

}  // namespace thimble::apps
