#!/bin/sh
# What `thimble image` writes shows, frame for frame, what `make firmware SCENE=` builds: microbit and sifive_e tell the CRCs of
# three frames, lm3s6965evb, pico and gba send their picture over the UART. A scene that is damaged, cut off or not there is
# said so, and the built-in one shown.      images.sh BOARD, after board.sh has built it
set -eu
cd "$(dirname "$0")/../.."
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
board=$1
. platform/board_facts.sh
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
failed=0
fail() {
  printf '%-18s %-10s FAILED: %s\n' "$board" images "$1"
  failed=1
}
# show NAME: what the emulated image of that name shows: CRCs of frames, or a picture; and what it says, in NAME.log.
show() {
  if [ "$(fact DISPLAY)" = none ]; then
    CRC=1 timeout 120 sh platform/emulate.sh "$board" demo </dev/null >"$work/$1.log" 2>/dev/null || fail "$1 ends with status $?"
    grep '^frame' "$work/$1.log" >"$work/$1.shown" || fail "$1 tells of no frame"
  elif ! SHOT=$work/$1.png timeout 240 sh platform/emulate.sh "$board" demo >"$work/$1.log" 2>&1; then
    fail "$1 sends no picture"
  else
    mv "$work/$1.png" "$work/$1.shown"
  fi
}
# With light that is slow the picture stands, so that it does not depend on when it is requested.
scene=tools/gallery/scenes/castle.vox
effects=direct-light,shadows,fog
set=sun
frames=0
case $board in
  microbit)
    set=all
    effects=
    frames=3
    scene=$work/blocks.scene
    cat >"$scene" <<'TEXT'
depth 5
camera eye 40 -14 26 target 15 16 6 fov 40
sun toward 6 -5 9
lamp at 20 10 12 color 255 206 140 brightness 1.5 reach 26
occlusion rays 4 reach 6
material floor color 190 180 160
material steel metal color 120 160 226
box floor from 0 0 0 to 32 32 2
box floor from 0 30 2 to 32 32 20
ball steel at 18 14 9 radius 7
TEXT
    ;;
  sifive_e)
    effects=
    frames=3
    ;;
esac
if ! FRAMES=$frames IMAGES=$work/programs PROGRAMS=demo-$set sh platform/images.sh "$board" >"$work/build.log" 2>&1; then
  tail -n 5 "$work/build.log"
  fail "the program does not build"
  exit 1
fi
# For emulators it is to tell its exit status.
gunzip "$work/programs/$board-demo-$set.elf.gz"
objcopy=arm-none-eabi-objcopy
[ "$(fact ARCH)" != riscv ] || objcopy=riscv64-unknown-elf-objcopy
printf 'yes!' >"$work/yes"
$objcopy --update-section ".semihosting=$work/yes" "$work/programs/$board-demo-$set.elf"
cp "$work/programs/$board-demo-$set.elf" "$work/alone.elf"
gzip -9n "$work/programs/$board-demo-$set.elf"
# image ENDING: as $work/demo.emulated.ENDING
image() {
  "$thimble" image "$scene" --board "$board" ${effects:+--effects "$effects"} --images "$work/programs" -o "$work/demo.emulated.$1" --quiet ||
    fail "no .$1 is written"
}
image "$ending"
(
  THIMBLE_FIRMWARE=$THIMBLE_FIRMWARE/images
  show image
  exit $failed
) || failed=1
if ! EFFECTS=$effects FRAMES=$frames PLACE=flash sh platform/build.sh "$board" demo "$scene" >"$work/build.log" 2>&1; then
  tail -n 5 "$work/build.log"
  fail "the firmware does not build"
fi
show firmware
cmp -s "$work/image.shown" "$work/firmware.shown" || fail "the image shows something else than the firmware"
grep -q '^scene behind' "$work/image.log" && fail "the image does not find its scene"
# What other files of it hold is the same.
if [ "$ending" = elf ]; then
  image bin
  image hex
  $objcopy -I ihex -O binary "$work/demo.emulated.hex" "$work/of_hex.bin"
  cmp -s "$work/of_hex.bin" "$work/demo.emulated.bin" || fail "the .hex holds something else than the .bin"
fi
if [ "$board" != microbit ]; then
  [ $failed = 1 ] || printf '%-18s %-10s %s\n' "$board" images "shows what the firmware does"
  exit $failed
fi

# Without a scene, and with one of which a bit is another or the end is missing.
THIMBLE_FIRMWARE=$THIMBLE_FIRMWARE/images
cp "$work/demo.emulated.elf" "$work/whole.elf"
size=$(wc -c <"$work/whole.elf")
refused() {
  show "$1"
  grep -q "^scene behind the program: $2.*; shown is the built-in one" "$work/$1.log" || fail "$1: it does not say why"
  cmp -s "$work/$1.shown" "$work/none.shown" || fail "$1: it does not show the built-in scene"
}
cp "$work/alone.elf" "$work/demo.emulated.elf"
show none
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
[ $failed = 1 ] || printf '%-18s %-10s %s\n' "$board" images "shows what the firmware does; of scenes that are damaged, cut off or missing the built-in one"
exit $failed
