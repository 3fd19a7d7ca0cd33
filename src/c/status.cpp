#include "thimble/base/status.h"

#include "thimble/thimble_c.h"

namespace thimble {

static_assert(THIMBLE_OK == static_cast<int>(Status::kOk) &&
              THIMBLE_OUT_OF_MEMORY == static_cast<int>(Status::kOutOfMemory) &&
              THIMBLE_OUT_OF_RANGE == static_cast<int>(Status::kOutOfRange) &&
              THIMBLE_BAD_ARGUMENT == static_cast<int>(Status::kBadArgument) &&
              THIMBLE_TOO_FINE == static_cast<int>(Status::kTooFine) &&
              THIMBLE_DAMAGED == static_cast<int>(Status::kDamaged) &&
              THIMBLE_STEP_LIMIT == static_cast<int>(Status::kStepLimit));
static_assert(*status_text(static_cast<Status>(THIMBLE_STEP_LIMIT + 1)) ==
                  *status_text(static_cast<Status>(255)),
              "enum thimble_status lacks a status");

}  // namespace thimble

extern "C" const char* thimble_status_text(int32_t status) {
  using namespace thimble;
  return status_text(static_cast<Status>(status >= 0 && status < 255 ? status : 255));
}
