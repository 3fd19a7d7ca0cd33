#!/bin/sh
# What `make emulate` says of a board without display: how to end and how to see a picture, and no line a frame; and the
# picture that it asks for over the UART is the simulator's.      emulate.sh microbit|mps2-an500, after board.sh has built it
set -eu
cd "$(dirname "$0")/../.."
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
board=$1
work=$PWD/$THIMBLE_FIRMWARE/$board
app=emulate
. tests/boards/say.sh
picture=$work/picture.png
# shows EFFECTS: the picture over the UART, which is the simulator's.
shows() {
  EFFECTS=$1 builds demo demo
  rm -f "$picture"
  if ! SHOT=$picture timeout 240 sh platform/emulate.sh "$board" demo >"$work/shot.log" 2>&1; then
    tail -n 3 "$work/shot.log" >&2
    fail "no picture came over the UART"
  elif ! build/release/thimble sim demo --effects "$1" --board "$board" --display none --frames 3 --check "$picture" --quiet \
    >"$work/check.log" 2>&1; then
    fail "the picture that came over the UART is not the simulator's ($(tail -n 1 "$work/check.log"))"
  fi
}
if [ "$board" != microbit ]; then
  # In colour: 16 bits a pixel, so that red and blue are told apart. It turns, and frame 3 is wanted.
  export FRAMES=3 HOLD=true
  shows none
  ends "the picture of frame 3 over the UART is the simulator's, in colour"
fi
# With light that is slow the demonstration stands still, so that the picture does not depend on when it is requested.
shows depth-cue
if SHOT=$picture sh platform/emulate.sh $board bench >/dev/null 2>"$work/why" || ! grep -q 'demo' "$work/why"; then
  fail "SHOT of another application: $(cat "$work/why")"
fi

# It turns now, and would tell of every frame. Keys arrive; q ends with the application's status.
EFFECTS=none builds demo demo
# talk OUT: for three seconds, then q until it ends.
talk() {
  status=0
  {
    sleep 3
    for i in $(seq 100); do
      printf q 2>/dev/null || break
      sleep 0.1
    done
  } | timeout 60 sh platform/emulate.sh $board demo >"$1" 2>"$1.said" || status=$?
}
talk "$work/quiet"
lines=$(wc -l <"$work/quiet")
if [ $status != 0 ]; then
  fail "exit status $status at q"
elif ! grep -q "no display.*q.*SHOT=" "$work/quiet.said"; then
  fail "it does not say how to end and how to see a picture: $(cat "$work/quiet.said")"
elif [ "$lines" -gt 12 ] || grep -q '^frame' "$work/quiet" || ! grep -q "$board" "$work/quiet"; then
  fail "it is not quiet: $lines lines"
fi
CRC=1 talk "$work/loud"
grep -q '^frame [0-9]* crc ' "$work/loud" || fail "CRC=1 shows no frame"
ends "the picture over the UART is the simulator's; it says how to end and how to see one, and is quiet ($lines lines)"
