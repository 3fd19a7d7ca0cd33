#!/bin/sh
# What flash.sh does with a board's drive, here a folder: an image that DAPLink refuses (FAIL.TXT) is a failure, and a
# kernel.img that was there is kept.      flash.sh WORK
set -eu
cd "$(dirname "$0")/../.."
mkdir -p "$1"
work=$(cd "$1" && pwd)
app=flash
. tests/boards/say.sh
# flash: writes $board's demo onto the drive. Sets `status` and `said`.
flash() {
  status=0
  THIMBLE_FIRMWARE=$work THIMBLE_DRIVE=$work/drive THIMBLE_DRIVE_S=${1:-10} sh platform/flash.sh "$board" demo >"$work/said" 2>&1 || status=$?
  said=$(tr '\n' ' ' <"$work/said")
}
# new_drive FILE=TEXT...: an empty drive with these files, and an image of $board.
new_drive() {
  rm -rf "$work/drive" "${work:?}/$board"
  mkdir -p "$work/drive" "$work/$board"
  for ending in elf hex bin; do
    echo "image $ending" >"$work/$board/demo.$ending"
  done
  for file; do
    echo "${file#*=}" >"$work/drive/${file%%=*}"
  done
}
# come_back [TEXT]: in the background, what DAPLink does when it has the file: it is away, then without the file, with
# FAIL.TXT or none.
come_back() {
  (
    for i in $(seq 100); do
      [ ! -f "$work/drive/thimble.hex" ] || break
      sleep 0.1
    done
    rm -f "$work/drive/DETAILS.TXT" "$work/drive/FAIL.TXT"
    sleep 0.3
    rm -f "$work/drive/thimble.hex"
    [ -z "${1:-}" ] || printf 'error: %s\r\ntype: target\r\n' "$1" >"$work/drive/FAIL.TXT"
    echo DAPLink >"$work/drive/DETAILS.TXT"
  ) &
}

board=microbit
new_drive DETAILS.TXT=DAPLink
come_back "The hex file is not for this board"
flash
wait
case $status$said in
  1*"not for this board"*) ;;
  *) fail "FAIL.TXT came: exit status $status, $said" ;;
esac
# Of the time before, and gone now.
new_drive DETAILS.TXT=DAPLink "FAIL.TXT=error: of yesterday"
come_back
flash
wait
[ $status = 0 ] || fail "FAIL.TXT went: exit status $status, $said"
# The same again.
new_drive DETAILS.TXT=DAPLink
printf 'error: %s\r\ntype: target\r\n' "again" >"$work/drive/FAIL.TXT"
come_back again
flash
wait
[ $status = 1 ] || fail "FAIL.TXT came again: exit status $status, $said"
# A drive that never answers holds the file.
new_drive DETAILS.TXT=DAPLink
flash 1
{ [ $status = 0 ] && cmp -s "$work/drive/thimble.hex" "$work/microbit/demo.hex"; } || fail "a drive that does not answer: exit status $status, $said"

board=raspi0
new_drive kernel.img=system
flash
{ [ $status = 0 ] && [ "$(cat "$work/drive/kernel.img.bak")" = system ] && cmp -s "$work/drive/kernel.img" "$work/raspi0/demo.bin"; } ||
  fail "kernel.img was there: exit status $status, $said"
# Again, with another image: what is kept is still the system's.
echo other >"$work/raspi0/demo.bin"
flash
{ [ $status = 0 ] && [ "$(cat "$work/drive/kernel.img.bak")" = system ] && [ "$(cat "$work/drive/kernel.img")" = other ]; } ||
  fail "kernel.img was ours: exit status $status, $said"
new_drive
flash
{ [ $status = 0 ] && [ "$(ls "$work/drive")" = kernel.img ]; } || fail "an empty drive: exit status $status, $(ls "$work/drive")"
ends "FAIL.TXT of a drive is an error; a kernel.img that was there is kept"
