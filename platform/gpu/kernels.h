/// The kernels as SPIR-V, compiled into the program.
#pragma once

#include <cstddef>
#include <cstdint>

namespace thimble::gpu {

struct Kernel {
  const std::uint32_t* code;
  std::size_t words;
};

/// In pairs of words where one does not do.
Kernel kernel_of(bool pairs);

}  // namespace thimble::gpu
