// Lit frames by bricks on the target: an application of its own, because they take as much code as all other cases.
#include "apps/apps.h"
#include "apps/cases.h"
#include "portable/result_crc.h"

namespace thimble::apps {

int map_light() {
  return run_cases("map_light", portable::kMapLightGroups, portable::kMapLightCrc32, portable::kMapLightCrc32,
                   portable::kLitArenaBytes);
}

}  // namespace thimble::apps
