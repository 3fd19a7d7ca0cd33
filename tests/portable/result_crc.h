/// What the portable cases compute, as CRC-32s (runner.h). Written by `thimble_golden_tests --crc`.
#pragma once

#include <stdint.h>

namespace thimble::portable {

/// Of the core's own cases, all of which every board runs.
inline constexpr uint32_t kCoreCrc32 = 0x91A5CA6F;
/// Of what lies in flash: baked scenes and golden frames, all of them and those that every board runs.
inline constexpr uint32_t kGoldenCrc32 = 0x6150ED3F;
inline constexpr uint32_t kCommonGoldenCrc32 = 0x39872813;
/// Of the formats of panels, in an image that has them all.
inline constexpr uint32_t kPanelCrc32 = 0xAE95E326;
/// Of lit pictures, all of which every board draws.
inline constexpr uint32_t kLitCrc32 = 0x957158C6;
/// Of worlds of other shapes and of the plane, all of which every board runs.
inline constexpr uint32_t kWorldCrc32 = 0xF7F45C31;
/// Of frames by bricks, all of them and those that every board draws.
inline constexpr uint32_t kBrickCrc32 = 0xF64FCE9E;
inline constexpr uint32_t kCommonBrickCrc32 = 0xB9A37F48;
/// Of lit frames by bricks.
inline constexpr uint32_t kMapLightCrc32 = 0x72B3638C;

}  // namespace thimble::portable
