/// The kernels as SPIR-V, compiled into the program.
#pragma once

#include <cstddef>
#include <cstdint>

namespace thimble::gpu {

struct Kernel {
  const std::uint32_t* code;
  std::size_t words;
};

/// For lit pictures or others; in pairs of words where one does not do.
Kernel kernel_of(bool lit, bool pairs);

}  // namespace thimble::gpu
