# As the pico, which runs all tests of the chip and its code, but for the display and its keys.
include(${CMAKE_CURRENT_LIST_DIR}/../pico/board.cmake)
set(BOARD_TITLE "Raspberry Pi Pico (RP2040, Cortex-M0+) with a Pico-LCD-2")
set(BOARD_WIDTH_PX 320)
set(BOARD_BUTTONS 4)
# KEY0 to KEY3 (Waveshare's wiki).
set(BOARD_KEYS 15 kUp 17 kDown 2 kLeft 3 kRight)
set(BOARD_EMULATOR_OPTIONS "-carrier pico-lcd-2")
set(BOARD_FRAME_INSTRUCTIONS 15968000)
set(BOARD_HOLDS_FPS 25)
set(BOARD_TESTS "demo bench")
