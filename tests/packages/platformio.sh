#!/bin/sh
# The package as PlatformIO builds a library: every source below the manifest's srcDir, the manifest's folders as include
# paths, an archive, a program linked with it. PlatformIO itself is not in Debian.
name=platformio
. tests/packages/common.sh
need arm-none-eabi-g++
unpack "thimble-platformio-$VERSION.tar.gz" lib/thimble
lib=$WORK/lib/thimble
from() {
  $python -c 'import json, sys; print(json.load(open(sys.argv[1]))["build"][sys.argv[2]])' "$lib/library.json" "$1"
}
sources=$lib/$(from srcDir)
bare arm
options="-std=gnu++17 $arm_options -I$lib/$(from includeDir) -I$sources"
find "$sources" -name '*.cpp' | sort | while read -r source; do
  object=$WORK/$(echo "${source#"$sources"/}" | tr / _).o
  logged arm-none-eabi-g++ $options -c "$source" -o "$object"
  echo "$object"
done >"$WORK/objects"
logged arm-none-eabi-ar rcs "$WORK/libthimble.a" $(cat "$WORK/objects")
for program in platform/examples/ball/main.cpp tests/packages/panels.cpp; do
  logged arm-none-eabi-g++ $options $program $bare_link "$WORK/libthimble.a" -lgcc -o "$WORK/$(basename $program .cpp).elf"
done
no_drivers "$WORK/main.elf"
# A project of `thimble new`, with a stand-in for Arduino's core.
project tft --board microbit --panel st7735 --build platformio fox
grep -qx 'board = bbcmicrobit' "$WORK/tft/platformio.ini" || fail "platformio.ini names another board"
arduino=tests/packages/arduino
: >"$WORK/tft/binary.h"  # no macro of its numbers here
for source in "$WORK/tft/src/main.cpp" $arduino/libraries/Displays/Wires.cpp $arduino/hardware/thimble/arm/cores/stub/main.cpp; do
  object=$WORK/tft/$(basename "${source%/*}").o
  logged arm-none-eabi-g++ $options $(sed -n 's/^build_flags = //p' "$WORK/tft/platformio.ini") -fno-threadsafe-statics -Itests/checks -I"$WORK/tft" \
    -Itests/packages/new -I$arduino/hardware/thimble/arm/cores/stub -I$arduino/libraries/Displays -c "$source" -o "$object"
  echo "$object"
done >"$WORK/tft/objects"
logged arm-none-eabi-g++ $options $(cat "$WORK/tft/objects") $bare_link "$WORK/libthimble.a" -lgcc -o "$WORK/tft.elf"
need qemu-system-arm
shows_scene tft st7735 160x128 color in_qemu arm "$WORK/tft.elf"
same_ball in_qemu arm "$WORK/main.elf"
same_panels in_qemu arm "$WORK/panels.elf"
say "$(wc -l <"$WORK/objects") files compiled by the manifest's rules: the ball is drawn, also on panels"
