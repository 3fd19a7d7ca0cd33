#!/bin/sh
# platform/example as somebody else would build it, with their own flags: on this machine, where its picture must be the
# command's own, and for Cortex-M0 and RV32. example.sh WORK_DIR
set -eu
cd "$(dirname "$0")/../.."
work=$1
mkdir -p "$work"
core='-std=c++20 -ffreestanding -fno-exceptions -fno-rtti -fno-threadsafe-statics -ffunction-sections -fdata-sections -Iinclude'
thimble=build/release/thimble
fail() {
  echo "example: FAILED: $1" >&2
  exit 1
}
lines=$(grep -c . platform/example/voxel_view.cpp)
[ "$lines" -le 45 ] || fail "it has grown to $lines lines"
"$thimble" bake demo --size 128x64 -o "$work/scene.h" --quiet 2>/dev/null
"$thimble" bake demo --size 128x64 -o "$work/scene.oct" --quiet 2>/dev/null

# The colours here are the command's; a display of 16 greys is within half a step of its 256.
g++ $core -O2 -Wall -Wextra -Werror -c -I"$work" platform/example/voxel_view.cpp -o "$work/voxel_view.o"
g++ -std=c++20 -O2 -Iinclude -ffreestanding -o "$work/example" "$work/voxel_view.o" tests/boards/example_display.cpp $(find src -name "*.cpp")
"$work/example" >"$work/example.pgm" || fail "it does not draw"
"$thimble" render "$work/scene.oct" --size 128x64 --shade color -o "$work/command.pgm" --quiet 2>/dev/null || fail "the command does not draw"
cmp -l "$work/example.pgm" "$work/command.pgm" | awk '
  function octal(text,   i, value) { for (i = 1; i <= length(text); i++) { value = value * 8 + substr(text, i, 1) } return value }
  { difference = octal($2) - octal($3); if (difference < -9 || difference > 9) { worse++ } }
  END { if (worse > 0) { print worse " pixels differ by more than half a grey"; exit 1 } }' >&2 || fail "its picture is not the command's"

for target in cortex-m0 rv32; do
  case $target in
    cortex-m0) prefix=arm-none-eabi- flags='-mcpu=cortex-m0 -mthumb' ;;
    rv32) prefix=riscv64-unknown-elf- flags='-march=rv32imac -misa-spec=2.2 -mabi=ilp32' ;;
  esac
  ${prefix}g++ $core $flags -Os -Wall -Wextra -Werror -nostdinc++ -I"$work" -c platform/example/voxel_view.cpp \
    -o "$work/voxel_view_$target.o" || fail "it does not compile for $target"
done
echo "example: $lines lines, draws the command's picture, compiles for cortex-m0 and rv32"
