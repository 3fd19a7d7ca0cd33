// Frames by bricks on the target: an application of its own, because they want more stack than the other cases.
#include "apps/apps.h"
#include "apps/cases.h"
#include "portable/result_crc.h"

namespace thimble::apps {

int bricks() {
#ifdef THIMBLE_DEEP_WORLDS
  constexpr uint32_t kAll = portable::kBrickCrc32;
#else
  constexpr uint32_t kAll = portable::kCommonBrickCrc32;
#endif
  return run_cases("bricks", portable::kBrickGroups, kAll, portable::kCommonBrickCrc32,
                   portable::kLitArenaBytes);
}

}  // namespace thimble::apps
