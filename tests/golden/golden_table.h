/// @file golden_table.h
/// CRC-32 of every golden frame (scenes.h). Written by `thimble_golden_tests --print`.
#ifndef THIMBLE_TESTS_GOLDEN_GOLDEN_TABLE_H
#define THIMBLE_TESTS_GOLDEN_GOLDEN_TABLE_H

#include <stdint.h>

namespace thimble::golden {

struct GoldenEntry {
  const char* name;
  uint32_t crc32;
};

inline constexpr GoldenEntry kGoldenTable[] = {
    {"empty_depth_rgb888", 0xF1FB72B8},
    {"empty_mono_mono1", 0xA8829A9D},
    {"full_depth_gray8", 0x582A1AFA},
    {"full_normal_rgb888_diagonal", 0x47D30683},
    {"full_color_rgb565_5_worlds_away", 0xC409BAFD},
    {"full_normal_rgb888_inside", 0x54CC403E},
    {"full_depth_gray8_inside", 0x9870782D},
    {"spheres_depth_mono1", 0xF18E06FB},
    {"spheres_depth_gray4", 0x1A1A74BA},
    {"spheres_depth_gray8", 0xC4097D28},
    {"spheres_depth_rgb565", 0x23553641},
    {"spheres_depth_rgb888", 0xF5640263},
    {"spheres_normal_rgb888", 0xB201F57F},
    {"spheres_color_rgb888", 0xA2858F66},
    {"spheres_mono_mono1", 0x5FC649FD},
    {"spheres_parallel_depth_gray8", 0x9C01477E},
    {"spheres_parallel_color_rgb565", 0xE598C482},
    {"spheres_depth_gray8_8_bits", 0xDEB7845C},
    {"spheres_depth_gray8_20_bits", 0xA802C0B8},
    {"many_spheres_color_rgb888", 0x3E463067},
    {"many_spheres_depth_mono1_128x64", 0x6A5FBA6F},
    {"many_spheres_parallel_normal_rgb565", 0x564C4B4A},
    {"few_points_color_rgb888", 0xA8CDD674},
    {"few_points_parallel_mono_mono1", 0x3258E374},
    {"points_depth_gray4", 0xF83FC6FF},
    {"points_color_rgb565_inside", 0x71CC2668},
    {"points_parallel_mono_mono1_128x64", 0x8ACDBF9F},
    {"shell_depth_gray8_inside", 0x1E8B27E6},
    {"shell_normal_rgb888_inside", 0x2CA1817B},
    {"shell_parallel_depth_gray4", 0x3989EE64},
    {"checkerboard_parallel_normal_rgb888_diagonal", 0xD490BF0F},
    {"checkerboard_parallel_color_rgb888_in_planes", 0xE497431C},
    {"checkerboard_color_rgb888_at_corner", 0xB3AF443A},
    {"checkerboard_normal_rgb888_inside", 0xF1DEDB8C},
    {"coarsened_depth_gray8", 0x4CE2FED9},
    {"coarsened_color_rgb888", 0x596CB8C8},
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

#endif
