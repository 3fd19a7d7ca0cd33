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
need qemu-system-arm
same_ball in_qemu arm "$WORK/main.elf"
same_panels in_qemu arm "$WORK/panels.elf"
say "$(wc -l <"$WORK/objects") files compiled by the manifest's rules: the ball is drawn, also on panels"
