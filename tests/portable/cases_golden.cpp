// Every golden frame in every way to draw it: a case each. The compact trees lie in flash, so each frame is
// drawn on every board; pools and dense grids are built where the RAM holds them.
#include "golden/golden_table.h"
#include "portable/golden_trees.h"
#include "portable/groups.h"
#include "portable/scene.h"

namespace thimble::portable {
namespace {

using golden::Frame;
using golden::SceneId;
using golden::Structure;

// The way, less the height of the bands: whole frames do not fit, and any height gives the same bytes.
struct Way {
  Structure structure;
  Width width;
  int8_t band_rows;
  const char* name;
};
constexpr Way kWays[] = {
    {Structure::kCompact, Width::k64, 4, "compact tree in flash, 64 bits"},
    {Structure::kCompact, Width::k32, 3, "compact tree in flash, 32 bits"},
    {Structure::kCompact, Width::kAuto, 1, "compact tree in flash"},
    {Structure::kPool, Width::kAuto, 5, "octree"},
    {Structure::kPool, Width::k32, 2, "octree, 32 bits"},
    {Structure::kPool, Width::k64, 3, "octree, 64 bits"},
    {Structure::kDense, Width::k64, 1, "dense grid, 64 bits"},
    {Structure::kDense, Width::k32, 2, "dense grid, 32 bits"},
};
constexpr int kWayCount = sizeof kWays / sizeof kWays[0];
constexpr int kFrameCount = sizeof golden::kGoldenTable / sizeof golden::kGoldenTable[0];

constexpr uint32_t rounded(size_t bytes) {
  return static_cast<uint32_t>((bytes + 7) & ~size_t{7});
}

uint32_t structure_bytes(SceneId id, Structure structure) {
  const golden::SceneInfo& info = golden::scene_info(id);
  const int32_t side = int32_t{1} << info.level;
  switch (structure) {
    case Structure::kDense:
      return rounded(dense_grid_bytes({side, side, side}));
    case Structure::kPool:
      return rounded(Octree::octree_bytes(info.pool_nodes));
    case Structure::kCompact:
      return 0;
  }
  return 0;
}

bool make_world(Check& check, SceneId id, Structure structure) {
  if (structure != Structure::kCompact) {
    return check.equal(golden::build_scene(id, structure, &check.arena, &check.world), Status::kOk,
                       THIMBLE_WHAT("build_scene"));
  }
  check.world.structure = Structure::kCompact;
  return check.equal(CompactTree::open(golden_tree(id), &check.world.compact), Status::kOk,
                     THIMBLE_WHAT("the tree in flash"));
}

bool shown(const Frame& frame, const Way& way) {
  return golden::applies(frame, {way.structure, way.width, way.band_rows});
}

// A case number is a frame and a way.
void run_frame(Check& check, int index) {
  const Frame& frame = golden::frame(index / kWayCount);
  const Way& way = kWays[index % kWayCount];
  THIMBLE_REQUIRE(make_world(check, frame.scene, way.structure));
  THIMBLE_REQUIRE_OK(golden::set_up(frame, &check.camera, &check.shading));
  const Bytes band = check.arena.take(thimble::band_bytes(frame.format, frame.width_px, way.band_rows));
  uint32_t crc = 0;
  const Status status = golden::frame_crc32(frame, check.world, check.camera, check.shading, way.width,
                                            way.band_rows, band, &crc, &check.counts);
  if (!shown(frame, way)) {
    // Rays that are too long for 32 bits must be refused.
    THIMBLE_EQUAL(status, Status::kBadArgument);
    return;
  }
  THIMBLE_REQUIRE_OK(status);
  THIMBLE_EQUAL(crc, golden::kGoldenTable[index / kWayCount].crc32);
  THIMBLE_EQUAL(check.counts.rays, static_cast<uint32_t>(frame.width_px * frame.height_px));
  // A visit is another thing in another structure, but the same one on every machine.
  check.note(static_cast<int64_t>(check.counts.node_visits));
  check.note(static_cast<int64_t>(check.counts.hits));
}

// The scene built here, and its compact tree: the bytes that lie in flash.
void run_tree(Check& check, int index) {
  const SceneId id = static_cast<SceneId>(index);
  THIMBLE_REQUIRE(make_world(check, id, Structure::kPool));
  THIMBLE_REQUIRE(make_compact(check));
  const ConstBytes flash = golden_tree(id);
  THIMBLE_CHECK(check.equal(ConstBytes(check.world.compact.bytes(), check.world.compact.size_bytes()), flash,
                            THIMBLE_WHAT("bytes of the tree")));
  THIMBLE_CHECK(CompactTree::validate(flash) == nullptr);
}

// Which frame and way the n-th case is: those that a structure cannot show are left out, but for the 32-bit
// ones, which must be refused.
bool is_case(const Frame& frame, const Way& way) {
  return shown(frame, way) || (way.width == Width::k32 && !frame.narrow &&
                               shown(frame, {way.structure, Width::kAuto, 1, nullptr}));
}

// The number of the case at `position` of those that are, or -1 behind the last.
int number_of(int position) {
  for (int number = 0; number < kFrameCount * kWayCount; ++number) {
    if (is_case(golden::frame(number / kWayCount), kWays[number % kWayCount]) && position-- == 0) {
      return number;
    }
  }
  return -1;
}

Case at(int index) {
  if (index < golden::kSceneCount) {
    const SceneId id = static_cast<SceneId>(index);
    return {golden::scene_info(id).name,
            structure_bytes(id, Structure::kPool) + rounded(golden_tree(id).size), run_tree, index,
            "built here: the tree in flash"};
  }
  const int number = number_of(index - golden::kSceneCount);
  const Frame& frame = golden::frame(number / kWayCount);
  const Way& way = kWays[number % kWayCount];
  return {frame.name,
          structure_bytes(frame.scene, way.structure) +
              rounded(thimble::band_bytes(frame.format, frame.width_px, way.band_rows)),
          run_frame, number, way.name};
}

}  // namespace

int count_golden_frame_cases() {
  int count = 0;
  while (number_of(count) >= 0) {
    ++count;
  }
  return count;
}

const Group kGoldenGroup = {"golden", "cases_golden.cpp", golden::kSceneCount + kGoldenFrameCases, at};

}  // namespace thimble::portable
