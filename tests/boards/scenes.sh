#!/bin/sh
# Other scenes than the demonstration's as firmware: scenes.sh BOARD, after board.sh has built it. A .vox, a mesh, and a scene baked
# with lights are each built, or refused before anything is compiled with the bytes and options; and what an image takes beside
# its scene is what platform/boards/program_flash.h says, by which they are refused. A line a scene.
set -eu
cd "$(dirname "$0")/../.."
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
board=$1
work=$THIMBLE_FIRMWARE/$board
thimble=build/release/thimble
export PLACE=flash
. platform/board_facts.sh
mkdir -p "$work"
app=scenes
. tests/boards/say.sh
# A mesh: a pyramid.
printf 'OFF\n5 6 0\n0 0 0\n9 0 0\n9 9 0\n0 9 0\n4 5 7\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n3 0 2 1\n3 0 3 2\n' >"$work/mesh.off"
"$thimble" bake tools/gallery/scenes/room.scene --board "$board" -o "$work/lights.oct" --quiet 2>"$work/scenes.log" ||
  "$thimble" bake tools/gallery/scenes/room.scene -o "$work/lights.oct" --quiet
for scene in tools/gallery/scenes/castle.vox "$work/mesh.off" "$work/lights.oct"; do
  name=$(basename "$scene")
  rm -f "$work/demo.memory.csv" "$work/scene.h"
  options=
  case $scene in *.off) options='--depth 6' ;; esac
  if BAKE=$options sh platform/build.sh "$board" demo "$scene" >"$work/scenes.log" 2>&1; then
    scene_bytes=$(sed -n 's/^#define THIMBLE_SCENE_BYTES \([0-9]*\)u.*/\1/p' "$work/scene.h")
    program=$(($(cut -d , -f 3 "$work/demo.memory.csv") - scene_bytes))
    says=$("$thimble" bake "$scene" --board "$board" $options -o "$work/again.h" 2>&1 | sed -n "s/.*demonstration's \([0-9,]*\);.*/\1/p" | tr -d ,)
    # Effects that share parts take less than their sum.
    [ "$program" -le "${says:-0}" ] || fail "$name: the program takes $program bytes, program_flash.h says ${says:-nothing}"
    [ "$program" -gt $((says - says / 16)) ] || fail "$name: the program takes $program bytes, program_flash.h says $says, too many"
    say "$name is built, program $program bytes of at most $says, scene $scene_bytes"
  elif grep -q '^thimble: .* bytes too many.*--' "$work/scenes.log" && [ ! -e "$work/demo.memory.csv" ]; then
    say "$name is refused: $(sed -n 's/^thimble: [^ ]*: //p' "$work/scenes.log" | cut -c 1-100)"
  else
    tail -n 5 "$work/scenes.log"
    fail "$name is neither built nor refused"
  fi
done
exit $failed
