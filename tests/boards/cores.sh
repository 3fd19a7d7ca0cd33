#!/bin/sh
# What two cores draw (BOARD_CORES): the simulator's frames by their CRC, in at most 0.62 times the instructions of one core.
# cores.sh BOARD, after board.sh has built and run it. Prints a line; exit status 1 when something is wrong.
set -eu
cd "$(dirname "$0")/../.."
board=$1
app=cores
. tests/boards/emulated.sh
effects=$(fact DEMO_EFFECTS)
FRAMES=4 PLACE=flash builds demo demo
# Frames without their CRC, as fast as two cores can; then with it, so in order.
status=0
sh platform/emulate.sh "$board" demo </dev/null >"$work/cores.log" 2>"$work/cores.noise" || status=$?
printf c | sh platform/emulate.sh "$board" demo >"$work/cores.crcs" 2>>"$work/cores.noise" || status=$?
if [ $status != 0 ] || ! grep -q '^two cores draw' "$work/cores.log"; then
  fail "exit status $status, $(tail -n 1 "$work/cores.noise")"
fi
echo '1: type c' >"$work/cores.keys"
build/release/thimble sim demo --effects "${effects:-none}" --board "$board" --display none --frames 4 --keys "$work/cores.keys" \
  --quiet >"$work/cores.sim" 2>&1 || true
grep '^frame [1-9]' "$work/cores.crcs" | tr -d '\r' >"$work/cores.frames" || true
grep '^frame [1-9]' "$work/cores.sim" >"$work/cores.right" || true
if [ "$(grep -c . "$work/cores.right")" -lt 3 ] || ! cmp -s "$work/cores.frames" "$work/cores.right"; then
  fail "its frames, $(tr '\n' ' ' <"$work/cores.frames"), are not the simulator's, $(tr '\n' ' ' <"$work/cores.right")"
fi
# The last frame is much like those of bench.
both=$(sed -n 's/^instructions of a lit frame: //p' "$work/cores.log" | tr -d '\r')
one=$(sed -n 's/^lit\.instructions_median,//p' "$work/bench.log" | tr -d '\r')
if [ -n "$effects" ]; then
  [ $((${both:-999999999} * 100)) -le $((${one:-0} * 62)) ] || fail "two cores take ${both:-unknown} instructions for a lit frame, one ${one:-unknown}"
fi
say "frames are the simulator's; a lit frame takes ${both:-unknown} instructions, by one core ${one:-unknown}"
exit $failed
