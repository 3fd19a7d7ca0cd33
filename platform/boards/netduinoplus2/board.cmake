set(BOARD_TITLE "Netduino Plus 2 (STM32F405, Cortex-M4F)")
set(BOARD_ARCH cortex-m)
set(BOARD_CPU cortex-m4)
set(BOARD_FLASH_ORIGIN 0x08000000)
set(BOARD_FLASH_BYTES 1048576)
# The first sectors are smaller; a program ends behind them.
set(BOARD_ERASE_BYTES 131072)
# SRAM1 and SRAM2 in one piece (STM32F405 data sheet, memory map). 64 KiB more at 0x10000000 (CCM) lie apart, and QEMU before
# 10 has no memory there: nothing is put into them.
set(BOARD_RAM_ORIGIN 0x20000000)
set(BOARD_RAM_BYTES 131072)
set(BOARD_STACK_BYTES 4096)
include(${CMAKE_CURRENT_LIST_DIR}/../no_display.cmake)
set(BOARD_UART stm32_usart 0x40011400)
# USART6 is the sixth serial port of this machine.
set(BOARD_QEMU qemu-system-arm -M netduinoplus2 -serial null -serial null -serial null -serial null -serial null)
set(BOARD_PROBE st-flash 0x08000000)
set(BOARD_CLOCK_MHZ 168)
set(BOARD_ICOUNT_SHIFT 6)
set(BOARD_VISITS_A_SECOND 329000)
set(BOARD_FRAME_INSTRUCTIONS 2916424)
set(BOARD_CATCHES stack ram flash nonsense scene)
