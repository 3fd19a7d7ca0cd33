#!/bin/sh
# Builds the page into build/web/thimble.html: build.sh
set -eu
cd "$(dirname "$0")/../.."
work=build/web/modules
if [ ! -f "$work/build.ninja" ]; then
  cmake -S platform/web -B "$work" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$PWD/platform/web/toolchain.cmake" \
    --log-level=WARNING -Wno-dev >/dev/null
fi
.ci/build "WebAssembly" "$work"
node platform/web/bundle.js "$work" . build/web/thimble.html
node platform/web/bundle_share.js "$work" build/web/share.html
