#include "common/run.h"

namespace thimble {

// An ARM7TDMI has no memory protection, and its exceptions are the boot ROM's.
void raise_fence() {}

}  // namespace thimble
