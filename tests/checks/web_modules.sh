#!/bin/sh
# The page's modules, built as for the page, under Node: the pictures, states and cases are those of every board.
#   web_modules.sh ROOT THIMBLE      77 where a package of the page is missing
set -eu
cd "$1"
for what in node clang++-14 wasm-opt xz; do
  command -v "$what" >/dev/null 2>&1 || {
    echo "skipped: $what is not installed"
    exit 77
  }
done
[ -e /usr/lib/wasm32-wasi/libc++.a ] || {
  echo "skipped: libc++-14-dev-wasm32 is not installed"
  exit 77
}
sh platform/web/build.sh
mkdir -p build/web/tests
node tests/web/test_modules.js build/web/modules "$2"
