#!/bin/sh
# The application `water` as firmware, with a scene that has some: water.sh, after board.sh has built lm3s6965evb. What it counts
# and its water are the simulator's, and its image keeps its budget. Prints a line; exit status 1 when something is wrong.
set -eu
cd "$(dirname "$0")/../.."
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
board=lm3s6965evb
work=$THIMBLE_FIRMWARE/$board
scene=tools/gallery/scenes/waves.scene
app=water
. tests/boards/say.sh
FRAMES=4 builds water $scene
status=0
timeout 300 sh platform/emulate.sh $board water </dev/null >"$work/water.log" 2>"$work/water.noise" || status=$?
build/release/thimble sim $scene --app water --board $board --display none --frames 4 --quiet >"$work/water.sim" 2>&1 || true
counted=$(sed -n 's/^frames \(.*\)/\1/p' "$work/water.log" | tr -d '\r')
if [ $status != 0 ] || [ -z "$counted" ] || ! grep -qx "frames $counted" "$work/water.sim"; then
  fail "exit status $status; it counts '$counted', the simulator '$(grep '^frames' "$work/water.sim" || echo nothing)'"
fi
said=$(sh tests/boards/budget.sh $board water "$work/water.log") || fail "$said"
ends "counts what the simulator does; $said"
