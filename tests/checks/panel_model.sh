#!/bin/sh
# The models of the Pico's displays refuse what real ones could not take, and one notices who writes into a band that is being
# sent: as they are, and with a look taken out, which must be seen.      panel_model.sh ROOT WORK
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
model=platform/emulators/rp2040js/oled.mjs
node tests/boards/test_oled.mjs "$model"
sed 's/ && !this\.scrolls//' "$model" >"$2/oled.mjs"
if cmp -s "$model" "$2/oled.mjs" || node tests/boards/test_oled.mjs "$2/oled.mjs" >/dev/null 2>&1; then
  echo "a model that shows what scrolls is not told"
  exit 1
fi
