#!/bin/sh
# Puts rp2040js where run.sh looks for it, by npm, if it is not there yet. Exit status 77, with a sentence: not here.
set -eu
cd "$(dirname "$0")/../../.."
here=platform/emulators/rp2040js
work=${THIMBLE_EMULATORS:-build/emulators}/rp2040js
for tool in node npm; do
  if ! command -v $tool >/dev/null 2>&1; then
    echo "the Pico's emulator wants $tool, which is not installed (Debian: apt-get install nodejs npm)"
    exit 77
  fi
done
if cmp -s $here/package-lock.json "$work/package-lock.json" && [ -f "$work/node_modules/rp2040js/package.json" ]; then
  exit 0
fi
rm -rf "$work"
mkdir -p "$work"
cp $here/package.json $here/package-lock.json "$work"
if ! (cd "$work" && npm ci --ignore-scripts --no-audit --no-fund) >"$work.log" 2>&1; then
  rm -f "$work/package-lock.json"
  echo "the Pico's emulator, rp2040js, could not be fetched by npm: $(grep -i 'error' "$work.log" | head -n 1)"
  exit 77
fi
