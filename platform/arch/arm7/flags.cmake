# Thumb, which is half the bytes over a narrow bus; BOARD_FAST_SOURCES are ARM code in the core's own RAM. Armv4T returns to
# the other kind of code only by BX.
set(THIMBLE_ARCH_FLAGS -mcpu=${BOARD_CPU} -mthumb -mthumb-interwork -mfloat-abi=soft)
# Passes that keep more values alive than there are registers for: without them a frame takes 6 per cent less, and the code
# 1.5 KB. Loops that set an array stay loops: a call of memset takes longer.
set(THIMBLE_FAST_FLAGS -marm -fno-tree-pre -fno-gcse -fno-tree-fre -fno-tree-loop-im -fno-move-loop-invariants
  -fno-if-conversion -fno-tree-reassoc -fno-ssa-phiopt -fno-tree-loop-distribute-patterns)
