#include "gpu/kernels.h"

#include <cells_pairs_spv.h>
#include <cells_spv.h>
#include <octree_pairs_spv.h>
#include <octree_spv.h>

#include <iterator>

namespace thimble::gpu {

Kernel kernel_of(bool is_octree, bool pairs) {
  if (is_octree) {
    return pairs ? Kernel{octree_pairs_spv, std::size(octree_pairs_spv)}
                 : Kernel{octree_spv, std::size(octree_spv)};
  }
  return pairs ? Kernel{cells_pairs_spv, std::size(cells_pairs_spv)}
               : Kernel{cells_spv, std::size(cells_spv)};
}

}  // namespace thimble::gpu
