#!/bin/sh
# platform/examples as somebody else would build them, with their own flags. On this machine they draw, where a baked
# scene's picture must be the command's own; for chips they compile.
# examples.sh WORK_DIR [TARGET...]     TARGETs: host cortex-m0 rv32 (default: all)
set -eu
cd "$(dirname "$0")/../.."
work=$1
shift
targets=${*:-host cortex-m0 rv32}
thimble=${THIMBLE:-build/release/thimble}
library=${LIBTHIMBLE:-build/release/libthimble.a}
core='-std=c++20 -ffreestanding -fno-exceptions -fno-rtti -fno-threadsafe-statics -ffunction-sections -fdata-sections
  -Iinclude -Wall -Wextra -Wpedantic -Werror'
# C programs have more flags: the header's own words go through their compiler.
c99='-std=c99 -ffreestanding -ffunction-sections -fdata-sections -Iinclude -Wall -Wextra -Wpedantic -Wconversion
  -Wsign-conversion -Wshadow -Wundef -Wcast-align -Wstrict-prototypes -Wmissing-prototypes -Werror'
fail() {
  echo "examples: FAILED: $1" >&2
  exit 1
}
names=$(cd platform/examples && for folder in */; do echo "${folder%/}"; done)
for source in ball/main.cpp c_scene/main.c; do
  lines=$(grep -c '' "platform/examples/$source")
  [ "$lines" -le 40 ] || fail "$source has grown to $lines lines"
done

# bake NAME SCENE [OPTION...]: scene.h for that example, and the same as a file.
bake() {
  name=$1
  shift
  mkdir -p "$work/$name"
  for ending in h oct; do
    "$thimble" bake "$@" --size 128x64 -o "$work/$name/scene.$ending" --quiet 2>/dev/null
  done
}
bake baked_scene tools/gallery/scenes/castle.vox --effects none
bake panels tools/gallery/scenes/castle.vox --effects none
bake c_panels tools/gallery/scenes/castle.vox --effects none
bake lit_room tools/gallery/scenes/room.scene
bake c_scene tools/gallery/scenes/castle.vox --effects none

# grays FILE: how many greys a picture of 8192 bytes has.
grays() {
  tail -c 8192 "$1" | od -An -v -tu1 -w1 | sort -u | grep -c .
}
# like NAME MOST OPTION...: the example's picture is that of `thimble render`, to MOST of 255.
like() {
  name=$1
  most=$2
  shift 2
  "$thimble" render "$work/$name/scene.oct" --size 128x64 "$@" -o "$work/$name/command.pgm" --quiet 2>/dev/null
  cmp -l "$work/$name/picture.pgm" "$work/$name/command.pgm" | awk -v most="$most" '
    function octal(text,   i, value) { for (i = 1; i <= length(text); i++) { value = value * 8 + substr(text, i, 1) } return value }
    { difference = octal($2) - octal($3); if (difference < -most || difference > most) { worse++ } }
    END { if (worse > 0) { print worse " pixels differ by more than " most; exit 1 } }' >&2 ||
    fail "$name draws another picture than the command"
}

# panels NAME: what the models of the panels show: lit where the command's dither is, and its colours but for what 565 loses.
panels() {
  "$thimble" render "$work/$1/scene.oct" --size 128x64 --shade color -o "$work/$1/command.pbm" --quiet 2>/dev/null
  cmp "$work/$1/ssd1306.pbm" "$work/$1/command.pbm" || fail "$1: the SSD1306 shows another picture"
  "$thimble" render "$work/$1/scene.oct" --size 240x240 --shade color -o "$work/$1/command.ppm" --quiet 2>/dev/null
  worse=$(cmp -l "$work/$1/st7789.ppm" "$work/$1/command.ppm" | awk '
    function octal(text,   i, value) { for (i = 1; i <= length(text); i++) { value = value * 8 + substr(text, i, 1) } return value }
    { difference = octal($2) - octal($3); if (difference < -7 || difference > 7) { worse++ } } END { print worse + 0 }')
  [ "$worse" = 0 ] || fail "$1: $worse channels of the ST7789 are not the command's"
}

# compile PREFIX FLAGS NAME OBJECT: by g++, or by gcc what is written in C.
compile() {
  compiler=$1g++ source=platform/examples/$3/main.cpp flags="$core ${1:+-nostdinc++}"
  if [ -f "platform/examples/$3/main.c" ]; then
    compiler=$1gcc source=platform/examples/$3/main.c flags=$c99
  fi
  # shellcheck disable=SC2086
  $compiler $flags $2 -I"$work/$3" -c "$source" -o "$4" || fail "$3 does not compile with $compiler"
}
# c_draws_as_cpp: the C program's frames are those of the C++ one, at rest and moved; clang compiles it, too.
c_draws_as_cpp() {
  if command -v clang >/dev/null 2>&1; then
    # shellcheck disable=SC2086
    clang $c99 -O2 -I"$work/c_scene" -c platform/examples/c_scene/main.c -o "$work/c_scene/clang.o" ||
      fail "c_scene does not compile with clang"
  else
    echo "examples: c_scene was not compiled with clang, which is not installed"
  fi
  for frames in 1 5; do
    for name in c_scene baked_scene; do
      "$work/$name/run" $frames >"$work/$name/$frames.pgm" || fail "$name ends with status $?"
    done
    cmp "$work/c_scene/$frames.pgm" "$work/baked_scene/$frames.pgm" || fail "c_scene draws another frame $frames than baked_scene"
  done
  ! cmp -s "$work/c_scene/1.pgm" "$work/c_scene/5.pgm" || fail "the eye of c_scene does not move"
  name=c_scene
}
for target in $targets; do
  for name in $names; do
    mkdir -p "$work/$name"
    object=$work/$name/$target.o
    case $target in
      cortex-m0) compile arm-none-eabi- '-mcpu=cortex-m0 -mthumb -Os' "$name" "$object" ;;
      rv32)
        compile riscv64-unknown-elf- '-march=rv32imac -misa-spec=2.2 -mabi=ilp32 -Os' "$name" "$object"
        ;;
      host)
        compile '' -O2 "$name" "$object"
        display=platform/examples/display_host.cpp
        case $name in
          ball) display= ;;
          panels | c_panels)
            display="tests/boards/panels_host.cpp tests/support/page_model.cpp tests/support/color_model.cpp"
            ;;
        esac
        g++ -std=c++20 -O1 -Iinclude -Iplatform -Itests -o "$work/$name/run" "$object" $display "$library"
        case $name in
          panels | c_panels)
            (cd "$work/$name" && ./run) || fail "$name ends with status $?"
            panels "$name"
            continue
            ;;
        esac
        frames=1
        case $name in particles | water) frames=40 ;; esac
        "$work/$name/run" $frames >"$work/$name/picture.pgm" || fail "$name ends with status $?"
        case $name in
          ball) [ "$(grep -c '[*#]' "$work/ball/picture.pgm")" -gt 16 ] || fail "ball draws none" ;;
          particles) [ "$(grays "$work/particles/picture.pgm")" = 2 ] || fail "particles draws no balls" ;;
          water) [ "$(grays "$work/water/picture.pgm")" -ge 8 ] || fail "water draws no water" ;;
          # 16 greys are 17 apart: plain pictures take the nearest, lit ones are dithered.
          baked_scene) like baked_scene 9 --shade color ;;
          c_scene) c_draws_as_cpp ;;
          lit_room) like lit_room 17 --effects auto ;;
        esac
        ;;
      *) fail "no such target: $target" ;;
    esac
  done
done
echo "examples:" $names: drawn as they should be or compiled for $targets
