#!/bin/sh
# Each public header compiles on its own as C++17, with gcc and clang, with and without a C++ library; all of them
# together as GNU's C++17 and as C++20. headers.sh ROOT
set -eu
cd "$1"
flags='-fsyntax-only -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wundef -Werror -fno-exceptions
  -fno-rtti -Iinclude -x c++'
failed=0
headers=$(find include/thimble -name '*.h' 2>/dev/null | sort)
if [ -z "$headers" ]; then
  echo "headers: there are no public headers in include/thimble" >&2
  exit 1
fi
include() {
  for header in "$@"; do
    echo "#include \"${header#include/}\""
  done
}
for compiler in g++ clang++; do
  if ! command -v $compiler >/dev/null 2>&1; then
    echo "skipped for $compiler: it is not installed"
    continue
  fi
  for header in $headers; do
    for mode in "" "-nostdinc++" "-nostdinc++ -ffreestanding"; do
      if ! include "$header" | $compiler -std=c++17 $flags $mode -; then
        echo "headers: $header does not compile alone with $compiler $mode" >&2
        failed=1
      fi
    done
  done
  for standard in gnu++17 c++20; do
    if ! include $headers | $compiler -std=$standard $flags -; then
      echo "headers: they do not compile together with $compiler -std=$standard" >&2
      failed=1
    fi
  done
done
exit $failed
