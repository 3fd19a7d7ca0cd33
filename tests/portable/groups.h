/// All cases, topic by topic, in the order in which they are run.
#pragma once

#include "portable/case.h"

namespace thimble::portable {

/// What every board has for a case: 8 KiB less the stack (up to 2,900 bytes) and what the runner keeps. The
/// cases that need no more are run everywhere, and their CRC is one number everywhere.
inline constexpr uint32_t kCommonArenaBytes = 4608;

/// The same for lit pictures, which want a stack of up to 3,700 bytes.
inline constexpr uint32_t kLitArenaBytes = 2560;

/// Cases of the golden group that draw a frame, and the same counted: the host's runner compares them.
inline constexpr int kGoldenFrameCases = 324;
int count_golden_frame_cases();

extern const Group kNumberGroup;       ///< fixed point, spans, the arena, CRC-32, Morton codes
extern const Group kPixelGroup;        ///< pixels in every format
extern const Group kRayGroup;          ///< the table of rays (rays.h)
extern const Group kTraceGroup;        ///< what holds for all rays
extern const Group kOctreeGroup;       ///< the tree that changes
extern const Group kCompactTreeGroup;  ///< the tree in flash
extern const Group kDenseGridGroup;    ///< one bit a voxel
extern const Group kCameraGroup;       ///< cameras and their rays
extern const Group kShadingGroup;      ///< colours
extern const Group kRenderGroup;       ///< bands
extern const Group kBakedSceneGroup;   ///< whole scenes as bytes
extern const Group kGoldenGroup;       ///< golden frames
extern const Group kAnytimeGroup;      ///< golden frames, from coarse to fine
extern const Group kWaterGroup;        ///< moving water and its rays
extern const Group kPanelGroup;        ///< pixels of panels, and a frame in each of their formats
extern const Group kLitGroup;          ///< light, mirrors, glass, water in pictures
extern const Group kPlaneGroup;        ///< bits in the plane, and the balls among them
extern const Group kWorldGroup;     ///< worlds that are edited, maps, shared trees, what light does as bytes
extern const Group kBrickGroup;     ///< frames by bricks, frames that stop at small blocks, samples at edges
extern const Group kMapLightGroup;  ///< lit frames by bricks

/// The core's own cases (the application `selftest`): every board runs all of them.
inline constexpr const Group* kCoreGroups[] = {
    &kNumberGroup,      &kPixelGroup,     &kRayGroup,    &kTraceGroup,   &kOctreeGroup,
    &kCompactTreeGroup, &kDenseGridGroup, &kCameraGroup, &kShadingGroup, &kRenderGroup,
};
/// What lies in flash (the application `golden`): baked scenes and the golden frames; and water, for which
/// `selftest` has no room left on the smallest chip.
inline constexpr const Group* kGoldenGroups[] = {&kBakedSceneGroup, &kGoldenGroup, &kAnytimeGroup,
                                                 &kWaterGroup};
/// The formats of panels (the application `formats`).
inline constexpr const Group* kPanelGroups[] = {&kPanelGroup};
/// Lit pictures (the application `lit`).
inline constexpr const Group* kLitGroups[] = {&kLitGroup};
/// Other shapes of a world, and the plane (the application `worlds`).
inline constexpr const Group* kWorldGroups[] = {&kWorldGroup, &kPlaneGroup};
/// Frames by bricks (the application `bricks`), which want as much stack as light does.
inline constexpr const Group* kBrickGroups[] = {&kBrickGroup};
/// Lit frames by bricks (the application `map_light`), on boards with flash for them.
inline constexpr const Group* kMapLightGroups[] = {&kMapLightGroup};

}  // namespace thimble::portable
