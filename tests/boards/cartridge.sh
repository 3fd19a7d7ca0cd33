#!/bin/sh
# The header of a cartridge: no byte of Nintendo's picture in it, and a wrong checksum is refused.
#   cartridge.sh BOARD, after board.sh has built it
set -eu
cd "$(dirname "$0")/../.."
board=$1
app=header
. tests/boards/emulated.sh
[ "$(head -c 160 "$work/demo.gba" | tail -c 156 | tr -d '\0' | wc -c)" = 0 ] || fail "the picture is not zero"
for offset in 160 178 189; do
  cp "$work/demo.gba" "$work/other.gba"
  printf '\001' | dd of="$work/other.gba" bs=1 seek=$offset conv=notrunc 2>/dev/null
  status=0
  sh "$emulator/run.sh" 0 "$work/other.gba" </dev/null >/dev/null 2>"$work/other.said" || status=$?
  { [ $status = 96 ] && grep -q 'wrong checksum' "$work/other.said"; } || fail "byte $offset changed: exit status $status"
done
ends "its picture is zero; other checksums are refused"
