// kernel/parameters.inc as C++.
#pragma once

#include <stdint.h>

namespace thimble::gpu::kernel {

using uint = uint32_t;
#include "parameters.inc"

}  // namespace thimble::gpu::kernel
