#!/bin/sh
# All of src also compiles as one translation unit, as those build it who copy a library into one file: no two files
# give one name to two things. By two compilers, and for chips and machines where other types are one: size_t and
# uint32_t are on some of those of 32 bits, on others they are not. one_unit.sh ROOT
set -eu
cd "$1"
flags='-std=c++17 -ffreestanding -fno-exceptions -fno-rtti -fno-threadsafe-statics -Wall -Wextra -Wpedantic -Wconversion
  -Wsign-conversion -Wshadow -Wundef -Wcast-align -Wnon-virtual-dtor -Woverloaded-virtual -Wdouble-promotion -Wformat=2
  -Werror -DTHIMBLE_DEEP_WORLDS -Iinclude -I. -x c++'
failed=0
for compiler in g++ clang++ arm-none-eabi-g++ arm-linux-gnueabihf-g++ 'clang++ --target=armv6m-none-eabi' \
  'clang++ --target=armv7m-none-eabi'; do
  if ! command -v "${compiler%% *}" >/dev/null 2>&1; then
    echo "skipped for $compiler: it is not installed"
    continue
  fi
  if ! find src -name '*.cpp' | sort | sed 's/.*/#include "&"/' | $compiler $flags -fsyntax-only -; then
    echo "one_unit: src does not compile as one translation unit with $compiler" >&2
    failed=1
  fi
done
exit $failed
