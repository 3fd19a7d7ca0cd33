#!/bin/sh
# A project of `thimble new` for the board's own display, built by its own CMakeLists.txt, draws its scene there.
#   new.sh BOARD, after run.sh has built qemu_screen; a board without display ends with status 0
set -eu
cd "$(dirname "$0")/../.."
board=$1
. platform/board_facts.sh
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
tool=$THIMBLE_FIRMWARE/qemu_screen
# The images lie where emulate.sh looks for them.
THIMBLE_FIRMWARE=$PWD/$THIMBLE_FIRMWARE/new
work=$THIMBLE_FIRMWARE/castle-$board
app=new
. tests/boards/say.sh
if [ -n "$(fact EMULATOR)" ] && ! sh "platform/emulators/$(fact EMULATOR)/fetch.sh" >/dev/null; then
  exit 0
fi
rm -rf "$work" "$THIMBLE_FIRMWARE/$board"
mkdir -p "$work"
build/release/thimble new "$work/castle" --board "$board" castle --quiet
hold=$([ "$(fact DISPLAY)" != none ] && [ -z "$(fact EMULATOR)" ] && echo true || echo false)
{ CCACHE_DISABLE=1 cmake -S "$work/castle" -B "$work/castle/build" -G Ninja -DTHIMBLE="$PWD" -DCMAKE_BUILD_TYPE=None -DTHIMBLE_FRAMES=1 \
  -DTHIMBLE_HOLD="$hold" && CCACHE_DISABLE=1 cmake --build "$work/castle/build"; } >"$work/build.log" 2>&1 || {
  tail -n 5 "$work/build.log"
  fail "the project does not build"
  exit 1
}
ln -s "$work/castle/build/thimble" "$THIMBLE_FIRMWARE/$board"
if [ "$hold" = true ]; then
  folder=$(mktemp -d)
  sh platform/emulate.sh "$board" castle -qmp "unix:$folder/qmp,server=on,wait=off" </dev/null >"$work/log" 2>/dev/null &
  machine=$!
  trap 'kill $machine 2>/dev/null || true; rm -rf "$folder"' EXIT
  for i in $(seq 300); do
    grep -qs '^holding' "$work/log" && break
    sleep 0.1
  done
  sleep 0.5  # until QEMU's window has it
  scale=1
  [ "$(fact DISPLAY)" != oled ] || scale=4
  "$tool" "$folder/qmp" shot "$work/shown.ppm" $scale
  "$tool" "$folder/qmp" quit
else
  shot=
  [ "$(fact DISPLAY)" = none ] || shot="-shot $work/shown.ppm"
  timeout 300 sh platform/emulate.sh "$board" castle $shot </dev/null >"$work/log" 2>&1 || fail "it ends with status $?: $(tail -n 1 "$work/log")"
fi
if [ "$(fact DISPLAY)" = none ]; then
  ends "a project draws its scene and ends"
fi
awk '/^static const uint8_t/ { inside = 1; next } /^};/ { inside = 0 } inside' "$work/castle/scene.h" | tr -dc '0-9,' | tr ',' '\n' |
  awk 'NF { printf "\\%03o", $1 }' >"$work/octal"
printf "$(cat "$work/octal")" >"$work/scene.oct"
ending=ppm bytes=3 shade=color
case $(fact FORMAT) in
  gray*) ending=pgm bytes=1 ;;
  mono*) ending=pgm bytes=1 shade=ink ;;
esac
size=$(fact WIDTH_PX)x$(fact HEIGHT_PX)
build/release/thimble render "$work/scene.oct" --size "$size" --shade $shade --quiet -o "$work/right.$ending"
pixels=$((${size%x*} * ${size#*x}))
tail -c $((3 * pixels)) "$work/shown.ppm" | od -An -v -tu1 -w3 >"$work/shown"
tail -c $((bytes * pixels)) "$work/right.$ending" | od -An -v -tu1 -w$bytes >"$work/right"
# Displays keep four bits of a channel or more, and round.
worse=$(paste "$work/shown" "$work/right" | awk -v gray=$((3 - bytes)) '
  { for (i = 1; i <= 3; i++) { difference = $i - $(gray ? 4 : 3 + i); if (difference < -9 || difference > 9) { worse++ } } }
  END { print NR == '$pixels' ? worse + 0 : "not all" }')
[ "$worse" = 0 ] || fail "$worse channels of the picture are not this machine's"
ends "a project shows its scene"
