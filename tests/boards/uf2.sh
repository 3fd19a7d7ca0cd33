#!/bin/sh
# What is dragged onto a board's drive (platform/uf2): both images start from their files and draw the simulator's
# picture, and what the boot ROM refuses is refused.   uf2.sh BOARD, after board.sh has built it
set -eu
cd "$(dirname "$0")/../.."
board=$1
app=uf2
. tests/boards/emulated.sh
run() {
  status=0
  timeout 120 sh "$emulator/run.sh" "$(fact ICOUNT_SHIFT)" "$@" $(fact EMULATOR_OPTIONS) </dev/null >"$work/uf2.log" 2>"$work/uf2.said" || status=$?
}
# refused WHAT FILE SENTENCE
refused() {
  run "$2"
  if [ $status != 96 ] || [ -s "$work/uf2.log" ] || ! grep -q "$3" "$work/uf2.said"; then
    fail "$1: exit status $status, $(tail -n 1 "$work/uf2.said")"
  fi
}
# with OFFSET BYTE...: the image for flash with other bytes there (octal), as $work/other.uf2.
with() {
  offset=$1
  shift
  cp "$work/demo.uf2" "$work/other.uf2"
  printf "$@" | dd of="$work/other.uf2" bs=1 seek="$offset" conv=notrunc 2>/dev/null
}

FRAMES=2 EFFECTS=none builds demo demo
for place in flash RAM; do
  image=$work/demo.emulated.uf2
  [ $place = flash ] || image=$work/demo_ram.emulated.uf2
  run "$image" -v -shot "$work/uf2.ppm"
  if [ $status != 0 ] || ! grep -q "started from $place" "$work/uf2.said"; then
    fail "the image for $place: exit status $status, $(tail -n 1 "$work/uf2.said")"
  elif ! build/release/thimble sim demo --effects none --board "$board" --display none --frames 2 --check "$work/uf2.ppm" --quiet \
    >"$work/uf2.check" 2>&1; then
    fail "the image for $place draws another picture than the simulator: $(tail -n 1 "$work/uf2.check")"
  else
    say "the image for $place starts from its file and draws the simulator's picture"
  fi
done

# The first page is that of the second stage: bytes 32 to 287 of the file.
with 40 '\377'
refused "a byte of the second stage changed" "$work/other.uf2" 'wrong checksum'
with 284 '\0\0\0\0'
refused "no checksum" "$work/other.uf2" 'wrong checksum'
with 28 '\0'
refused "a block for another chip" "$work/other.uf2" 'blocks for the RP2040'
with 524 '\0\0\0\060'
refused "a block that lies elsewhere" "$work/other.uf2" 'outside'
dd if="$work/demo.uf2" of="$work/other.uf2" bs=512 count=9 2>/dev/null
refused "nine blocks of a file" "$work/other.uf2" '9 of '
: >"$work/other.uf2"
refused "an empty file" "$work/other.uf2" '0 of 0'
# Sectors come whole, and it can be made again of what is sealed.
[ $(($(wc -c <"$work/demo.uf2") % 8192)) = 0 ] || fail "the image for flash ends within a sector"
"$work/make_uf2" "$work/demo.elf" "$work/again.uf2" "$(fact UF2)" && cmp -s "$work/demo.uf2" "$work/again.uf2" ||
  fail "made of a sealed image it is another"
# make_uf2 reads what a linker left.
for bytes in '' 'text' '\177ELF\001\001'; do
  printf "$bytes" >"$work/other.elf"
  ! "$work/make_uf2" "$work/other.elf" "$work/other.uf2" E48BFF56 2>/dev/null || fail "make_uf2 takes '$bytes' for an image"
done
head -c 3000 "$work/demo.elf" >"$work/other.elf"
! "$work/make_uf2" "$work/other.elf" "$work/other.uf2" E48BFF56 2>/dev/null || fail "make_uf2 takes half an image"
! "$work/make_uf2" "$work/demo.elf" "$work/other.uf2" pico 2>/dev/null || fail "make_uf2 takes 'pico' for a family"
[ $failed = 1 ] || say "other checksums, chips, places and parts of a file are refused"

# Onto the drive, here a folder.
mkdir -p "$work/drive"
if ! THIMBLE_DRIVE=$work/drive sh platform/flash.sh "$board" demo >/dev/null || ! cmp -s "$work/drive/thimble.uf2" "$work/demo.uf2"; then
  fail "flash.sh does not copy the image onto the drive"
elif ! THIMBLE_DRIVE=$work/drive PLACE=ram sh platform/flash.sh "$board" demo >/dev/null ||
  ! cmp -s "$work/drive/thimble.uf2" "$work/demo_ram.uf2"; then
  fail "flash.sh does not copy the image for RAM onto the drive"
elif sh platform/flash.sh "$board" demo >/dev/null 2>"$work/uf2.said" || ! grep -q 'BOOTSEL' "$work/uf2.said"; then
  fail "without a drive flash.sh says: $(cat "$work/uf2.said")"
else
  say "make flash copies it onto the drive, or says how"
fi
exit $failed
