// Worlds of other shapes on the target: edited ones, maps of bricks, shared trees; and the plane with its balls.
#include "apps/apps.h"
#include "apps/cases.h"
#include "portable/result_crc.h"

namespace thimble::apps {

int worlds() {
  return run_cases("worlds", portable::kWorldGroups, portable::kWorldCrc32, portable::kWorldCrc32);
}

}  // namespace thimble::apps
