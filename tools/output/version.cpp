#include "output/version.h"

#include "thimble_version.h"

namespace thimble::tools {

const char* const kVersionNumber = THIMBLE_VERSION;
const char* const kVersionCommit = THIMBLE_COMMIT;
const char* const kVersionDate = THIMBLE_DATE;

}  // namespace thimble::tools
