#include "thimble/base/status.h"

#include "thimble/thimble_c.h"

namespace thimble::c_face {
namespace {

// A line a status; the compiler names one that lacks.
constexpr int32_t c_status(Status status) {
  switch (status) {
    case Status::kOk:
      return THIMBLE_OK;
    case Status::kOutOfMemory:
      return THIMBLE_OUT_OF_MEMORY;
    case Status::kOutOfRange:
      return THIMBLE_OUT_OF_RANGE;
    case Status::kBadArgument:
      return THIMBLE_BAD_ARGUMENT;
    case Status::kTooFine:
      return THIMBLE_TOO_FINE;
    case Status::kDamaged:
      return THIMBLE_DAMAGED;
    case Status::kStepLimit:
      return THIMBLE_STEP_LIMIT;
  }
  return -1;
}
constexpr bool statuses_are_equal() {
  for (int32_t status = 0; status <= 255; ++status) {
    const int32_t named = c_status(static_cast<Status>(status));
    if (named != -1 && named != status) {
      return false;
    }
  }
  return true;
}
static_assert(statuses_are_equal(), "enum thimble_status has another number than Status");

}  // namespace
}  // namespace thimble::c_face

extern "C" const char* thimble_status_text(int32_t status) {
  using namespace thimble;
  return status_text(static_cast<Status>(status >= 0 && status < 255 ? status : 255));
}
