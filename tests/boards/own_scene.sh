#!/bin/sh
# A scene of one's own as firmware: own_scene.sh. A scene text with glass, a mirror and a sun is baked into a header;
# the image made from it has the effects that this calls for, dark edges for its few greys, and no others, keeps its
# stack, and draws the simulator's pictures. Prints a line a question; exit status 1 when an answer is wrong. After
# board.sh has built lm3s6965evb.
set -eu
cd "$(dirname "$0")/../.."
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
board=lm3s6965evb
work=$THIMBLE_FIRMWARE/$board
thimble=build/release/thimble
measured=$THIMBLE_FIRMWARE/$board.measured
failed=0
fail() {
  echo "FAILED: $*"
  failed=1
}
mkdir -p "$work"
cat >"$work/own.scene" <<'TEXT'
depth 5
camera eye 40 -14 26 target 15 16 6 fov 40
sun toward 6 -5 9
material floor color 190 180 160
material steel metal color 220 222 226 mirror 0.8
material bottle glass color 180 220 200 index 1.5 density 0.05
box floor from 0 0 0 to 32 32 2
box floor from 0 30 2 to 32 32 20
ball bottle at 18 12 9 radius 7
box steel from 3 18 2 to 12 27 14
TEXT
"$thimble" bake "$work/own.scene" --board "$board" -o "$work/own.h" --quiet
# build APPS HEADER: leaves the log where it can be shown.
build() {
  FRAMES=3 sh platform/build.sh "$board" "$1" "$2" >"$work/own.log" 2>&1 || {
    tail -n 5 "$work/own.log"
    fail "the scene's firmware does not build"
    exit 1
  }
  arm-none-eabi-nm -C "$work/demo.elf" >"$work/own.symbols"
}
grep -q 'define THIMBLE_SCENE_EFFECTS 0x2033u' "$work/own.h" || fail "the header does not name direct light, shadows, mirror, glass, and edges for 16 greys"
build 'demo;bench' "$work/own.h"
for function in light_ray light_arrives_through send_mirrored meet_clear cross meets_edge; do
  grep -q "thimble::lit::$function(" "$work/own.symbols" || fail "the image has no $function"
done
for function in meet_water begin_in_water scatter sky_color fade_in_fog occlude add_emission cue_depth light_arrives; do
  ! grep -q "thimble::lit::$function(" "$work/own.symbols" || fail "the image has $function, which its scene does not call for"
done
sh platform/emulate.sh "$board" demo </dev/null >"$work/own.demo.log" 2>/dev/null || fail "the demonstration ends with status $?"
lit=$(sed -n 's/^instructions of a lit frame: \([0-9]*\).*/\1/p' "$work/own.demo.log")
[ -n "$lit" ] || fail "it drew no frame with light"
cp "$measured" "$measured.kept" 2>/dev/null || : >"$measured.kept"
said=$(UPDATE=1 sh tests/boards/budget.sh "$board" demo "$work/own.demo.log") || fail "$said"
mv "$measured.kept" "$measured"
sh platform/emulate.sh "$board" bench </dev/null 2>/dev/null | tr -d '\r' | grep 'lit_crc' >"$work/own.crcs" || fail "it tells no CRC"
"$thimble" sim "$work/own.scene" --board "$board" --app bench --display none --quiet | grep 'lit_crc' >"$work/own.golden" || true
cmp -s "$work/own.crcs" "$work/own.golden" || fail "its lit pictures are not the simulator's"
[ $failed = 1 ] || echo "own scene: glass, mirror, sun and dark edges, and nothing else; a lit frame takes $lit instructions; $said"

# The same scene without them.
"$thimble" bake "$work/own.scene" --board "$board" --effects none -o "$work/own.h" --quiet
build demo "$work/own.h"
! grep -q 'thimble::lit::\|open_lighting' "$work/own.symbols" || fail "baked for no effects, the image holds some"
[ $failed = 1 ] || echo "own scene: baked for no effects the image holds none"
exit $failed
