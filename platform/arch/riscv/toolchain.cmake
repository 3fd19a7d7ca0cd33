# Cross compiling for bare RISC-V with Debian's gcc-riscv64-unknown-elf, which has no C++ headers.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR riscv)
set(CMAKE_CXX_COMPILER riscv64-unknown-elf-g++)
set(CMAKE_OBJCOPY riscv64-unknown-elf-objcopy)
set(THIMBLE_BINUTILS_PREFIX riscv64-unknown-elf-)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
