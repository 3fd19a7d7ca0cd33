/// The golden frames of the demonstration: the scene `demo` on 128 x 64 pixels in 16 greys, seen from
/// apps::view_at, frame i * kGoldenStep (platform/apps/demo_view.h). Tests on the host and of the firmware
/// share it. A change of the scene, the view or the light is a change of this table.
#pragma once

#include <stdint.h>

namespace thimble::golden {

/// CRC-32 of the compact tree's bytes: tells another scene from another picture.
inline constexpr uint32_t kDemoTreeCrc32 = 0xCB80BC55;

inline constexpr uint32_t kDemoFrameCrc32[] = {
    0xE186E8C8, 0x95CA3151, 0x69A22653, 0x3DB96EE7, 0x38EA3D65, 0x4D2E1104, 0x2D0C8AF1, 0xE300125B,
};

/// The same frames with direct light and shadows (`--effects direct-light,shadows`), dithered.
inline constexpr uint32_t kDemoLitFrameCrc32[] = {
    0xAAF96716, 0x933278B3, 0x121DC5CD, 0x761BBCF6, 0xA046764B, 0x3CA615F3, 0x747208CA, 0xC935CDEB,
};

}  // namespace thimble::golden
