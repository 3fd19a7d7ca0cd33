/// @file kernels.h
/// The kernels as SPIR-V, compiled into the program.
#ifndef THIMBLE_PLATFORM_GPU_KERNELS_H
#define THIMBLE_PLATFORM_GPU_KERNELS_H

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

#endif
