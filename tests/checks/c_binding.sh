#!/bin/sh
# A foreign language can use the C face: Python's ctypes, which knows nothing but what thimble_c.h says, draws a baked scene
# and picks a voxel as a program in C does; with a header that is wrong in one word it does not.
# c_binding.sh ROOT WORK_DIR THIMBLE LIBTHIMBLE
set -eu
mkdir -p "$2"
work=$(cd "$2" && pwd)
thimble=$3
library=$4
cd "$1"
command -v python3 >/dev/null 2>&1 || {
  echo "skipped: python3 is not installed"
  exit 77
}
header=include/thimble/thimble_c.h
for ending in h oct; do
  "$thimble" bake tools/gallery/scenes/castle.vox --size 128x64 --effects none --quiet -o "$work/scene.$ending" 2>/dev/null
done
gcc -std=c99 -Wall -Wextra -Wpedantic -Werror -Iinclude -I"$work" -c tests/c/binding.c -o "$work/binding.o"
g++ "$work/binding.o" "$library" -o "$work/in_c"
"$work/in_c" >"$work/in_c.txt"
# The shared object, by the line of the page.
line=$(sed -n 's/^    \(g++ -shared .*\)/\1/p' src/c/README.md)
case $line in
  *\ build/release/libthimble.a\ *\ libthimble.so) ;;
  *) echo "c_binding: src/c/README.md has no line that makes libthimble.so of build/release/libthimble.a" >&2 && exit 1 ;;
esac
line=${line% libthimble.so}
${line%% build/release/libthimble.a *} "$library" ${line#* build/release/libthimble.a } "$work/libthimble.so"
draw() {
  python3 -B tests/c/binding.py "$1" "$work/libthimble.so" "$work/scene.oct" >"$work/in_python.txt" 2>"$work/said" &&
    cmp -s "$work/in_c.txt" "$work/in_python.txt"
}
draw $header || {
  cat "$work/in_python.txt" "$work/said" >&2
  echo "c_binding: Python draws another picture than C, $(tr '\n' ' ' <"$work/in_c.txt")" >&2
  exit 1
}
echo "c_binding: $(cat "$work/said"); the picture of C: $(head -n 1 "$work/in_c.txt")"
for wrong in 's/THIMBLE_FORMAT_GRAY4 = 1/THIMBLE_FORMAT_GRAY4 = 9/' 's/^  int32_t axis;/  int64_t axis;/' \
  's/int32_t thimble_scene_open(/int32_t thimble_scene_opened(/' 's/const thimble_shading_t\* shading, const thimble_band_t/const thimble_band_t/'; do
  sed "$wrong" $header >"$work/wrong.h"
  ! cmp -s $header "$work/wrong.h" || { echo "c_binding: $wrong changes nothing" >&2 && exit 1; }
  ! draw "$work/wrong.h" || { echo "c_binding: a header with $wrong is taken" >&2 && exit 1; }
done
