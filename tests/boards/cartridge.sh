#!/bin/sh
# The header of a cartridge: no byte of Nintendo's picture in it, and a wrong checksum is refused.
#   cartridge.sh BOARD, after board.sh has built it
set -eu
cd "$(dirname "$0")/../.."
board=$1
. platform/board_facts.sh
work=${THIMBLE_FIRMWARE:-build/boards}/$board
failed=0
fail() {
  printf '%-18s %-10s FAILED: %s\n' "$board" header "$1"
  failed=1
}
if ! why=$(sh "platform/emulators/$(fact EMULATOR)/fetch.sh"); then
  printf '%-18s %-10s skipped: %s\n' "$board" header "$why"
  exit 0
fi
[ "$(head -c 160 "$work/demo.gba" | tail -c 156 | tr -d '\0' | wc -c)" = 0 ] || fail "the picture is not zero"
for offset in 160 178 189; do
  cp "$work/demo.gba" "$work/other.gba"
  printf '\001' | dd of="$work/other.gba" bs=1 seek=$offset conv=notrunc 2>/dev/null
  status=0
  sh "platform/emulators/$(fact EMULATOR)/run.sh" 0 "$work/other.gba" </dev/null >/dev/null 2>"$work/other.said" || status=$?
  { [ $status = 96 ] && grep -q 'wrong checksum' "$work/other.said"; } || fail "byte $offset changed: exit status $status"
done
[ $failed = 1 ] || printf '%-18s %-10s its picture is zero; other checksums are refused\n' "$board" header
exit $failed
