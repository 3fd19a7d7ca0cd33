# -mno-unaligned-access: the core takes unaligned words only once it is told to, and never of a device.
set(THIMBLE_ARCH_FLAGS -mcpu=${BOARD_CPU} -marm -mfloat-abi=soft -mno-unaligned-access)
