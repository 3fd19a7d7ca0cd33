#!/bin/sh
# The pixel formats of panels on chips: the application `formats`, in images that have them all, gives the host's CRC; and an
# image that has none of them draws the same frames in fewer instructions, since it asks for none (bench, counted exactly).
#   formats.sh [BOARD...]     THIMBLE_FIRMWARE: where board.sh has run `bench` already; without it, it is built here
set -eu
cd "$(dirname "$0")/../.."
plain=${THIMBLE_FIRMWARE:-}
failed=0
# bench FOLDER BOARD: FOLDER/BOARD/bench.log, of an image that is there.
bench() {
  THIMBLE_FIRMWARE=$1 timeout 300 sh platform/emulate.sh "$2" bench </dev/null >"$1/$2/bench.log" 2>"$1/$2/bench.noise" || true
}
# value FOLDER NAME: what bench said.
value() {
  sed -n "s/^$2,\([0-9]*\).*/\1/p" "$1/$board/bench.log"
}
for board in ${*:-lm3s6965evb microbit}; do
  scene=demo
  all=build/formats
  THIMBLE_FIRMWARE=$all PANEL_FORMATS=0x3fe0 sh platform/build.sh "$board" 'formats;bench' "$scene" >/dev/null
  log=$all/$board/formats.log
  if THIMBLE_FIRMWARE=$all timeout 120 sh platform/emulate.sh "$board" formats </dev/null >"$log" 2>&1; then
    echo "$board formats: $(tail -n 1 "$log"), $(grep -c . "$log") lines"
  else
    echo "FAILED: $board formats: $(grep FAILED "$log" | head -n 3 | tr '\n' ' ')"
    failed=1
  fi
  bench $all "$board"
  none=$plain
  if [ -z "$none" ]; then
    none=build/formats/none
    THIMBLE_FIRMWARE=$none sh platform/build.sh "$board" bench "$scene" >/dev/null
    bench $none "$board"
  fi
  said=
  # With formats, the map's frames ask hundreds of times which it is; that a few are saved would not do.
  for least in tree:1 brick_map:300; do
    engine=${least%:*}
    with=$(value $all $engine.instructions_median)
    without=$(value "$none" $engine.instructions_median)
    said="$said $without ($with with all, $engine)"
    if [ "${without:-0}" -eq 0 ] || [ $((${with:-0} - without)) -lt "${least#*:}" ]; then
      echo "FAILED: $board formats: a frame takes ${without:-no} instructions without formats of panels, ${with:-none} with all ($engine), wanted: ${least#*:} fewer"
      failed=1
    fi
  done
  for folder in $all "$none"; do
    grep '\.crc\.' "$folder/$board/bench.log" >"$folder/$board/formats.crcs" || true
  done
  if ! cmp -s "$all/$board/formats.crcs" "$none/$board/formats.crcs"; then
    echo "FAILED: $board formats: images with other formats draw other frames"
    failed=1
  fi
  echo "$board formats: instructions a frame without them:$said"
done
exit $failed
