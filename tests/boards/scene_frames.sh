#!/bin/sh
# What frames of several scenes take on a board that QEMU has: tests/budgets/scene_frames.csv, with which `thimble boards` is
# compared.   scene_frames.sh [--write] [BOARD...]     --write makes the rows anew; else what takes one per cent more fails
# A board's bench is built once, where board.sh has compiled the core, and the scenes are put behind it (platform/images).
set -eu
cd "$(dirname "$0")/../.."
table=tests/budgets/scene_frames.csv
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}" PLACE=flash MEASURED=ON
thimble=build/release/thimble
. tests/boards/three_digits.sh
app=frames
. tests/boards/say.sh
write=0
if [ "${1:-}" = --write ]; then
  write=1
  shift
fi
[ $# != 0 ] || set -- $(sed '/^#/d; /^board/d; s/;.*//' $table | sort -u)
for board in "$@"; do
  work=$PWD/$THIMBLE_FIRMWARE/$board
  mkdir -p "$work/programs"
  printf 'yes!' >"$work/yes"
  "$thimble" bake demo,depth=4 --board lm3s6965evb --effects none --quiet -o "$work/small.h"
  WITHIN=0 builds bench "$work/small.h"
  objcopy=arm-none-eabi-objcopy
  [ "$board" != sifive_e ] || objcopy=riscv64-unknown-elf-objcopy
  # `thimble image` knows applications that show scenes; for emulators this one is to tell its exit status.
  $objcopy --update-section ".semihosting=$work/yes" "$work/bench.elf" "$work/programs/$board-demo-plain.elf"
  gzip -9nf "$work/programs/$board-demo-plain.elf"
  : >"$work/measured"
  for scene in $(sed -n "s/^$board;\([^;]*\);.*/\1/p" $table); do
    "$thimble" image "$scene" --board "$board" --effects none --images "$work/programs" -o "$work/bench.emulated.elf" --quiet
    timeout 300 sh platform/emulate.sh "$board" bench </dev/null >"$work/scene_frame.log" 2>/dev/null || true
    cost=$(awk -F, "$three_digits"'$1 == "brick_map.instructions_median" { print three_digits($2) }' "$work/scene_frame.log")
    echo "$board;$scene;$cost" >>"$work/measured"
    most=$(grep -F "$board;$scene;" $table | cut -d ';' -f 3)
    if [ $write = 0 ] && { [ -z "$cost" ] || [ "$cost" -gt $((most + most / 100)) ]; }; then
      fail "a frame of $scene takes ${cost:-no} instructions, $table says $most"
    fi
  done
  if [ $write = 1 ]; then
    awk -F ';' 'NR == FNR { new[$1, $2] = $0; next } ($1, $2) in new { $0 = new[$1, $2] } { print }' "$work/measured" $table >"$work/table"
    mv "$work/table" $table
  fi
  say "$(wc -l <"$work/measured") scenes measured"
done
exit $failed
