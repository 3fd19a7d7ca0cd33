# -mno-unaligned-access: the core takes unaligned words only where that is allowed, and never of a device.
set(THIMBLE_ARCH_FLAGS -mcpu=${BOARD_CPU} -marm -mfloat-abi=soft -mno-unaligned-access)
