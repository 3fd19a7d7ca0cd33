#!/bin/sh
# Each public header compiles on its own, with gcc and clang, with and without a C++ library. headers.sh ROOT
set -eu
cd "$1"
flags='-std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wundef -Werror
  -fno-exceptions -fno-rtti -Iinclude -x c++'
failed=0
found=0
for header in $(find include/thimble -name '*.h' | sort); do
  [ -e "$header" ] || continue
  found=1
  for compiler in g++ clang++; do
    if ! command -v $compiler >/dev/null 2>&1; then
      echo "skipped for $compiler: it is not installed"
      continue
    fi
    for mode in "" "-nostdinc++" "-nostdinc++ -ffreestanding"; do
      if ! echo "#include \"${header#include/}\"" | $compiler $flags $mode -; then
        echo "headers: $header does not compile alone with $compiler $mode" >&2
        failed=1
      fi
    done
  done
done
if [ $found = 0 ]; then
  echo "headers: there are no public headers in include/thimble" >&2
  exit 1
fi
exit $failed
