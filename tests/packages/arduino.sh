#!/bin/sh
# The library as the Arduino IDE builds it, by its builder: both examples, and as sketches the README's ball and one that
# draws it by the library's drivers, compiled with a platform of ours, run on a Cortex-M3 of QEMU; the pictures are those that this machine draws ray by ray.
name=arduino
. tests/packages/common.sh
need arduino-builder arm-none-eabi-g++
unpack "thimble-arduino-$VERSION.zip" libraries zipfile
here=tests/packages/arduino
cp -R $here/hardware $here/libraries "$WORK/"
core=$WORK/hardware/thimble/arm/cores/stub
cp tests/checks/arduino_macros.h tests/packages/new/wires.h tests/packages/bare/start.cpp tests/packages/bare/arm.ld platform/arch/common/memory.cpp "$core/"
sh tests/checks/binary_macros.sh >"$core/binary.h"
mkdir -p "$WORK/tools"
# sketch NAME PROGRAM: a program of ours as a sketch.
sketch() {
  mkdir -p "$WORK/sketches/$1"
  printf 'int program();\nvoid setup() { exit(program()); }\nvoid loop() {}\n' >"$WORK/sketches/$1/$1.ino"
  { printf '#include <thimble.h>\n#define main program\n'; cat "$2"; } >"$WORK/sketches/$1/program.cpp"
}
sketch Ball platform/examples/ball/main.cpp
sketch Panels tests/packages/panels.cpp
cp -R "$WORK/libraries/thimble/examples/SSD1306" "$WORK/libraries/thimble/examples/ST7789" "$WORK/sketches/"
project sketches/Oled --board pico --panel ssd1306 --build arduino castle

# One place for all, so that the library is compiled once.
all=$(cd "$WORK" && pwd)
mkdir -p "$all/build" "$all/sketches/Sketch"
for sketch in SSD1306 ST7789 Ball Panels Oled; do
  rm -f "$all/sketches/Sketch/"*
  cp "$all/sketches/$sketch/"* "$all/sketches/Sketch/"
  mv "$all/sketches/Sketch/$sketch.ino" "$all/sketches/Sketch/Sketch.ino"
  logged arduino-builder -compile -hardware /usr/share/arduino-builder -hardware "$all/hardware" -tools "$all/tools" \
    -libraries "$all/libraries" -fqbn thimble:arm:m3 -ide-version 10819 -warnings all -build-path "$all/build" \
    "$all/sketches/Sketch/Sketch.ino"
  cp "$all/build/Sketch.ino.elf" "$all/$sketch.elf"
  grep -hE '^Sketch uses|^Global variables' "$WORK/log" | sed "s/^/$name: $sketch: /" || true
done
command -v qemu-system-arm >/dev/null 2>&1 || {
  say "skipped: nothing runs, for there is no qemu-system-arm"
  exit 0
}
same_ball in_qemu arm "$all/Ball.elf"
no_drivers "$all/Ball.elf"
same_panels in_qemu arm "$all/Panels.elf"
shows_scene sketches/Oled ssd1306 128x64 ink in_qemu arm "$all/Oled.elf"
for sketch in SSD1306 ST7789; do
  color=$([ $sketch = ST7789 ] && echo true || echo false)
  logged g++ -std=c++20 -O1 -Iinclude -I"$WORK/sketches/$sketch" -DEXPECTED_COLOR=$color $here/expected.cpp "$LIBTHIMBLE" -o "$WORK/expected"
  "$WORK/expected" >"$WORK/$sketch.expected" || fail "the scene of $sketch draws nothing"
  in_qemu arm "$all/$sketch.elf" </dev/null >"$WORK/$sketch.shown" 2>"$WORK/$sketch.err" || fail "$sketch ends with $?: $(tail -n 1 "$WORK/$sketch.shown")"
  cmp "$WORK/$sketch.expected" "$WORK/$sketch.shown" || fail "$sketch shows another picture than this machine draws"
done
say "the ball, both examples, the drivers and a project of thimble new, built by arduino-builder, show what they should"
