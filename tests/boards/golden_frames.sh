#!/bin/sh
# The frames of the demonstration in each size and format that a board has: tests/golden/demo_frames.csv, with which
# board.sh compares what `bench` draws there.   golden_frames.sh [--write]
# Drawn here by the simulator, ray by ray and by the brick map, which must agree; --write writes the table anew.
set -eu
cd "$(dirname "$0")/../.."
table=tests/golden/demo_frames.csv
work=build/boards
mkdir -p "$work"
rm -f "$work/frames.failed"
for folder in platform/boards/*/; do
  board=$(basename "$folder")
  . platform/board_facts.sh
  said=$work/$board.frames
  if ! build/release/thimble sim demo --effects none --app bench --board "$board" --display none --quiet >"$said" 2>&1 ||
    ! grep -q '^exact,yes' "$said"; then
    echo "golden frames: the simulator of $board draws none, or not exactly: $(tail -n 1 "$said")" >&2
    touch "$work/frames.failed"
  fi
  sed -n "s/^[a-z_]*\.crc\.\([0-9]*\),\([0-9a-f]*\).*/$(fact WIDTH_PX),$(fact HEIGHT_PX),$(fact FORMAT),\1,\2/p" "$said"
done | sort -t , -k 1,1n -k 2,2n -k 3,3 -k 4,4n -u >"$work/frames.csv"
[ ! -f "$work/frames.failed" ] || exit 1
{
  echo '# CRC-32 of frames of the demonstration without light, every format and size that a board has.'
  echo '# sh tests/boards/golden_frames.sh draws and compares them; --write makes this table anew.'
  echo width,height,format,frame,crc32
  cat "$work/frames.csv"
} >"$work/demo_frames.csv"
if [ "${1:-}" = --write ]; then
  cp "$work/demo_frames.csv" "$table"
  echo "golden frames: wrote $table"
elif ! diff "$table" "$work/demo_frames.csv"; then
  echo "golden frames: those that the simulator draws are not those of $table" >&2
  exit 1
else
  echo "golden frames: $(wc -l <"$work/frames.csv") of $(cut -d , -f 1-3 "$work/frames.csv" | sort -u | wc -l) sizes and formats, ray by ray and by the map"
fi
