// Lit pictures on the target: an application of its own, because they take more code and stack than the other
// cases leave on the smallest chip.
#include "apps/apps.h"
#include "apps/cases.h"
#include "portable/result_crc.h"

namespace thimble::apps {

int lit() {
  return run_cases("lit", portable::kLitGroups, portable::kLitCrc32, portable::kLitCrc32,
                   portable::kLitArenaBytes);
}

}  // namespace thimble::apps
