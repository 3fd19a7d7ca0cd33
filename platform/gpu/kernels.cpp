#include "gpu/kernels.h"

#include <lit_pairs_spv.h>
#include <lit_spv.h>
#include <octree_pairs_spv.h>
#include <octree_spv.h>

#include <iterator>

namespace thimble::gpu {

Kernel kernel_of(bool lit, bool pairs) {
  if (lit) {
    return pairs ? Kernel{lit_pairs_spv, std::size(lit_pairs_spv)} : Kernel{lit_spv, std::size(lit_spv)};
  }
  return pairs ? Kernel{octree_pairs_spv, std::size(octree_pairs_spv)}
               : Kernel{octree_spv, std::size(octree_spv)};
}

}  // namespace thimble::gpu
