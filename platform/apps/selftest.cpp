// The core's own test cases on the target: the same list and the same numbers on every board and on the host.
#include "apps/apps.h"
#include "apps/cases.h"
#include "portable/result_crc.h"

namespace thimble::apps {

int selftest() {
  return run_cases("selftest", portable::kCoreGroups, portable::kCoreCrc32, portable::kCoreCrc32);
}

}  // namespace thimble::apps
