#!/bin/sh
# Runs an image as a Game Boy Advance would, for emulate.sh: run.sh SHIFT IMAGE.gba [OPTIONS...] (emulate.cpp). libmgba
# counts the core's cycles, so SHIFT is not asked for.
set -eu
cd "$(dirname "$0")/../../.."
if ! why=$(sh platform/emulators/mgba/fetch.sh); then
  echo "thimble: $why" >&2
  exit 77
fi
shift
exec "${THIMBLE_EMULATORS:-build/emulators}/mgba/emulate" "$@"
