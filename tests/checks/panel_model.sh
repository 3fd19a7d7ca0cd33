#!/bin/sh
# The model of the Pico's display refuses what a real one could not take, and notices who writes into a band that is being
# sent: as it is, and with that look taken out, which must be seen.      panel_model.sh ROOT WORK
set -eu
cd "$1"
command -v node >/dev/null 2>&1 || {
  echo "skipped: node is not installed"
  exit 77
}
mkdir -p "$2"
model=platform/emulators/rp2040js/panel.mjs
node tests/boards/test_panel.mjs "$model"
sed 's/ && channel\.active//' "$model" >"$2/panel.mjs"
if cmp -s "$model" "$2/panel.mjs" || node tests/boards/test_panel.mjs "$2/panel.mjs" >/dev/null 2>&1; then
  echo "a model that looks at bands that were sent already is not told"
  exit 1
fi
