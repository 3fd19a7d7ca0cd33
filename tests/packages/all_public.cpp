// Names of every room, from the one header of the pair, which may be included twice.
#include "thimble/thimble.h"

// clang-format off
#include "thimble/thimble.h"
#include "thimble/thimble.h"
// clang-format on
using namespace thimble;

static_assert(sizeof(BrickMap) > 0 && sizeof(SharedTree) > 0 && sizeof(DenseGrid) > 0 &&
              sizeof(BakedScene) > 0);
static_assert(sizeof(LitScene) > 0 && sizeof(Water) > 0 && sizeof(ParticleWorld) > 0 && sizeof(BitField) > 0);
