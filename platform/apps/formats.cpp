// The pixel formats of panels on the target: an application of its own, because an image has them on demand
// (PANEL_FORMATS=0x3fe0 of build.sh).
#include "apps/apps.h"
#include "apps/cases.h"
#include "portable/result_crc.h"

namespace thimble::apps {

int formats() {
  return run_cases("formats", portable::kPanelGroups, portable::kPanelCrc32, portable::kPanelCrc32);
}

}  // namespace thimble::apps
