// Baked scenes, and the golden frames from compact trees in flash and, where the RAM holds them, from octrees
// and dense grids that are built here.
#include "apps/apps.h"
#include "apps/cases.h"
#include "portable/result_crc.h"

namespace thimble::apps {

int golden() {
  return run_cases("golden", portable::kGoldenGroups, portable::kGoldenCrc32, portable::kCommonGoldenCrc32);
}

}  // namespace thimble::apps
