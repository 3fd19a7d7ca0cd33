#!/bin/sh
# Runs an image as a Raspberry Pi Pico would, for emulate.sh: run.sh SHIFT IMAGE.uf2 [OPTIONS...] (emulate.mjs)
set -eu
cd "$(dirname "$0")/../../.."
if ! why=$(sh platform/emulators/rp2040js/fetch.sh); then
  echo "thimble: $why" >&2
  exit 77
fi
exec node platform/emulators/rp2040js/emulate.mjs "${THIMBLE_EMULATORS:-build/emulators}/rp2040js/node_modules" "$@"
