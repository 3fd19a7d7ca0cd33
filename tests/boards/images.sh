#!/bin/sh
# What `thimble image` writes shows, frame for frame, what `make firmware SCENE=` builds, of each application that has a program
# for the board: `demo` tells the CRCs of three frames, or sends its picture over the UART, `dig` the CRC of its third, `water`
# those of its picture and its water. A scene that is damaged, cut off or not there is said so, and the built-in one shown.
#   images.sh BOARD [--write]      after board.sh has built it; --write: its rows of tests/golden/image_frames.csv anew
set -eu
cd "$(dirname "$0")/../.."
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
board=$1
golden=tests/golden/image_frames.csv
. platform/board_facts.sh
. tests/boards/blocks.sh
thimble=build/release/thimble
work=$PWD/$THIMBLE_FIRMWARE/images/$board
ending=elf
[ -z "$(fact UF2)" ] || ending=uf2
[ -z "$(fact IMAGE)" ] || ending=$(fact IMAGE)
if [ -n "$(fact EMULATOR)" ] && ! sh "platform/emulators/$(fact EMULATOR)/fetch.sh" >/dev/null; then
  exit 0
fi
rm -rf "$work"
mkdir -p "$work/programs"
app=images
. tests/boards/say.sh
# show NAME APP: what the emulated image shows, in NAME.shown: CRCs, or a picture; and what it says, in NAME.log.
show() {
  if [ "$2" != demo ]; then
    timeout "${THIMBLE_EMULATOR_LIMIT_S:-240}" sh platform/emulate.sh "$board" "$2" </dev/null >"$work/$1.log" 2>/dev/null || fail "$2: $1 ends with status $?"
    grep -a '^last crc\|^frames ' "$work/$1.log" | tr -d '\r' >"$work/$1.shown" || fail "$2: $1 tells of no frame"
  elif [ "$(fact DISPLAY)" = none ]; then
    CRC=1 timeout 120 sh platform/emulate.sh "$board" demo </dev/null >"$work/$1.log" 2>/dev/null || fail "$1 ends with status $?"
    grep '^frame' "$work/$1.log" >"$work/$1.shown" || fail "$1 tells of no frame"
  elif ! SHOT=$work/$1.ppm timeout "${THIMBLE_EMULATOR_LIMIT_S:-240}" sh platform/emulate.sh "$board" demo >"$work/$1.log" 2>&1; then
    fail "$1 sends no picture"
  else
    mv "$work/$1.ppm" "$work/$1.shown"
  fi
}
in_images() {
  (
    THIMBLE_FIRMWARE=$THIMBLE_FIRMWARE/images
    "$@"
    exit $failed
  ) || failed=1
}
# image ENDING: of the application $shows, as $work/$shows.emulated.ENDING
image() {
  "$thimble" image "$scene" --board "$board" --app "$shows" ${effects:+--effects "$effects"} --images "$work/programs" \
    -o "$work/$shows.emulated.$1" --quiet || fail "$shows: no .$1 is written"
}
objcopy=arm-none-eabi-objcopy
[ "$(fact ARCH)" != riscv ] || objcopy=riscv64-unknown-elf-objcopy
printf 'yes!' >"$work/yes"
# programs PROGRAM...: builds them, for emulators, which they are to tell their exit status.
programs() {
  if ! FRAMES=$frames IMAGES=$work/programs PROGRAMS=$* sh platform/images.sh "$board" >"$work/build.log" 2>&1; then
    tail -n 5 "$work/build.log"
    fail "$*: does not build"
    exit 1
  fi
  for built in "$work/programs/"*.elf.gz; do
    [ -e "$built" ] || continue
    gunzip "$built"
    $objcopy --update-section ".semihosting=$work/yes" "${built%.gz}"
    cp "${built%.gz}" "$work/alone.elf"
    gzip -9n "${built%.gz}"
  done
}
# compare: the image and the firmware of $shows with $scene, $effects and $frames, and both with the golden row.
compare() {
  image "$ending"
  in_images show image "$shows"
  EFFECTS=$effects FRAMES=$frames PLACE=flash builds "$shows" "$scene"
  show firmware "$shows"
  cmp -s "$work/image.shown" "$work/firmware.shown" || fail "$shows: the image shows something else than the firmware"
  ! grep -aq '^scene behind' "$work/image.log" || fail "$shows: the image does not find its scene"
  crc=$(gzip -1c "$work/image.shown" | tail -c 8 | od -An -tx4 -N4 | tr -d ' ')
  echo "$board,$shows,$crc" >>"$work/rows"
  grep -qx "$board,$shows,$crc" $golden || [ "$write" = --write ] || fail "$shows: shows $crc, which is not in $golden"
}

write=${2:-}
# With light that is slow the picture stands, so that it does not depend on when it is requested.
scene=tools/gallery/scenes/castle.vox
effects=direct-light,shadows,fog
set=sun
frames=0
[ "$(fact DISPLAY)" != none ] || frames=3
case $board in
  microbit)
    set=all
    effects=
    scene=$work/blocks.scene
    { blocks && printf 'lamp at 20 10 12 color 255 206 140 brightness 1.5 reach 26\nocclusion rays 4 reach 6\n'; } >"$scene"
    ;;
  sifive_e) effects= ;;
esac
# Those that tell what they drew, of a scene that small RAM holds.
of_demo="$scene $effects $frames"
frames=3
# It runs 20 million instructions a second, of which a frame takes 100 million.
[ "$(fact EMULATOR)" != rp2040js ] || frames=1
programs 'demo;dig-plain' water-all
for shows in dig water; do
  [ -e "$work/programs/$board-$shows-$([ $shows = dig ] && echo plain || echo all).elf.gz" ] || continue
  scene=spheres,depth=5 effects=none
  if [ $shows = water ]; then
    scene=$work/pond.scene effects=
    # From far away, since every pixel of it sends some ten rays.
    { blocks | sed 's/fov 40/fov 110/' && echo "$some_water"; } >"$scene"
  fi
  compare
done
rm -f "$work/programs/"*
read -r scene effects frames <<TEXT
$of_demo
TEXT
[ -n "$frames" ] || { frames=$effects && effects=; }
shows=demo
programs demo-$set
if [ ! -e "$work/programs/$board-demo-$set.elf.gz" ]; then
  set=plain effects=none
  programs demo-plain 'demo;dig-plain'
fi
if [ -e "$work/programs/$board-demo-$set.elf.gz" ]; then
  compare
fi
if [ "$write" = --write ]; then
  { grep -v "^$board," $golden && cat "$work/rows"; } >"$work/golden"
  { sed '/^board,/q' "$work/golden" && sed '1,/^board,/d' "$work/golden" | sort; } >$golden
fi
shown=$(cut -d , -f 2 "$work/rows" 2>/dev/null | tr '\n' ' ')
# What other files of it hold is the same.
if [ "$ending" = elf ] && [ -n "$shown" ]; then
  image bin
  image hex
  $objcopy -I ihex -O binary "$work/demo.emulated.hex" "$work/of_hex.bin"
  cmp -s "$work/of_hex.bin" "$work/demo.emulated.bin" || fail "the .hex holds something else than the .bin"
  $objcopy -O binary "$work/demo.emulated.elf" "$work/of_elf.bin"
  cmp -s "$work/of_elf.bin" "$work/demo.emulated.bin" || fail "sections of the .elf hold something else than the .bin"
fi
if [ "$board" != microbit ]; then
  ends "show what the firmware does: ${shown:-no program has room}"
fi

# Without a scene, and with one of which a bit is another or the end is missing.
THIMBLE_FIRMWARE=$THIMBLE_FIRMWARE/images
cp "$work/demo.emulated.elf" "$work/whole.elf"
size=$(wc -c <"$work/whole.elf")
refused() {
  show "$1" demo
  grep -q "^scene behind the program: $2.*; shown is the built-in one" "$work/$1.log" || fail "$1: it does not say why"
  cmp -s "$work/$1.shown" "$work/none.shown" || fail "$1: it does not show the built-in scene"
}
cp "$work/alone.elf" "$work/demo.emulated.elf"
show none demo
refused none "there is none"
cmp -s "$work/none.shown" "$work/image.shown" && fail "the built-in scene is the other one"
cp "$work/whole.elf" "$work/demo.emulated.elf"
byte=$(tail -c 200 "$work/whole.elf" | head -c 1 | od -An -tu1 | tr -d ' ')
printf "\\$(printf %o $((byte ^ 8)))" | dd of="$work/demo.emulated.elf" bs=1 seek=$((size - 200)) conv=notrunc 2>/dev/null
refused bit .
# A raw image, as a drive gets it.
head -c -200 "$work/demo.emulated.bin" >"$work/cut.bin"
cp "$work/cut.bin" "$work/demo.emulated.elf"
refused cut .
ends "shows what the firmware does; of scenes that are damaged, cut off or missing the built-in one"
