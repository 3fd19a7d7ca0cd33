#!/bin/sh
# The public headers compile after an Arduino core's macros (arduino_macros.h), with every compiler that is installed.
# arduino.sh ROOT
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$1"
flags='-fsyntax-only -Wall -Wextra -Wpedantic -Werror -fno-exceptions -fno-rtti -ffreestanding -nostdinc++ -Iinclude -x c++'
failed=0
text() {
  echo "#include \"$here/arduino_macros.h\""
  sh "$here/binary_macros.sh"
  find include/thimble -name '*.h' | sort | sed 's|^include/\(.*\)|#include "\1"|'
}
for compiler in g++ clang++ arm-none-eabi-g++ riscv64-unknown-elf-g++; do
  if ! command -v $compiler >/dev/null 2>&1; then
    echo "skipped for $compiler: it is not installed"
    continue
  fi
  for standard in c++17 gnu++17; do
    if ! text | $compiler -std=$standard $flags -; then
      echo "arduino: the public headers do not compile after Arduino's macros with $compiler -std=$standard" >&2
      failed=1
    fi
  done
done
exit $failed
