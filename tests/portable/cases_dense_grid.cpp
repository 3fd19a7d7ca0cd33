// One bit a voxel.
#include "portable/groups.h"
#include "portable/scene.h"

namespace thimble::portable {
namespace {

constexpr Case kCases[] = {
    {"bytes: any size -> bits rounded up; beyond the limits -> 0", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(dense_grid_bytes({1, 1, 1}), 1U);
       THIMBLE_EQUAL(dense_grid_bytes({2, 2, 2}), 1U);
       THIMBLE_EQUAL(dense_grid_bytes({3, 3, 1}), 2U);
       THIMBLE_EQUAL(dense_grid_bytes({800, 600, 1}), 60000U);
       THIMBLE_EQUAL(dense_grid_bytes({800, 600, 800}), 48000000U);
       THIMBLE_EQUAL(dense_grid_bytes({0, 1, 1}), 0U);
       THIMBLE_EQUAL(dense_grid_bytes({1, -1, 1}), 0U);
       THIMBLE_EQUAL(dense_grid_bytes({1, 1, 4097}), 0U);
     }},
    {"init -> empty, whatever the bytes held", 64,
     [](Check& check, int) {
       const Bytes bytes = check.arena.take(64);
       for (uint8_t& byte : bytes) {
         byte = 0xFF;
       }
       DenseGrid& grid = check.world.grid;
       THIMBLE_REQUIRE_OK(DenseGrid::make({5, 3, 7}, bytes, &grid));
       THIMBLE_EQUAL(grid.voxel_count(), 0U);
       THIMBLE_EQUAL(grid.used_bytes(), 14U);
       THIMBLE_EQUAL(grid.level(), 3);
       THIMBLE_CHECK(grid.bounds().empty());
       THIMBLE_EQUAL(bytes[13], 0);
       THIMBLE_EQUAL(bytes[14], 0xFF);
     }},
    {"init: one byte too few -> out of memory, untouched", 16,
     [](Check& check, int) {
       const Bytes bytes = check.arena.take(13, 1);
       bytes[0] = 0x5A;
       DenseGrid& grid = check.world.grid;
       THIMBLE_EQUAL(DenseGrid::make({5, 3, 7}, bytes, &grid), Status::kOutOfMemory);
       THIMBLE_EQUAL(bytes[0], 0x5A);
       THIMBLE_EQUAL(grid.size(), (Vec3i{0, 0, 0}));
     }},
    {"init: sizes beyond the limits -> out of range", 16,
     [](Check& check, int) {
       const Bytes bytes = check.arena.take(16);
       THIMBLE_EQUAL(DenseGrid::make({0, 1, 1}, bytes, &check.world.grid), Status::kOutOfRange);
       THIMBLE_EQUAL(DenseGrid::make({1, 4097, 1}, bytes, &check.world.grid), Status::kOutOfRange);
       THIMBLE_EQUAL(DenseGrid::make({1, 1, INT32_MIN}, bytes, &check.world.grid), Status::kOutOfRange);
     }},
    {"set and test: a voxel -> that bit of that byte", 16,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_grid(check, {5, 3, 7}));
       DenseGrid& grid = check.world.grid;
       THIMBLE_REQUIRE_OK(grid.set({2, 1, 3}));  // bit (3 * 3 + 1) * 5 + 2 = 52
       THIMBLE_CHECK(grid.test({2, 1, 3}));
       THIMBLE_CHECK(!grid.test({3, 1, 3}));
       THIMBLE_EQUAL(grid.voxel_count(), 1U);
       THIMBLE_EQUAL(grid.bounds(), (VoxelBox{{2, 1, 3}, {3, 2, 4}}));
     }},
    {"set: twice, then cleared twice -> counted once", 16,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_grid(check, {5, 3, 7}));
       DenseGrid& grid = check.world.grid;
       THIMBLE_REQUIRE_OK(grid.set({4, 2, 6}));
       THIMBLE_REQUIRE_OK(grid.set({4, 2, 6}));
       THIMBLE_EQUAL(grid.voxel_count(), 1U);
       THIMBLE_REQUIRE_OK(grid.set({4, 2, 6}, false));
       THIMBLE_REQUIRE_OK(grid.set({4, 2, 6}, false));
       THIMBLE_EQUAL(grid.voxel_count(), 0U);
       THIMBLE_CHECK(!grid.test({4, 2, 6}));
     }},
    {"outside the grid -> out of range, and not solid", 16,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_grid(check, {5, 3, 7}));
       constexpr Vec3i kAts[] = {{5, 0, 0},  {0, 3, 0},         {0, 0, 7},
                                 {-1, 0, 0}, {0, INT32_MIN, 0}, {0, 0, INT32_MAX}};
       for (const Vec3i& at : kAts) {
         THIMBLE_EQUAL(check.world.grid.set(at), Status::kOutOfRange);
         THIMBLE_CHECK(!check.world.grid.test(at));
       }
       THIMBLE_EQUAL(check.world.grid.voxel_count(), 0U);
     }},
    {"a grid that is no cube, full -> rays hit its own faces", 16,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_grid(check, {5, 3, 7}));
       for (int32_t i = 0; i < 105; ++i) {
         THIMBLE_REQUIRE_OK(check.world.grid.set({i % 5, i / 5 % 3, i / 15}));
       }
       THIMBLE_EQUAL(check.world.grid.voxel_count(), 105U);
       THIMBLE_REQUIRE_OK(closest(check, 0, ray_q8({1500, 300, 300}, {-1, 0, 0}), check.options));
       THIMBLE_EQUAL(check.hit.voxel, (Vec3i{4, 1, 1}));
       THIMBLE_EQUAL(check.hit.t_numerator, 220);
       THIMBLE_REQUIRE_OK(closest(check, 0, ray_q8({300, 300, 2000}, {0, 0, -1}), check.options));
       THIMBLE_EQUAL(check.hit.voxel, (Vec3i{1, 1, 6}));
       THIMBLE_REQUIRE_OK(closest(check, 0, ray_q8({-300, 800, 300}, {1, 0, 0}), check.options));
       THIMBLE_EQUAL(check.hit.kind, HitKind::kMiss);
     }},
    {"a voxel cleared -> rays pass", 16,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_grid(check, {4, 4, 4}));
       THIMBLE_REQUIRE_OK(check.world.grid.set({1, 1, 1}));
       THIMBLE_REQUIRE_OK(check.world.grid.set({3, 1, 1}));
       THIMBLE_REQUIRE_OK(check.world.grid.set({1, 1, 1}, false));
       THIMBLE_REQUIRE_OK(closest(check, 0, ray_q8({0, 300, 300}, {1, 0, 0}), check.options));
       THIMBLE_EQUAL(check.hit.voxel, (Vec3i{3, 1, 1}));
     }},
    {"bits at any address -> the same answers", 32,
     [](Check& check, int) {
       static_cast<void>(check.arena.take(1, 1));
       const Bytes bytes = check.arena.take(14, 1);
       THIMBLE_REQUIRE_OK(DenseGrid::make({5, 3, 7}, bytes, &check.world.grid));
       THIMBLE_REQUIRE_OK(check.world.grid.set({4, 2, 6}));
       THIMBLE_EQUAL(bytes[13], 1);
       THIMBLE_REQUIRE_OK(closest(check, 0, ray_q8({1150, 600, 0}, {0, 0, 3}), check.options));
       THIMBLE_EQUAL(check.hit.voxel, (Vec3i{4, 2, 6}));
     }},
};

}  // namespace

const Group kDenseGridGroup = group_of<kCases>("dense grid", "cases_dense_grid.cpp");

}  // namespace thimble::portable
