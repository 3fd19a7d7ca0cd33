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
logged arm-none-eabi-g++ $options platform/examples/ball/main.cpp $bare_link "$WORK/libthimble.a" -lgcc -o "$WORK/ball.elf"
need qemu-system-arm
same_ball in_qemu arm "$WORK/ball.elf"
say "$(wc -l <"$WORK/objects") files compiled by the manifest's rules: the ball is drawn"
