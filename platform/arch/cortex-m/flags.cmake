# What the compiler must know about the board's core.
set(THIMBLE_ARCH_FLAGS -mcpu=${BOARD_CPU} -mthumb)
