#include "output/version.h"

#include "thimble_version.h"

namespace thimble::tools {

const char* version_number() {
  return THIMBLE_VERSION;
}

const char* version_commit() {
  return THIMBLE_COMMIT;
}

const char* version_date() {
  return THIMBLE_DATE;
}

}  // namespace thimble::tools
