#!/bin/sh
# What frames of several scenes take on boards that QEMU has: tests/budgets/scene_frames.csv, with which `thimble boards` is
# compared.   scene_frames.sh [--write]     --write makes the table anew; else what takes one per cent more fails
# Each board's bench is built once, and the scenes are put behind it (platform/images).
set -eu
cd "$(dirname "$0")/../.."
table=tests/budgets/scene_frames.csv
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}/scene-frames" PLACE=flash MEASURED=ON
work=$PWD/$THIMBLE_FIRMWARE
thimble=build/release/thimble
. tests/boards/three_digits.sh
mkdir -p "$work/programs"
app=frames
. tests/boards/say.sh
printf 'yes!' >"$work/yes"
"$thimble" bake demo,depth=4 --board lm3s6965evb --effects none --quiet -o "$work/small.h"
for board in $(sed '/^#/d; /^board/d; s/;.*//' $table | sort -u); do
  WITHIN=0 builds bench "$work/small.h" >&2
  objcopy=arm-none-eabi-objcopy
  [ "$board" != sifive_e ] || objcopy=riscv64-unknown-elf-objcopy
  # `thimble image` knows applications that show scenes; for emulators this one is to tell its exit status.
  $objcopy --update-section ".semihosting=$work/yes" "$work/$board/bench.elf" "$work/programs/$board-demo-plain.elf"
  gzip -9nf "$work/programs/$board-demo-plain.elf"
  for scene in $(sed -n "s/^$board;\([^;]*\);.*/\1/p" $table); do
    "$thimble" image "$scene" --board "$board" --effects none --images "$work/programs" -o "$work/$board/bench.emulated.elf" --quiet
    timeout 300 sh platform/emulate.sh "$board" bench </dev/null >"$work/bench.log" 2>/dev/null || true
    cost=$(awk -F, "$three_digits"'$1 == "brick_map.instructions_median" { print three_digits($2) }' "$work/bench.log")
    echo "$board;$scene;$cost"
    most=$(grep -F "$board;$scene;" $table | cut -d ';' -f 3)
    if [ -z "$cost" ] || [ "$cost" -gt $((most + most / 100)) ]; then
      fail "a frame of $scene takes ${cost:-no} instructions, $table says $most" >&2
    fi
  done
done >"$work/measured"
if [ "${1:-}" = --write ]; then
  grep '^#\|^board;' $table | cat - "$work/measured" >"$work/table"
  mv "$work/table" $table
  failed=0
fi
echo "scene frames: $(wc -l <"$work/measured") measured"
exit $failed
