#!/bin/sh
# Scenes of one's own as firmware: own_scene.sh BOARD. A scene text is baked into a header; the image made from it has
# the effects that this calls for and no others, keeps its stack, and draws the simulator's pictures. On lm3s6965evb:
# glass, a mirror and a sun, dark edges for its few greys, by the tree, and the mirror and the sun by the brick map, and a
# scene that is too large beside demo; on microbit a lamp, a sun and occlusion, and a pond, by the brick map. Prints a
# line a question; exit status 1 when an answer is wrong. After board.sh has built BOARD.
set -eu
cd "$(dirname "$0")/../.."
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
board=$1
work=$THIMBLE_FIRMWARE/$board
thimble=build/release/thimble
measured=$THIMBLE_FIRMWARE/$board.measured
app=own
. tests/boards/say.sh
. tests/boards/blocks.sh
# build APPS HEADER: and what the image of demo holds.
build() {
  FRAMES=3 builds "$1" "$2"
  arm-none-eabi-nm -C "$work/demo.elf" >"$work/own.symbols"
}
holds() {
  grep -q "thimble::lit::$1" "$work/own.symbols"
}
# run APP: what it says, in own.APP.log; and whether it keeps its stack, which no row of the budgets tells of this scene.
run() {
  sh platform/emulate.sh "$board" "$1" </dev/null >"$work/own.said" 2>/dev/null || fail "$1 ends with status $?"
  tr -d '\r' <"$work/own.said" >"$work/own.$1.log"
  cp "$measured" "$measured.kept" 2>/dev/null || : >"$measured.kept"
  said=$(UPDATE=1 sh tests/boards/budget.sh "$board" "$1" "$work/own.$1.log") || fail "$said"
  mv "$measured.kept" "$measured"
}
# holds_its_frames NAME: after bench has run.
holds_its_frames() {
  said=$(sh tests/boards/lit_budget.sh "$board" "$1" "$work/own.bench.log") || fail "$said"
}
# draws_as_the_simulator SCENE [OPTION...]
draws_as_the_simulator() {
  run bench
  grep 'lit_crc' "$work/own.bench.log" >"$work/own.crcs" || fail "it tells no CRC"
  "$thimble" sim "$@" --board "$board" --app bench --display none --quiet | grep 'lit_crc' >"$work/own.golden" || true
  cmp -s "$work/own.crcs" "$work/own.golden" || fail "its lit pictures are not the simulator's"
}

glass_and_mirror() {
  # The same room with a steel that mirrors, and in front of it a bottle of glass.
  blocks | sed -e 's/^material steel.*/material steel metal color 220 222 226 mirror 0.8\
material bottle glass color 180 220 200 index 1.5 density 0.05/' -e 's/^ball steel at 18 14/ball bottle at 18 12/' >"$work/own.scene"
  "$thimble" bake "$work/own.scene" --board "$board" -o "$work/own.h" --quiet
  grep -q 'define THIMBLE_SCENE_EFFECTS 0x2033u' "$work/own.h" || fail "the header does not name direct light, shadows, mirror, glass, and edges for 16 greys"
  build 'demo;bench' "$work/own.h"
  for function in light_ray light_arrives_through send_mirrored meet_clear cross meets_edge; do
    holds "$function(" || fail "the image has no $function"
  done
  for function in meet_water begin_in_water scatter sky_color fade_in_fog occlude add_emission cue_depth light_arrives; do
    ! holds "$function(" || fail "the image has $function, which its scene does not call for"
  done
  run demo
  of_demo=$said
  lit=$(sed -n 's/^instructions of a lit frame: \([0-9]*\).*/\1/p' "$work/own.demo.log")
  [ -n "$lit" ] || fail "it drew no frame with light"
  draws_as_the_simulator "$work/own.scene"
  say "glass, mirror, sun and dark edges, and nothing else; a lit frame takes $lit instructions; $of_demo"

  "$thimble" bake "$work/own.scene" --board "$board" --effects none -o "$work/own.h" --quiet
  build demo "$work/own.h"
  ! grep -q 'thimble::lit::\|open_lighting' "$work/own.symbols" || fail "baked for no effects, the image holds some"
  say "baked for no effects the image holds none"
}

# What is too large beside demo is refused before anything is compiled, with the options that make it fit.
too_large() {
  rm -f "$work/demo.elf"
  ! EFFECTS=none sh platform/build.sh "$board" demo demo,depth=8 >"$work/own.log" 2>&1 || fail "a scene larger than the flash is built"
  grep -q 'bytes too many; --coarsen .* fits; --depth [1-7] fits .*BAKE=' "$work/own.log" || fail "it is not said how it fits: $(tail -n 1 "$work/own.log")"
  [ ! -e "$work/demo.elf" ] || fail "a scene that is refused is compiled"
  export BAKE=--coarsen EFFECTS=none
  build demo demo,depth=8
  unset BAKE EFFECTS
  left=$(sed -n 's/.*flash \([0-9]*\) of \([0-9]*\),.*/\2 \1/p' "$work/own.build.log" | awk 'END { print $1 - $2 }')
  [ "${left:-99999}" -lt 4096 ] || fail "coarsened to fit it leaves ${left:-no} bytes of the flash"
  say "a scene that is too large beside demo is refused with what makes it fit; coarsened it leaves $left bytes"
}

# bake_own [SCENE]: into the header, for $effects.
bake_own() {
  "$thimble" bake "${1:-$work/own.scene}" --board "$board" --effects "$effects" -o "$work/own.h" --quiet
}
# draws_by_the_map SPECIALISATION ROW WHAT [SCENE]: bakes it; its image holds that specialisation of map_render.h, and keeps the row's ceiling.
draws_by_the_map() {
  bake_own "${4:-$work/own.scene}"
  build 'demo;bench' "$work/own.h"
  holds "draw_flat<$1u" || fail "$3 does not go through the map"
  [ "$(grep -o 'thimble::lit::draw_flat<[0-9]*u' "$work/own.symbols" | sort -u | wc -l)" = 1 ] || fail "the image holds other sets than its own"
  run demo
  of_demo=$said
  draws_as_the_simulator "${4:-$work/own.scene}" --effects "$effects"
  holds_its_frames "$2"
  say "$3 by the map; $of_demo"
}

mirror() {
  grep -v bottle "$work/own.scene" >"$work/own_mirror.scene"
  effects=direct-light,shadows,mirror
  draws_by_the_map 19 sun-mirror "a mirror and the sun" "$work/own_mirror.scene"
}

lamp() {
  { blocks && echo 'lamp at 20 10 12 color 255 206 140 brightness 1.5 reach 26'; } >"$work/own.scene"
  effects=direct-light,shadows,ambient-occlusion
  draws_by_the_map 4623 sun-lamp-occlusion "a lamp, the sun and occlusion"
  grep -q 'define THIMBLE_SCENE_LAMPS 1$' "$work/own.h" || fail "the header does not name its lamp"

  blocks >"$work/own_sun.scene"
  bake_own "$work/own_sun.scene"
  grep -q 'define THIMBLE_SCENE_LAMPS 0$' "$work/own.h" || fail "the header names a lamp"
  build demo "$work/own.h"
  holds 'draw_flat<527u' || fail "occlusion does not go through the map"
  ! holds 'draw_flat<4' || fail "the image holds lamps, of which its scene has none"
  say "without a lamp the image has nothing for one"
}

water() {
  { blocks && echo "$some_water"; } >"$work/own.scene"
  effects=direct-light,shadows,water,sky,ripples
  draws_by_the_map 17035 sun-water "water with ripples, the sun and the sky"
}

case $board in
  lm3s6965evb)
    glass_and_mirror
    too_large
    mirror
    ;;
  microbit)
    lamp
    water
    ;;
  *) fail "there is no scene for it" ;;
esac
exit $failed
