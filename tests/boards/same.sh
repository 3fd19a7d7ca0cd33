#!/bin/sh
# Compares what must be one number everywhere: same.sh BOARD... Reads what their applications said (board.sh).
set -eu
cd "$(dirname "$0")/../.."
work=$THIMBLE_FIRMWARE
failed=0
# judge WHAT: each line of stdin is `KEY VALUE BOARD`; a key with two values is a failure.
judge() {
  sort -u | awk -v what="$1" '
    !($1 in value) { value[$1] = $2; keys++ }
    { boards[$3] = 1 }
    value[$1] != $2 { print "test-boards: " what " " $1 " is " $2 " on " $3 ", " value[$1] " elsewhere"; failed = 1 }
    END {
      for (name in boards) { count++ }
      if (keys > 0 && !failed) { print "test-boards: " what ": " keys " compared on " count (count == 1 ? " board" : " boards") }
      exit failed
    }'
}
for board; do
  for app in selftest golden lit worlds bricks map_light; do
    sed -n "s/^result crc \([0-9a-f]*\) of the \([0-9]*\) cases that every board runs.*/${app}_\2 \1 $board/p" \
      "$work/$board/$app.log" 2>/dev/null || true
  done
done | judge "results of test cases" || failed=1
# Frames of one size and format, whichever way they were drawn.
for board; do
  . platform/board_facts.sh
  size=$(fact WIDTH_PX)x$(fact HEIGHT_PX)_$(fact FORMAT)
  sed -n "s/^[a-z_]*\.crc\.\([0-9]*\),\([0-9a-f]*\).*/${size}_frame_\1 \2 $board/p" "$work/$board/bench.log" 2>/dev/null || true
done | judge "frames" || failed=1
exit $failed
