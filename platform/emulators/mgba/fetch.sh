#!/bin/sh
# Compiles emulate.cpp where run.sh looks for it, if it is not there yet. Exit status 77, with a sentence: not here.
set -eu
cd "$(dirname "$0")/../../.."
source=platform/emulators/mgba/emulate.cpp
work=${THIMBLE_EMULATORS:-build/emulators}/mgba
for file in /usr/include/mgba/core/core.h /usr/include/nlohmann/json.hpp; do
  if [ ! -f $file ]; then
    echo "the Game Boy Advance's emulator wants $file, which is not there (Debian: apt-get install libmgba-dev nlohmann-json3-dev)"
    exit 77
  fi
done
if [ -x "$work/emulate" ] && cmp -s $source "$work/emulate.cpp"; then
  exit 0
fi
mkdir -p "$work"
cp $source "$work/emulate.cpp"
if ! "${CXX:-c++}" -std=c++20 -O1 -o "$work/emulate.new" "$work/emulate.cpp" -lmgba >"$work.log" 2>&1; then
  rm -f "$work/emulate.cpp"
  echo "the Game Boy Advance's emulator does not compile: $(grep -i 'error' "$work.log" | head -n 1)"
  exit 77
fi
mv "$work/emulate.new" "$work/emulate"
