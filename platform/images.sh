#!/bin/sh
# Builds the programs that `thimble image` puts scenes behind, into build/images (images/README.md): for each board those
# applications, each with the sets of effects for which its flash has room.
#   images.sh [BOARD...]
# In the environment: IMAGES is another folder, PROGRAMS="demo-sun..." builds these alone.
set -eu
cd "$(dirname "$0")/.."
images=${IMAGES:-build/images}
mkdir -p "$images"
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/image-programs}" PLACE=flash
unset HOLD HOLD_FPS EFFECTS BAKE
# What a program shows where there is no sound scene: small, so that the flash is the scene's. That of water has some.
mkdir -p "$THIMBLE_FIRMWARE"
cat >"$THIMBLE_FIRMWARE/pond.scene" <<'TEXT'
depth 4
camera eye 26 -16 20 target 8 8 3 fov 40
sun toward 6 -5 9
material floor color 190 180 160
box floor from 0 0 0 to 16 16 2
box floor from 0 14 2 to 16 16 9
water level 4 floor 2 color 84 176 190 index 1.333 density 0.05
TEXT
# Sets of effects: direct light and shadows with what traces no rays of its own; all that there are.
set_of() {
  case $1 in plain) echo 0 ;; sun) echo 0x3f0b ;; all) echo 0x7fff ;; esac
}
# The least that a program may leave for a scene.
least=8192
# program BOARD APPS SET SCENE EFFECTS
program() {
  case " ${PROGRAMS:-$2-$3} " in *" $2-$3 "*) ;; *) return 0 ;; esac
  name=$1-$(echo "$2" | tr ';' '-')-$3
  work=$THIMBLE_FIRMWARE/$1
  apps=$2
  set=$3
  scene=$THIMBLE_FIRMWARE/$name.h
  build/release/thimble bake "$4" --board "$board" --effects "$5" --quiet -o "$scene"
  if ! WITHIN=$(set_of "$3") sh platform/build.sh "$1" "$2" "$scene" >"$THIMBLE_FIRMWARE/$name.log" 2>&1; then
    # Too large for the flash is no fault: there is no such image then.
    grep -q 'larger than the flash\|overflowed by' "$THIMBLE_FIRMWARE/$name.log" || { cat "$THIMBLE_FIRMWARE/$name.log" >&2 && exit 1; }
    return 0
  fi
  for app in $(echo "$apps" | tr ';' ' '); do
    IFS=, read -r _ _ flash _ <"$work/$app.memory.csv"
    [ $(($(fact FLASH_BYTES) - flash)) -ge $least ] || continue
    cp "$work/$app.elf" "$images/$1-$app-$set.elf"
    "$prefix"strip "$images/$1-$app-$set.elf"
    chmod 644 "$images/$1-$app-$set.elf"
    gzip -9nf "$images/$1-$app-$set.elf"
  done
}
for board in ${*:-$(cd platform/boards && echo */board.cmake | sed 's,/board\.cmake,,g')}; do
  . platform/board_facts.sh
  case $(fact ARCH) in riscv) prefix=riscv64-unknown-elf- ;; *) prefix=arm-none-eabi- ;; esac
  rm -f "$images/$board"-demo-* "$images/$board"-dig-* "$images/$board"-water-*
  # Worlds that change, water among them, lie in RAM, of which 8 KiB hold none.
  changing=$([ "$(fact RAM_BYTES)" -ge 16384 ] && echo ';dig' || true)
  program "$board" "demo$changing" plain demo,depth=4 none
  program "$board" demo sun demo,depth=4 none
  program "$board" demo all demo,depth=4 none
  [ -z "$changing" ] || program "$board" water all "$THIMBLE_FIRMWARE/pond.scene" direct-light,shadows,water,ripples
done
echo "images: $(ls "$images" | wc -l) programs, $(cat "$images"/* | wc -c) bytes, in $images"
