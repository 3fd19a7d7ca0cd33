# What boards share that have no display: the picture that they draw and send over the UART.
set(BOARD_DISPLAY none)
set(BOARD_WIDTH_PX 128)
set(BOARD_HEIGHT_PX 64)
set(BOARD_FORMAT gray4)
set(BOARD_FRAMES small)
set(BOARD_BUTTONS 0)
