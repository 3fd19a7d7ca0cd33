#!/bin/sh
# The pixel formats of panels on chips: the application `formats`, in images that have them all, gives the host's CRC.
#   formats.sh [BOARD...]
set -eu
cd "$(dirname "$0")/../.."
export THIMBLE_FIRMWARE=build/formats
failed=0
for board in ${*:-lm3s6965evb microbit}; do
  PANEL_FORMATS=0x3fe0 sh platform/build.sh "$board" formats >/dev/null
  log=$THIMBLE_FIRMWARE/$board/formats.log
  if timeout 120 sh platform/emulate.sh "$board" formats </dev/null >"$log" 2>&1; then
    echo "$board formats: $(tail -n 1 "$log"), $(grep -c . "$log") lines"
  else
    echo "FAILED: $board formats: $(grep FAILED "$log" | head -n 3 | tr '\n' ' ')"
    failed=1
  fi
done
exit $failed
