#!/bin/sh
# Runs an image under QEMU, the UART on stdin and stdout; the exit status is the application's.
#   emulate.sh BOARD APP [QEMU ARGUMENTS...]      (-display gtk shows the display)
# -icount: time is counted in instructions, so every run is the same.
set -eu
cd "$(dirname "$0")/.."
board=$1
app=$2
shift 2
. platform/board_facts.sh
image=${THIMBLE_FIRMWARE:-build/firmware}/$board/$app.elf
if [ ! -f "$image" ]; then
  echo "thimble: $image is not there; make firmware BOARD=$board APP=$app builds it" >&2
  exit 1
fi
exec $(fact QEMU) -icount "shift=$(fact ICOUNT_SHIFT)" -display none -monitor none -serial stdio \
  -semihosting-config enable=on,target=native -kernel "$image" "$@"
