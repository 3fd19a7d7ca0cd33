set(BOARD_TITLE "Game Boy Advance (ARM7TDMI)")
set(BOARD_ARCH arm7)
set(BOARD_CPU arm7tdmi)
set(BOARD_FLASH_ORIGIN 0x08000000)
set(BOARD_FLASH_BYTES 33554432)
set(BOARD_RAM_ORIGIN 0x02000000)
set(BOARD_RAM_BYTES 262144)
# The core's own RAM: 32 KiB but for the 256 bytes at its end that the boot ROM uses. The stack lies there, and ARM code
# that draws.
set(BOARD_FAST_RAM_ORIGIN 0x03000000)
set(BOARD_FAST_RAM_BYTES 32512)
set(BOARD_FAST_SOURCES src/picture/brick_render.cpp src/tree/brick_map.cpp platform/boards/gba/board.cpp)
# By parts of their mangled names, with the constants of that name; with .o, an object of a library. What saves most cycles
# a byte in pictures of the valley.
set(BOARD_FAST_FUNCTIONS sweep_tile draw_layer draw_cell draw_face 6decide find_half_plane set_all find_direction
  find_exposed 5kRows kAllPixels kNoPixels store_pixels store_wholeIt look_up mixed_material 14voxel_material
  material_ink 6ink_of Inks6forget 9draw_tile far_slab 11trace_mixed 6answer set_start
  3FanC slope_of first_slab 10set_course trace_one trace_any_quad widen_pixelsILj2E board5flush 11flush_again memset memcpy
  libgcc.a:_udivsi3.o libgcc.a:_clzsi2.o)
# The tests' bound is 6,672; what is left holds code.
set(BOARD_STACK_BYTES 6688)
set(BOARD_DISPLAY plain)
set(BOARD_WIDTH_PX 240)
set(BOARD_HEIGHT_PX 160)
set(BOARD_FORMAT bgr565)
set(BOARD_FLUSHES_AGAIN yes)
# The display has 15 bits a pixel: the lowest bit of green is not shown.
set(BOARD_SHOWN_BITS 5)
set(BOARD_BUTTONS 5)
set(BOARD_QEMU "")
set(BOARD_EMULATOR mgba)
set(BOARD_IMAGE gba)
set(BOARD_PROBE copy GBA thimble.gba)
set(BOARD_CLOCK_MHZ 17)
set(BOARD_ICOUNT_SHIFT 6)
set(BOARD_VISITS_A_SECOND 7500)
set(BOARD_MAP_RAYS_A_SECOND 12500)
set(BOARD_FRAME_INSTRUCTIONS 16714013)
set(BOARD_HOLDS_FPS 10)
# No memory protection, and the boot ROM's handlers say nothing: a write past the RAM meets its mirror, and after a stack that
# overflows or a jump into nonsense the core runs on, somewhere.
set(BOARD_CATCHES scene)
set(BOARD_GOES_ASTRAY stack nonsense)
