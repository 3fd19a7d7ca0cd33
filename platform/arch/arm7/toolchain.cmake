# Cross compiling for Arm's ARM7TDMI with the compiler of the Cortex-M boards.
include(${CMAKE_CURRENT_LIST_DIR}/../cortex-m/toolchain.cmake)
