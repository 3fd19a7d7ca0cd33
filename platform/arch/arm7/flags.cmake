# Thumb, which is half the bytes over a narrow bus; BOARD_FAST_SOURCES are ARM code in the core's own RAM. Armv4T returns to
# the other kind of code only by BX.
set(THIMBLE_ARCH_FLAGS -mcpu=${BOARD_CPU} -mthumb -mthumb-interwork -mfloat-abi=soft)
# Partial redundancy elimination keeps more values than there are registers: 2 per cent of a frame.
set(THIMBLE_FAST_FLAGS -marm -fno-tree-pre)
