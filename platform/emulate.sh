#!/bin/sh
# Runs an image under QEMU, or the board's own emulator (BOARD_EMULATOR), the UART on stdin and stdout; the exit status is the application's.
#   emulate.sh BOARD APP [QEMU ARGUMENTS...]      (-display gtk shows the display)
# In the environment: FLASHED=yes runs the image that `make flash` writes, which ends by standing still; PLACE=ram the image for RAM
# where the board has one (BOARD_UF2). SHOT=PICTURE asks the demonstration for its picture over the UART, writes it (.png, .ppm,
# .pgm, .pbm) and ends, with FRAMES=N that of frame N, for which the image was built (HOLD); CRC=1 shows the lines that the demonstration writes for each frame where the board has no display.
# -icount: time is counted in instructions, so every run is the same.
set -eu
cd "$(dirname "$0")/.."
board=$1
app=$2
shift 2
. platform/board_facts.sh
if [ -n "${SHOT:-}" ] && [ "$app" != demo ]; then
  echo "thimble: SHOT asks the application demo for its picture, not $app" >&2
  exit 2
fi
emulator=$(fact EMULATOR)
ending=elf
[ -z "$(fact UF2)" ] || ending=uf2
[ -z "$(fact IMAGE)" ] || ending=$(fact IMAGE)
in=
[ "${PLACE:-}" != ram ] || in=_ram
kind=.emulated
semihosting=enable=on,target=native
if [ -n "${FLASHED:-}" ]; then
  kind=
  semihosting=enable=off
fi
image=${THIMBLE_FIRMWARE:-build/firmware}/$board/$app$in$kind.$ending
if [ ! -f "$image" ]; then
  echo "thimble: $image is not there; make firmware BOARD=$board APP=$app builds it" >&2
  exit 1
fi
qemu="$(fact QEMU) -icount shift=$(fact ICOUNT_SHIFT) -display none -monitor none -serial stdio"
run() {
  if [ -n "$emulator" ]; then
    exec sh "platform/emulators/$emulator/run.sh" "$(fact ICOUNT_SHIFT)" "$image" $(fact EMULATOR_OPTIONS) "$@"
  fi
  exec $qemu -semihosting-config $semihosting -kernel "$image" "$@"
}

if [ -n "${SHOT:-}" ]; then
  folder=$(mktemp -d)
  machine=
  trap '[ -z "$machine" ] || kill $machine 2>/dev/null || true; rm -rf "$folder"' EXIT
  trap 'exit 130' INT TERM HUP
  mkfifo "$folder/keys"
  (run "$@") <"$folder/keys" >"$folder/log" 2>"$folder/noise" &
  machine=$!
  exec 3>"$folder/keys"
  # What is sent before the UART is on is lost, so the request is repeated until the picture begins to come, as soon as its frame is drawn: ten minutes at most.
  try=0
  until build/release/thimble uart-picture "$folder/log" -o "$SHOT" 2>"$folder/why"; do
    try=$((try + 1))
    if [ $try -gt 3000 ] || ! kill -0 $machine 2>/dev/null; then
      cat "$folder/noise" >&2
      grep -a '^error: ' "$folder/log" >&2 || true
      sed 's/^thimble: [^:]*: /thimble: no picture came: /' "$folder/why" >&2
      exit 1
    fi
    # Asked once a second: a picture is more than the UART sends at once.
    if [ $((try % 5)) = 1 ] && { [ "${FRAMES:-0}" = 0 ] || grep -aqs '^holding$' "$folder/log"; } && ! grep -aqs '^P[56]' "$folder/log"; then
      printf p >&3 2>/dev/null || true
    fi
    sleep 0.2
  done
  echo "thimble: $SHOT shows what the display of $board would"
  exit 0
fi

if [ "$app" != demo ] || [ "$(fact DISPLAY)" != none ]; then
  run "$@"
fi
echo "thimble: $board has no display: the key q or Ctrl-C ends; a picture: make emulate BOARD=$board SHOT=picture.png" >&2
if [ -n "${CRC:-}" ]; then
  run "$@"
fi
# A line a frame is nothing that somebody reads. The last line of the pipe is QEMU's exit status.
exec 4>&1
status=$(
  {
    {
      ended=0
      (run "$@") 3>&- 4>&- || ended=$?
      echo $ended >&3
    } | grep -a --line-buffered -vE '^(frame|build) [0-9]+ crc ' >&4 3>&- || true
  } 3>&1
)
exit "$status"
