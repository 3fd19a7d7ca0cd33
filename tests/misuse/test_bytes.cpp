// Each function that says how many bytes a thing takes, against what makes the thing.
#include <doctest/doctest.h>

#include "misuse/odd_values.h"
#include "misuse/odd_worlds.h"
#include "thimble/picture/render.h"
#include "thimble/plane/bitfield.h"
#include "thimble/plane/particles.h"
#include "thimble/thimble_c.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/edited_world.h"
#include "thimble/tree/octree.h"

namespace thimble::tests {
namespace {

static_assert(most_brick_map_bytes(kMinBrickMapLevel - 1) == 0 && most_brick_map_bytes(INT32_MIN) == 0 &&
              most_brick_map_bytes(kMaxBrickMapLevel + 1) == 0 && most_brick_map_bytes(INT32_MAX) == 0);
static_assert(most_brick_map_bytes(kMinBrickMapLevel) != 0 && most_brick_map_bytes(kMaxBrickMapLevel) != 0);

constexpr std::size_t kMost = std::size_t{1} << 20;

// `make` gets as many bytes as were said to be needed, and one less: none are said exactly where it refuses the arguments.
// More than a mebibyte is not tried.
template <class Make>
void hold_to(std::size_t needed, const Make& make) {
  HeapBytes room(std::min(needed, kMost));
  const Status status = make(room.span());
  REQUIRE((status == Status::kOutOfRange) == (needed == 0));
  if (needed != 0) {
    REQUIRE((status == Status::kOk) == (needed <= kMost));
    HeapBytes less(std::min(needed, kMost) - 1);
    REQUIRE(make(less.span()) == Status::kOutOfMemory);
  }
}

}  // namespace

TEST_CASE(
    "bytes: what each function says of any arguments -> 0 exactly where make refuses them, else just "
    "enough") {
  misuse(60, 500, [](OddValues& odd) {
    // One number in a few is odd: where all are, nothing is ever made.
    const auto number = [&odd](std::int32_t low, std::int32_t high) { return odd.any_or(12, low, high); };
    const ParticleConfig config = particles_of(odd, number);
    hold_to(particles_bytes(config), [&config](Bytes bytes) {
      ParticleWorld world;
      return ParticleWorld::make(config, bytes, &world);
    });
    const thimble_particle_config_t plain{config.width,          config.height,        config.capacity,
                                          config.least_diameter, config.most_diameter, config.restitution_q16,
                                          config.gravity_q16.x,  config.gravity_q16.y, config.seed,
                                          config.substeps_log2,  config.subpixel_bits};
    hold_to(thimble_particles_bytes(&plain), [&plain](Bytes bytes) {
      thimble_particles_t world;
      return static_cast<Status>(thimble_particles_make(&world, &plain, bytes.data, bytes.size));
    });
    const Vec3i size{number(1, 200), number(1, 200), number(1, 200)};
    hold_to(dense_grid_bytes(size), [&size](Bytes bytes) {
      DenseGrid grid;
      return DenseGrid::make(size, bytes, &grid);
    });
    const int across = number(1, kMaxSamplesAcross);
    const std::int32_t width = number(1, 300);
    if (width != 0) {  // a row of no pixels takes no bytes
      hold_to(samples_bytes(width, across), [across, width](Bytes bytes) {
        HeapBytes row(row_bytes(PixelFormat::kRgb888, kMaxPicturePx));
        return average_samples(bytes, across, width, 0, PixelFormat::kRgb888, row.span());
      });
    }
  });
}

TEST_CASE(
    "bytes: worlds that are edited, with any room -> 0 exactly where make refuses it, else just enough") {
  misuse(61, 400, [](OddValues& odd) {
    OwnedPool pool(odd.between_32(kMinLevel, kMaxLevel), 64);
    REQUIRE(pool.octree.insert({1, 1, 1}, 3) == Status::kOk);
    const HeapBytes packed = compact_of(pool.octree);
    const CompactTree tree = open_or_throw(packed);
    const auto most = [&odd](std::uint32_t sound) {
      return odd.one_in(4) ? odd.any<std::uint32_t>() : static_cast<std::uint32_t>(odd.between(12, sound));
    };
    const EditRoom room{most(200), most(200), most(20), most(20)};
    const EditRoom least = EditedWorld::room_of(tree);
    const bool holds = room.nodes >= least.nodes && room.leaves >= least.leaves &&
                       room.bricks >= least.bricks && room.pages >= least.pages;
    if (holds) {
      hold_to(edited_world_bytes(tree.level(), room), [&](Bytes bytes) {
        EditedWorld world;
        return EditedWorld::make(tree, room, bytes, &world);
      });
    }
    CHECK(edited_world_bytes(odd.one_in(2) ? kMaxDeepMapLevel + 1 : kMinBrickMapLevel - 1, room) == 0);
  });
}

}  // namespace thimble::tests
