#!/bin/sh
# What a person sees and does: the display's picture equals the simulator's, pixel by pixel, and each button arrives.
# display.sh BOARD, after board.sh has built it. Prints a line a question; exit status 1 when an answer is wrong.
set -eu
cd "$(dirname "$0")/../.."
board=$1
. platform/board_facts.sh
tool=$THIMBLE_FIRMWARE/qemu_screen
work=$PWD/$THIMBLE_FIRMWARE/$board
thimble=build/release/thimble
frames=3
failed=0
machine=
# Sockets have short names.
folder=$(mktemp -d)
socket=$folder/qmp
trap '[ -z "$machine" ] || kill $machine 2>/dev/null || true; rm -rf "$folder"' EXIT
# start APP KEYS: the emulator in the background, its UART in $work/screen.log, keys sent again and again for 3 s.
start() {
  # The shell that sends keys ends with the emulator; `exec` makes the process that is killed the emulator itself.
  rm -f "$folder/keys.$1"
  mkfifo "$folder/keys.$1"
  sh platform/emulate.sh "$board" "$1" -qmp "unix:$socket,server=on,wait=off" <"$folder/keys.$1" >"$work/screen.log" 2>/dev/null &
  machine=$!
  for i in $(seq 30); do
    printf '%s' "$2" 2>/dev/null || break
    sleep 0.1
  done >"$folder/keys.$1" &
}
# wait_for TEXT: until the UART has said it, 30 s at most; an emulator of the board's own is slow.
patience=300
[ -z "$(fact EMULATOR)" ] || patience=1200
wait_for() {
  for i in $(seq $patience); do
    grep -qs "$1" "$work/screen.log" && return 0
    sleep 0.1
  done
  return 1
}
# shows FILE LOG OPTIONS...: whether the display comes to show what the simulator, with these options, shows. The
# picture stands, but the emulator refreshes its window when it has the time.
shows() {
  shot=$1
  log=$2
  shift 2
  for i in $(seq 20); do
    "$tool" "$socket" shot "$shot" $scale
    is_right "$shot" "$log" "$@" && return 0
    sleep 0.2
  done
  return 1
}
# is_right FILE LOG OPTIONS...: whether it is the simulator's picture, in the bits that the display shows.
shown_bits=$(fact SHOWN_BITS)
is_right() {
  shot=$1
  log=$2
  shift 2
  if [ -z "$shown_bits" ]; then
    "$thimble" sim "$scene" "$@" --board "$board" --display none --check "$shot" --quiet >"$log" 2>&1
  else
    "$thimble" sim "$scene" "$@" --board "$board" --display none --shot "$work/right.ppm" --quiet >"$log" 2>&1 &&
      "$tool" "$shot" same "$work/right.ppm" "$shown_bits"
  fi
}
stop() {
  "$tool" "$socket" quit || kill $machine 2>/dev/null || true
  wait $machine 2>/dev/null || true
  machine=
}
scene=demo
effects=$(fact DEMO_EFFECTS)
effects=${effects:-none}

EFFECTS=$effects HOLD=true FRAMES=$frames sh platform/build.sh "$board" "demo;faults" "$scene" >"$work/display.build.log" 2>&1 || {
  tail -n 5 "$work/display.build.log" >&2
  exit 1
}
# QEMU magnifies the OLED.
scale=1
[ "$(fact DISPLAY)" = oled ] && [ -z "$(fact EMULATOR)" ] && scale=4
start demo ""
if wait_for '^holding'; then
  if shows "$work/display.ppm" "$work/display.check.log" --effects "$effects" --frames $frames; then
    echo "the display shows the simulator's picture, pixel by pixel (effects: $effects)"
  else
    echo "FAILED: the display does not show the simulator's picture ($(grep -v '^thimble demo\|^scene' "$work/display.check.log" | head -n 1))"
    failed=1
  fi
else
  echo "FAILED: did not draw $frames frames in 30 s"
  failed=1
fi
stop

pairs='up:up down:down left:left right:right'
[ "$(fact BUTTONS)" != 5 ] || pairs="$pairs ctrl:select"
if [ "$(fact BUTTONS)" -ge 4 ]; then
  start faults b
  arrived=
  wanted=
  if wait_for '^buttons'; then
    for pair in $pairs; do
      key=${pair%:*}
      button=${pair#*:}
      wanted="$wanted $button"
      # A line of QEMU's is low, as if pressed, until its first release, which wants a press before it.
      "$tool" "$socket" press "$key"
      "$tool" "$socket" release "$key"
      sleep 0.1
      "$tool" "$socket" press "$key"
      wait_for "^down: $button" && arrived="$arrived $button"
      "$tool" "$socket" release "$key"
      sleep 0.1
    done
  fi
  if [ -n "$arrived" ] && [ "$arrived" = "$wanted" ]; then
    echo "buttons:$arrived"
  else
    echo "FAILED: of its $(fact BUTTONS) buttons these arrived:$arrived"
    failed=1
  fi
  stop
fi
# A held rate: the simulator's pictures, and no more instructions than the clock has cycles for.
fps=$(fact HOLDS_FPS)
fps=${fps:-30}
if [ "$(fact VISITS_A_SECOND)" != 0 ]; then
  # Without light, which leaves no time for a rate.
  EFFECTS=none HOLD_FPS=$fps HOLD=true FRAMES=20 sh platform/build.sh "$board" demo "$scene" >"$work/display.build.log" 2>&1 || {
    tail -n 5 "$work/display.build.log" >&2
    exit 1
  }
  start demo ""
  if wait_for '^holding$'; then
    most=$(sed -n 's/^most instructions of a held frame: \([0-9]*\).*/\1/p' "$work/screen.log")
    if ! shows "$work/held.ppm" "$work/held.check.log" --effects none --hold $fps --frames 20; then
      echo "FAILED: held at $fps frames a second, the display does not show the simulator's picture ($(tail -n 1 "$work/held.check.log"))"
      failed=1
    elif [ -n "$(fact HOLDS_FPS)" ] &&
      [ "$((${most:-999999999} * fps))" -gt "$(($(fact CLOCK_MHZ) * 1000000))" ]; then
      echo "FAILED: $fps frames a second are too many: a frame takes ${most:-unknown} instructions"
      failed=1
    else
      echo "held at $fps frames a second the display shows the simulator's picture; a frame takes at most ${most:-unknown} instructions"
    fi
  else
    echo "FAILED: did not draw 20 held frames in 30 s"
    failed=1
  fi
  stop
fi
exit $failed
