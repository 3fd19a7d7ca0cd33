#!/bin/sh
# The header for C compiles alone as C99 and newer, and as C++17, with every compiler that is installed, in every width;
# the handles are as large as they must be and no larger (tests/c/handle_sizes.cpp). c_header.sh ROOT
set -eu
cd "$1"
header=include/thimble/thimble_c.h
sizes=tests/c/handle_sizes.cpp
warnings='-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wundef -Wcast-align -Werror'
failed=0
if [ ! -f $header ]; then
  echo "c_header: there is no $header" >&2
  exit 1
fi
text() {
  echo '#include "thimble/thimble_c.h"'
  echo '#include "thimble/thimble_c.h"'
}
for flags in '' '-m32' '-mcpu=cortex-m0 -mthumb' '-march=rv32imac -misa-spec=2.2 -mabi=ilp32'; do
  case $flags in
    -mcpu*) compilers='arm-none-eabi-g' ;;
    -march*) compilers='riscv64-unknown-elf-g' ;;
    *) compilers='g clang' ;;
  esac
  for compiler in $compilers; do
    case $compiler in clang) c=clang cpp=clang++ ;; *) c=${compiler}cc cpp=${compiler}++ ;; esac
    if ! command -v $c >/dev/null 2>&1; then
      echo "skipped for $c: it is not installed"
      continue
    fi
    # shellcheck disable=SC2086
    for standard in c99 gnu99 c11; do
      text | $c -std=$standard -x c -fsyntax-only -ffreestanding $warnings -Wstrict-prototypes -Wmissing-prototypes $flags \
        -Iinclude - || { echo "c_header: $header does not compile alone with $c -std=$standard $flags" >&2 && failed=1; }
    done
    # shellcheck disable=SC2086
    text | $cpp -std=c++17 -x c++ -fsyntax-only -ffreestanding -nostdinc++ $warnings -Wold-style-cast $flags -Iinclude - ||
      { echo "c_header: $header does not compile alone with $cpp -std=c++17 $flags" >&2 && failed=1; }
    # shellcheck disable=SC2086
    [ ! -f $sizes ] || $cpp -std=c++17 -fsyntax-only -ffreestanding -nostdinc++ $warnings $flags -Iinclude -I. $sizes ||
      { echo "c_header: a handle has another size than its object wants with $cpp $flags" >&2 && failed=1; }
  done
done
exit $failed
