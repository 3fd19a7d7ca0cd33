#include "portable/rays.h"

namespace thimble::portable {
namespace {

using Box = RayScene::Box;

constexpr Box cell(int16_t x, int16_t y, int16_t z) {
  return {{x, y, z}, {static_cast<int16_t>(x + 1), static_cast<int16_t>(y + 1), static_cast<int16_t>(z + 1)}};
}
template <size_t kCount>
constexpr RayScene scene(int level, int pool_nodes, const Box (&boxes)[kCount]) {
  return {static_cast<uint8_t>(level), static_cast<uint8_t>(kCount), static_cast<uint16_t>(pool_nodes),
          boxes};
}

constexpr RayScene kEmpty = {3, 0, 1, nullptr};
constexpr Box kOneBoxes[] = {cell(4, 4, 4)};
constexpr RayScene kOne = scene(3, 8, kOneBoxes);
constexpr Box kPairBoxes[] = {cell(4, 4, 4), cell(5, 4, 4)};
constexpr RayScene kPair = scene(3, 8, kPairBoxes);
// A voxel on the world's diagonal, and others that the diagonal only touches.
constexpr Box kDiagonalBoxes[] = {cell(1, 0, 0), cell(0, 1, 0), cell(0, 0, 1), cell(2, 1, 1),
                                  cell(1, 2, 2), cell(5, 5, 5), cell(6, 5, 5)};
constexpr RayScene kDiagonal = scene(3, 24, kDiagonalBoxes);
constexpr Box kFallingBoxes[] = {cell(5, 2, 5)};
constexpr RayScene kFalling = scene(3, 8, kFallingBoxes);
constexpr Box kPlaneDiagonalBoxes[] = {cell(1, 0, 3), cell(0, 1, 3), cell(3, 3, 3)};
constexpr RayScene kPlaneDiagonal = scene(3, 16, kPlaneDiagonalBoxes);
// Around the line x = 4, z = 4.
constexpr Box kAboveBoxes[] = {cell(4, 6, 4)};
constexpr RayScene kAbove = scene(3, 8, kAboveBoxes);
constexpr Box kBesideXBoxes[] = {cell(3, 6, 4)};
constexpr RayScene kBesideX = scene(3, 8, kBesideXBoxes);
constexpr Box kBesideZBoxes[] = {cell(4, 6, 3)};
constexpr RayScene kBesideZ = scene(3, 8, kBesideZBoxes);
constexpr Box kBesideBothBoxes[] = {cell(3, 6, 3)};
constexpr RayScene kBesideBoth = scene(3, 8, kBesideBothBoxes);
constexpr Box kFull2Boxes[] = {{{0, 0, 0}, {2, 2, 2}}};
constexpr RayScene kFull2 = scene(1, 8, kFull2Boxes);
constexpr Box kFull8Boxes[] = {{{0, 0, 0}, {8, 8, 8}}};
constexpr RayScene kFull8 = scene(3, 8, kFull8Boxes);
constexpr Box kFull32Boxes[] = {{{0, 0, 0}, {32, 32, 32}}};
constexpr RayScene kFull32 = scene(5, 8, kFull32Boxes);
// A wall x = 5 with a hole at (5, 2, 6), and behind it a wall x = 7.
constexpr Box kWallBoxes[] = {{{5, 0, 0}, {6, 2, 8}},
                              {{5, 3, 0}, {6, 8, 8}},
                              {{5, 2, 0}, {6, 3, 6}},
                              cell(5, 2, 7),
                              {{7, 0, 0}, {8, 8, 8}}};
constexpr RayScene kWall = scene(3, 160, kWallBoxes);
// Steps of one voxel up the x axis.
constexpr Box kStepBoxes[] = {{{0, 0, 0}, {8, 8, 1}},
                              {{1, 0, 1}, {8, 8, 2}},
                              {{2, 0, 2}, {8, 8, 3}},
                              {{3, 0, 3}, {8, 8, 4}},
                              {{4, 0, 4}, {8, 8, 5}}};
constexpr RayScene kSteps = scene(3, 120, kStepBoxes);
// A hollow cube, its walls one voxel thick, around (1 .. 6)^3.
constexpr Box kShellBoxes[] = {{{0, 0, 0}, {8, 8, 1}}, {{0, 0, 7}, {8, 8, 8}}, {{0, 0, 1}, {8, 1, 7}},
                               {{0, 7, 1}, {8, 8, 7}}, {{0, 1, 1}, {1, 7, 7}}, {{7, 1, 1}, {8, 7, 7}}};
constexpr RayScene kShell = scene(3, 200, kShellBoxes);
constexpr Box kCornerBoxes[] = {cell(0, 0, 0), cell(15, 15, 15)};
constexpr RayScene kTwoCorners = scene(4, 24, kCornerBoxes);
constexpr int16_t kLast = (1 << kMaxLevel) - 1;
constexpr Box kLargestBoxes[] = {cell(0, 0, 0),         cell(kLast, 0, 0),        cell(0, kLast, 0),
                                 cell(kLast, kLast, 0), cell(0, 0, kLast),        cell(kLast, 0, kLast),
                                 cell(0, kLast, kLast), cell(kLast, kLast, kLast)};
constexpr RayScene kLargest = scene(kMaxLevel, 96, kLargestBoxes);
constexpr int32_t kLow = -4 * (1 << kMaxLevel);  // the limits of origins, in voxels
constexpr int32_t kHigh = 5 * (1 << kMaxLevel);
constexpr int32_t kFar = 4 * (1 << kMaxLevel);  // from a limit to the world

constexpr int16_t kWhole = 256;
constexpr int16_t kHalf = 128;
constexpr int32_t kMost = kMaxDirection;

// A ray and what it enters, through the face of which axis, at which t.
constexpr RayCase hit(const char* name, const RayScene& scene, int unit_q8, const Vec3i& origin,
                      const Vec3i& direction, const Vec3i& voxel, int axis, int32_t numerator,
                      int32_t denominator) {
  return {name,
          &scene,
          static_cast<int16_t>(unit_q8),
          static_cast<int8_t>(axis),
          {origin.x, origin.y, origin.z},
          {direction.x, direction.y, direction.z},
          {static_cast<int16_t>(voxel.x), static_cast<int16_t>(voxel.y), static_cast<int16_t>(voxel.z)},
          numerator,
          denominator};
}
// A ray that starts inside.
constexpr RayCase inside(const char* name, const RayScene& scene, int unit_q8, const Vec3i& origin,
                         const Vec3i& direction, const Vec3i& voxel) {
  return hit(name, scene, unit_q8, origin, direction, voxel, -1, 0, 1);
}
constexpr RayCase miss(const char* name, const RayScene& scene, int unit_q8, const Vec3i& origin,
                       const Vec3i& direction) {
  return hit(name, scene, unit_q8, origin, direction, {}, kMiss, 0, 1);
}

constexpr RayCase kCases[] = {
    // One axis, either way.
    hit("along +x -> the low face of x", kOne, kHalf, {-2, 9, 9}, {1, 0, 0}, {4, 4, 4}, 0, 5, 1),
    hit("along +y -> the low face of y", kOne, kHalf, {9, -2, 9}, {0, 1, 0}, {4, 4, 4}, 1, 5, 1),
    hit("along +z -> the low face of z", kOne, kHalf, {9, 9, -2}, {0, 0, 1}, {4, 4, 4}, 2, 5, 1),
    hit("along -x -> the high face of x", kOne, kHalf, {19, 9, 9}, {-2, 0, 0}, {4, 4, 4}, 0, 9, 4),
    hit("along -y -> the high face of y", kOne, kHalf, {9, 19, 9}, {0, -2, 0}, {4, 4, 4}, 1, 9, 4),
    hit("along -z -> the high face of z", kOne, kHalf, {9, 9, 19}, {0, 0, -2}, {4, 4, 4}, 2, 9, 4),
    miss("along x, beside the voxel in y -> no hit", kOne, kHalf, {-2, 7, 9}, {1, 0, 0}),
    miss("along y, beside the voxel in z -> no hit", kOne, kHalf, {9, -2, 7}, {0, 1, 0}),
    miss("along z, beside the voxel in x -> no hit", kOne, kHalf, {7, 9, -2}, {0, 0, 1}),
    hit("length of the direction: 1000 times as long -> t a thousandth", kOne, kHalf, {-2, 9, 9},
        {1000, 0, 0}, {4, 4, 4}, 0, 1, 200),

    // One component 0.
    hit("z 0, through an edge -> the lowest axis", kOne, kHalf, {1, 1, 9}, {1, 1, 0}, {4, 4, 4}, 0, 7, 2),
    hit("z 0, y in the slab first -> entered in x", kOne, kHalf, {1, 2, 9}, {1, 1, 0}, {4, 4, 4}, 0, 7, 2),
    hit("z 0, x in the slab first -> entered in y", kOne, kHalf, {2, 1, 9}, {1, 1, 0}, {4, 4, 4}, 1, 7, 2),
    hit("x 0, y last -> entered in y", kOne, kHalf, {9, 1, 2}, {0, 1, 1}, {4, 4, 4}, 1, 7, 2),
    hit("y 0, through an edge -> the lowest axis", kOne, kHalf, {1, 9, 1}, {1, 0, 1}, {4, 4, 4}, 0, 7, 2),
    hit("x 0, through an edge -> the lower of y and z", kOne, kHalf, {9, 1, 1}, {0, 1, 1}, {4, 4, 4}, 1, 7,
        2),
    miss("z 0, an edge touched only -> no hit", kOne, kHalf, {0, 2, 9}, {1, 1, 0}),
    miss("z 0, in the plane of the upper face -> no hit", kOne, kHalf, {1, 1, 10}, {1, 1, 0}),
    hit("z 0, in the plane of the lower face -> hit", kOne, kHalf, {1, 1, 8}, {1, 1, 0}, {4, 4, 4}, 0, 7, 2),

    // All three.
    hit("steep in x -> entered in x", kOne, kWhole, {0, 3, 3}, {5, 2, 2}, {4, 4, 4}, 0, 4, 5),
    hit("steep in y -> entered in y", kOne, kWhole, {3, 0, 3}, {2, 5, 2}, {4, 4, 4}, 1, 4, 5),
    hit("steep in z -> entered in z", kOne, kWhole, {3, 3, 0}, {2, 2, 5}, {4, 4, 4}, 2, 4, 5),
    hit("all negative, steep in z -> the high face of z", kOne, kWhole, {6, 6, 9}, {-2, -2, -5}, {4, 4, 4}, 2,
        4, 5),
    hit("signs mixed -> entered in the last slab", kOne, kHalf, {2, 17, 2}, {2, -2, 2}, {4, 4, 4}, 1, 7, 4),
    miss("passes the corner at a distance -> no hit", kOne, kHalf, {0, 3, 6}, {1, 1, 1}),

    // The smallest distances and slopes.
    hit("1/256 voxel before the face -> t 1/256", kOne, 1, {1023, 1100, 1100}, {1, 0, 0}, {4, 4, 4}, 0, 1,
        256),
    hit("1/256 voxel, longest direction -> t as small as it gets", kOne, 1, {1281, 1100, 1100},
        {-kMost, 0, 0}, {4, 4, 4}, 0, 1, 256 * kMost),
    miss("slope of 1/257 from a hair below -> not within the voxel", kOne, 1, {1024, 1023, 1100},
         {257, 1, 0}),
    miss("slope of 1/256 from a hair below -> touches the end only", kOne, 1, {1024, 1023, 1100},
         {256, 1, 0}),
    hit("slope of 1/255 from a hair below -> enters at the end", kOne, 1, {1024, 1023, 1100}, {255, 1, 0},
        {4, 4, 4}, 1, 1, 256),
    hit("slope of 2^-20 along the edge -> entered in x", kOne, 1, {-1024, 1024, 1100}, {kMost, 1, 0},
        {4, 4, 4}, 0, 8, kMost),
    miss("slope of -2^-20 along the lower face -> falls out of the voxel at once", kOne, 1,
         {1024, 1024, 1100}, {kMost, -1, 0}),

    // Ties.
    hit("diagonal, from a corner of the world -> only what lies on it", kDiagonal, kHalf, {0, 0, 0},
        {7, 7, 7}, {5, 5, 5}, 0, 5, 7),
    hit("diagonal, from outside -> the same", kDiagonal, kHalf, {-4, -4, -4}, {1, 1, 1}, {5, 5, 5}, 0, 7, 1),
    hit("diagonal, downwards -> the same from above", kDiagonal, kHalf, {16, 16, 16}, {-3, -3, -3}, {5, 5, 5},
        0, 2, 3),
    miss("falling diagonal past touched voxels -> no hit", kDiagonal, kHalf, {0, 16, 0}, {1, -1, 1}),
    hit("falling diagonal -> the voxel on it", kFalling, kHalf, {0, 16, 0}, {1, -1, 1}, {5, 2, 5}, 0, 5, 1),
    hit("diagonal in a plane -> voxels beside the edges are only touched", kPlaneDiagonal, kHalf, {0, 0, 7},
        {1, 1, 0}, {3, 3, 3}, 0, 3, 1),
    miss("rising and falling at once -> the edge is touched", kPlaneDiagonal, kHalf, {0, 2, 7}, {1, -1, 0}),
    hit("x and y tie, z earlier -> x", kOne, kHalf, {2, 2, 3}, {2, 2, 2}, {4, 4, 4}, 0, 3, 2),
    hit("x and z tie, y earlier -> x", kOne, kHalf, {2, 3, 2}, {2, 2, 2}, {4, 4, 4}, 0, 3, 2),
    hit("y and z tie, x earlier -> y", kOne, kHalf, {3, 2, 2}, {2, 2, 2}, {4, 4, 4}, 1, 3, 2),
    hit("tie of unequal slopes -> x", kOne, kWhole, {2, 1, 4}, {2, 3, 0}, {4, 4, 4}, 0, 1, 1),

    // Within a face.
    hit("in the face x = 4, up -> the voxel above the plane", kAbove, kHalf, {8, 0, 9}, {0, 1, 0}, {4, 6, 4},
        1, 6, 1),
    hit("in the face x = 4, down -> the same", kAbove, kHalf, {8, 16, 9}, {0, -1, 0}, {4, 6, 4}, 1, 1, 1),
    miss("in the face x = 4, up -> not the voxel below the plane", kBesideX, kHalf, {8, 0, 9}, {0, 1, 0}),
    miss("in the face x = 4, down -> not that either", kBesideX, kHalf, {8, 16, 9}, {0, -1, 0}),
    miss("in the world's upper face -> nothing", kFull2, kHalf, {4, 0, 1}, {0, 1, 0}),
    hit("in the world's lower face -> the first voxel", kFull2, kHalf, {0, -2, 1}, {0, 1, 0}, {0, 0, 0}, 1, 1,
        1),
    hit("in a face, slanting -> the voxel above the plane", kAbove, kHalf, {8, 10, 7}, {0, 1, 1}, {4, 6, 4},
        1, 1, 1),

    // Along an edge: of the four voxels around it only the one above both planes.
    hit("along the edge x = z = 4, up -> the owner", kAbove, kHalf, {8, 0, 8}, {0, 5, 0}, {4, 6, 4}, 1, 6, 5),
    hit("along the edge x = z = 4, down -> the owner", kAbove, kHalf, {8, 16, 8}, {0, -5, 0}, {4, 6, 4}, 1, 1,
        5),
    miss("along the edge, below in x, up -> no hit", kBesideX, kHalf, {8, 0, 8}, {0, 5, 0}),
    miss("along the edge, below in x, down -> no hit", kBesideX, kHalf, {8, 16, 8}, {0, -5, 0}),
    miss("along the edge, below in z, up -> no hit", kBesideZ, kHalf, {8, 0, 8}, {0, 5, 0}),
    miss("along the edge, below in z, down -> no hit", kBesideZ, kHalf, {8, 16, 8}, {0, -5, 0}),
    miss("along the edge, below in both, up -> no hit", kBesideBoth, kHalf, {8, 0, 8}, {0, 5, 0}),
    miss("along the edge, below in both, down -> no hit", kBesideBoth, kHalf, {8, 16, 8}, {0, -5, 0}),

    // Starts on faces, edges and corners of solids.
    inside("start on a face, forwards -> inside the voxel above", kFull8, kHalf, {8, 9, 9}, {1, 0, 0},
           {4, 4, 4}),
    inside("start on a face, backwards -> inside the voxel below", kFull8, kHalf, {8, 9, 9}, {-1, 0, 0},
           {3, 4, 4}),
    inside("start on a face, along it -> inside its owner", kFull8, kHalf, {8, 9, 9}, {0, 0, -1}, {4, 4, 4}),
    inside("start on an edge, into the octant -> the voxel there", kFull8, kHalf, {8, 8, 9}, {-1, 1, 0},
           {3, 4, 4}),
    inside("start on an edge, along one face -> its owner", kFull8, kHalf, {8, 8, 9}, {0, -1, 0}, {4, 3, 4}),
    inside("start on a corner, all up -> the voxel above", kFull8, kHalf, {8, 8, 8}, {1, 1, 1}, {4, 4, 4}),
    inside("start on a corner, mixed -> the voxel it goes into", kFull8, kHalf, {8, 8, 8}, {-1, 2, -3},
           {3, 4, 3}),
    inside("start on a corner, all down -> the voxel below", kFull8, kHalf, {8, 8, 8}, {-1, -1, -1},
           {3, 3, 3}),
    inside("start on a corner, along an edge -> its owner", kFull8, kHalf, {8, 8, 8}, {0, 0, -1}, {4, 4, 3}),
    inside("start on the world's far corner, inwards -> the last voxel", kFull8, kHalf, {16, 16, 16},
           {-1, -1, -1}, {7, 7, 7}),
    miss("start on the world's far corner, out in x -> no hit", kFull8, kHalf, {16, 16, 16}, {1, -1, -1}),
    miss("start on the world's near face, outwards -> no hit", kFull8, kHalf, {0, 9, 9}, {-1, 0, 0}),
    miss("start on the high face, leaving -> no hit with it", kOne, kHalf, {10, 9, 9}, {1, 0, 0}),
    miss("start on the low face, leaving -> no hit with it", kOne, kHalf, {8, 9, 9}, {-1, 0, 0}),
    miss("start on the high corner, leaving in y -> no hit", kOne, kHalf, {10, 10, 10}, {-1, 1, -1}),
    miss("start on the low corner, leaving in x -> no hit", kOne, kHalf, {8, 8, 8}, {-1, 1, 1}),
    inside("start on the low corner, inwards -> inside", kOne, kHalf, {8, 8, 8}, {1, 1, 1}, {4, 4, 4}),
    inside("start on the high corner, inwards -> inside", kOne, kHalf, {10, 10, 10}, {-1, -1, -1}, {4, 4, 4}),
    inside("start on the low face, along it -> inside", kOne, kHalf, {8, 9, 9}, {0, 1, 0}, {4, 4, 4}),
    miss("start on the high face, along it -> outside", kOne, kHalf, {10, 9, 9}, {0, 1, 0}),

    // Starts inside.
    inside("start in the middle, along x -> t 0, no axis", kPair, kHalf, {9, 9, 9}, {1, 0, 0}, {4, 4, 4}),
    inside("start in the middle, away from the neighbour -> the same", kPair, kHalf, {9, 9, 9}, {-1, 0, 0},
           {4, 4, 4}),
    inside("start in the middle, slanting -> the same", kPair, kHalf, {9, 9, 9}, {1, -1, 1}, {4, 4, 4}),
    inside("start a hair inside the high face -> that voxel", kPair, 1, {1535, 1025, 1279}, {1, 0, 0},
           {5, 4, 4}),
    inside("start a hair inside the high face, straight down -> that voxel", kPair, 1, {1535, 1025, 1279},
           {0, 0, -9}, {5, 4, 4}),
    inside("start between two solids, back -> the one behind", kPair, kHalf, {10, 9, 9}, {-1, 0, 0},
           {4, 4, 4}),
    inside("start between two solids, on -> the one in front", kPair, kHalf, {10, 9, 9}, {1, 0, 0},
           {5, 4, 4}),

    // Whole and empty worlds.
    miss("empty world, from inside -> no hit", kEmpty, kHalf, {1, 1, 1}, {1, 2, 3}),
    miss("empty world, from outside -> no hit", kEmpty, kWhole, {-9, 3, 3}, {1, 0, 0}),
    hit("full world of 2, from the side -> its first voxel", kFull2, kHalf, {-2, 1, 1}, {1, 0, 0}, {0, 0, 0},
        0, 1, 1),
    hit("full world of 8, onto its last row -> that voxel", kFull8, kHalf, {18, 15, 1}, {-1, 0, 0}, {7, 7, 0},
        0, 1, 1),
    hit("full world of 32, through a corner -> its first voxel", kFull32, kHalf, {-2, -2, -2}, {1, 1, 1},
        {0, 0, 0}, 0, 1, 1),
    hit("full world of 32, from above -> the voxel under it", kFull32, kHalf, {35, 21, 70}, {0, 0, -3},
        {17, 10, 31}, 2, 1, 1),
    hit("full world of 32, slanting onto its top -> the voxel entered", kFull32, kHalf, {21, 21, 80},
        {1, 2, -4}, {12, 14, 31}, 2, 2, 1),
    miss("full world, pointing away -> no hit", kFull8, kHalf, {-1, 9, 9}, {-11, 5, 7}),
    miss("full world, passing by -> no hit", kFull8, kHalf, {-1, 9, 9}, {0, 1, 0}),

    // Walls, steps, shells.
    hit("through the hole in a wall -> the wall behind", kWall, kHalf, {0, 5, 13}, {1, 0, 0}, {7, 2, 6}, 0, 7,
        1),
    hit("beside the hole -> the first wall", kWall, kHalf, {0, 7, 13}, {1, 0, 0}, {5, 3, 6}, 0, 5, 1),
    hit("slanting through the hole -> the wall behind", kWall, kWhole, {3, 2, 6}, {8, 1, 1}, {7, 2, 6}, 0, 1,
        2),
    hit("too slanting for the hole -> its side", kWall, kHalf, {10, 5, 13}, {1, 1, 0}, {5, 3, 6}, 1, 1, 2),
    hit("from behind -> the back of the second wall", kWall, kHalf, {18, 5, 13}, {-1, 0, 0}, {7, 2, 6}, 0, 1,
        1),
    hit("between the walls -> the back of the first", kWall, kHalf, {13, 9, 3}, {-1, 0, 0}, {5, 4, 1}, 0, 1,
        2),
    miss("along the gap between the walls -> no hit", kWall, kHalf, {13, -3, 3}, {0, 1, 0}),
    hit("down onto a step -> its top", kSteps, kHalf, {5, 5, 15}, {0, 0, -1}, {2, 2, 2}, 2, 9, 2),
    hit("along a step -> the next one's front", kSteps, kHalf, {-1, 5, 5}, {1, 0, 0}, {2, 2, 2}, 0, 5, 2),
    miss("down the stairs on their slope -> only touches their edges", kSteps, kHalf, {10, 5, 12},
         {-1, 0, -1}),
    hit("down the stairs a hair lower -> the first step", kSteps, 1, {1279, 640, 1534}, {-1, 0, -1},
        {4, 2, 4}, 2, 254, 256),
    hit("from within a shell, along x -> its wall", kShell, kHalf, {7, 7, 7}, {1, 0, 0}, {7, 3, 3}, 0, 7, 2),
    hit("from within a shell, into its corner -> the corner voxel, lowest axis", kShell, kHalf, {8, 8, 8},
        {1, 1, 1}, {7, 7, 7}, 0, 3, 1),
    hit("from within a shell, into its edge -> entered in the lower axis", kShell, kHalf, {8, 8, 8},
        {0, 1, 1}, {4, 7, 7}, 1, 3, 1),
    hit("from within a shell, nearly into the edge -> entered in z", kShell, kHalf, {8, 8, 8}, {0, 999, 1000},
        {4, 6, 7}, 2, 3, 1000),
    hit("from outside a shell -> its outer face", kShell, kHalf, {8, -8, 8}, {0, 1, 0}, {4, 0, 4}, 1, 4, 1),

    // Far away and the largest numbers.
    hit("corner to corner of a world of 16 -> what lies at its end", kTwoCorners, kWhole, {1, 1, 1},
        {1, 1, 1}, {15, 15, 15}, 0, 14, 1),
    hit("the same back -> the voxel at the origin", kTwoCorners, kWhole, {15, 15, 15}, {-1, -1, -1},
        {0, 0, 0}, 0, 14, 1),
    hit("4 worlds away, straight -> t 64", kTwoCorners, kHalf, {-128, 1, 1}, {1, 0, 0}, {0, 0, 0}, 0, 64, 1),
    hit("5 worlds away, down the other way -> the far voxel", kTwoCorners, kHalf, {160, 31, 31}, {-1, 0, 0},
        {15, 15, 15}, 0, 64, 1),
    miss("5 worlds away, just past -> no hit", kTwoCorners, kHalf, {160, 32, 31}, {-1, 0, 0}),
    hit("largest world, main diagonal from the limit -> the nearest corner", kLargest, kWhole,
        {kLow, kLow, kLow}, {kMost, kMost, kMost}, {0, 0, 0}, 0, kFar, kMost),
    hit("largest world, main diagonal from the other limit -> the farthest corner", kLargest, kWhole,
        {kHigh, kHigh, kHigh}, {-kMost, -kMost, -kMost}, {kLast, kLast, kLast}, 0, kFar, kMost),
    hit("largest world, another diagonal -> the corner there", kLargest, kWhole, {kLow, kHigh, kLow},
        {1, -1, 1}, {0, kLast, 0}, 0, kFar, 1),
    hit("largest world, from inside over 4094 empty voxels -> the far corner", kLargest, kWhole, {1, 1, 1},
        {kMost, kMost, kMost}, {kLast, kLast, kLast}, 0, kLast - 1, kMost),
    hit("largest world, along its lowest edge in x -> the voxel at the origin", kLargest, kWhole,
        {kLow, 0, 0}, {1, 0, 0}, {0, 0, 0}, 0, kFar, 1),
    hit("largest world, along an upper edge in y -> its corner", kLargest, kWhole, {kLast, kHigh, 0},
        {0, -1, 0}, {kLast, kLast, 0}, 1, kFar, 1),
    hit("largest world, along an edge in z -> its corner", kLargest, kWhole, {0, kLast, kLow}, {0, 0, 1},
        {0, kLast, 0}, 2, kFar, 1),
    miss("largest world, in the plane above its edge -> no hit", kLargest, kWhole, {kLow, 1, 0}, {1, 0, 0}),
    hit("largest world, a slope of 2^-20 across it -> the far corner, just in time", kLargest, 1,
        {256, 255, 0}, {kMost, 1, 0}, {kLast, 0, 0}, 0, 256 * (kLast - 1), 256 * kMost),
    miss("largest world, a little steeper -> touches its edge", kLargest, 1, {256, 255, 0},
         {256 * (kLast - 1), 1, 0}),
};

static_assert(sizeof kCases / sizeof kCases[0] == kRayCaseCount);

#ifdef THIMBLE_TERSE_CASES
// The same without the names; `kCases` is then not in the image.
struct Table {
  RayCase cases[kRayCaseCount];
};
constexpr Table terse() {
  Table table{};
  for (int i = 0; i < kRayCaseCount; ++i) {
    table.cases[i] = kCases[i];
    table.cases[i].name = nullptr;
  }
  return table;
}
constexpr Table kTerse = terse();
constexpr Span<const RayCase> kShown = kTerse.cases;
#else
constexpr Span<const RayCase> kShown = kCases;
#endif

}  // namespace

Span<const RayCase> ray_cases() {
  return kShown;
}

}  // namespace thimble::portable
