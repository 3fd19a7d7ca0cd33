/// CRC-32 of every golden frame (scenes.h). Written by `thimble_golden_tests --print`.
#pragma once

#include <stdint.h>

namespace thimble::golden {

struct GoldenEntry {
  const char* name;
  uint32_t crc32;
};

inline constexpr GoldenEntry kGoldenTable[] = {
    {"empty_depth_rgb888", 0xF1FB72B8},
    {"empty_mono_mono1", 0xE38A6876},
    {"full_depth_gray8", 0x582A1AFA},
    {"full_normal_rgb888_diagonal", 0x47D30683},
    {"full_color_rgb565_5_worlds_away", 0xC409BAFD},
    {"full_normal_rgb888_inside", 0x54CC403E},
    {"full_depth_gray8_inside", 0x9870782D},
    {"spheres_depth_mono1", 0x3712F3EB},
    {"spheres_depth_gray4", 0xA5EB0D3B},
    {"spheres_depth_gray8", 0x551E814C},
    {"spheres_depth_rgb565", 0x864F0E53},
    {"spheres_depth_rgb888", 0x455D6B41},
    {"spheres_normal_rgb888", 0x70868AC4},
    {"spheres_color_rgb888", 0xCE2CE6A7},
    {"spheres_mono_mono1", 0xDC41528E},
    {"spheres_parallel_depth_gray8", 0x9C01477E},
    {"spheres_parallel_color_rgb565", 0xE598C482},
    {"spheres_depth_gray8_8_bits", 0x5A51F22E},
    {"spheres_depth_gray8_20_bits", 0x9680C08C},
    {"many_spheres_color_rgb888", 0x39F217A1},
    {"many_spheres_depth_mono1_128x64", 0xA99D08CA},
    {"many_spheres_parallel_normal_rgb565", 0x564C4B4A},
    {"few_points_color_rgb888", 0xEFC32F7C},
    {"few_points_parallel_mono_mono1", 0x6394E378},
    {"points_depth_gray4", 0x3B791E27},
    {"points_color_rgb565_inside", 0x71CC2668},
    {"points_parallel_mono_mono1_128x64", 0x30B29C41},
    {"shell_depth_gray8_inside", 0x1E8B27E6},
    {"shell_normal_rgb888_inside", 0x2CA1817B},
    {"shell_parallel_depth_gray4", 0x3989EE64},
    {"checkerboard_parallel_normal_rgb888_diagonal", 0xD490BF0F},
    {"checkerboard_parallel_color_rgb888_in_planes", 0xE497431C},
    {"checkerboard_color_rgb888_at_corner", 0xB3AF443A},
    {"checkerboard_normal_rgb888_inside", 0xF1DEDB8C},
    {"coarsened_depth_gray8", 0x98813A16},
    {"coarsened_color_rgb888", 0x5713EF2A},
    {"coarsened_parallel_normal_rgb565", 0xF49D8BEC},
    {"corners_color_rgb888_lowest", 0xBA6FB10F},
    {"corners_color_rgb888_highest", 0xDA2E5FFC},
    {"corners_parallel_normal_rgb888", 0x19167336},
    {"marks_color_rgb888", 0xFCA8B343},
    {"marks_parallel_color_rgb888_from_above", 0x002CDFB1},
    {"marks_normal_rgb565_tilted", 0xD3EEDE7A},
    {"marks_depth_rgb888_one_row", 0xD6B29D8C},
};

}  // namespace thimble::golden
