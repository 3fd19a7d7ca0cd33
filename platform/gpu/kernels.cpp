#include "gpu/kernels.h"

#include <octree_pairs_spv.h>
#include <octree_spv.h>

#include <iterator>

namespace thimble::gpu {

Kernel kernel_of(bool pairs) {
  return pairs ? Kernel{octree_pairs_spv, std::size(octree_pairs_spv)}
               : Kernel{octree_spv, std::size(octree_spv)};
}

}  // namespace thimble::gpu
