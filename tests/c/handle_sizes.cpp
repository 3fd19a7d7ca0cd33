// The handles of the C face hold their objects, and have no word to spare where uint64_t is aligned to 8
// bytes. Compiled, not run, for each width (tests/checks/c_header.sh).
#include "src/c/handle.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/scene.h"
#include "thimble/picture/anytime.h"
#include "thimble/plane/particles.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/edited_world.h"
#include "thimble/tree/octree.h"

namespace thimble::c_face {

struct Word {
  char before;
  uint64_t word;
};
template <class Object, class Handle>
constexpr bool tight() {
  return fits<Object, Handle>() &&
         (offsetof(Word, word) < 8 || sizeof(Handle) - sizeof(Held<Object>) < sizeof(uint64_t));
}

static_assert(tight<BakedScene, thimble_scene_t>(), "THIMBLE_WORDS_SCENE");
static_assert(tight<CompactTree, thimble_tree_t>(), "THIMBLE_WORDS_TREE");
static_assert(tight<Octree, thimble_octree_t>(), "THIMBLE_WORDS_OCTREE");
static_assert(tight<Camera, thimble_camera_t>(), "THIMBLE_WORDS_CAMERA");
static_assert(tight<BrickMap, thimble_bricks_t>(), "THIMBLE_WORDS_BRICKS");
static_assert(tight<BakedLighting, thimble_light_t>(), "THIMBLE_WORDS_LIGHT");
static_assert(tight<AnytimeFrame, thimble_frame_t>(), "THIMBLE_WORDS_FRAME");
static_assert(tight<ParticleWorld, thimble_particles_t>(), "THIMBLE_WORDS_PARTICLES");
static_assert(tight<EditedWorld, thimble_world_t>(), "THIMBLE_WORDS_WORLD");
static_assert(tight<EditJournal, thimble_journal_t>(), "THIMBLE_WORDS_JOURNAL");

}  // namespace thimble::c_face
