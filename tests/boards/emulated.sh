# Sourced, with `board` and `app` set, by what tests a board in its own emulator after board.sh has built it: the board's
# facts, its folder ($work), the emulator's ($emulator), and say.sh. Ends where there is no emulator.
. platform/board_facts.sh
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
work=$THIMBLE_FIRMWARE/$board
emulator=platform/emulators/$(fact EMULATOR)
. tests/boards/say.sh
if ! why=$(sh "$emulator/fetch.sh"); then
  say "skipped: $why"
  exit 0
fi
