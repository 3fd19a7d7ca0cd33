#!/bin/sh
# The pair, dropped into a project: gcc and clang in both dialects, a chip; warnings are errors. One translation unit of
# a user's includes the header twice. Drivers of panels are files beside it, which a program that draws on none leaves out.
name=pair
. tests/packages/common.sh
unpack "thimble-pair-$VERSION.zip" . zipfile
[ "$(find "$WORK/thimble" -type f | wc -l)" -ge 4 ] || fail "files are missing"
warnings='-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror'
for compiler in g++ clang++; do
  command -v $compiler >/dev/null 2>&1 || {
    say "skipped for $compiler: it is not installed"
    continue
  }
  logged $compiler -std=c++17 -O1 $warnings -I"$WORK" -c "$WORK/thimble/thimble.cpp" -o "$WORK/thimble.o"
  logged $compiler -std=c++17 -O1 $warnings -I"$WORK" "$WORK/thimble.o" platform/examples/ball/main.cpp -o "$WORK/ball"
  same_ball "$WORK/ball"
  no_drivers "$WORK/ball"
  logged $compiler -std=c++17 -O1 $warnings -I"$WORK" "$WORK/thimble.o" "$WORK/thimble/drivers/"*.cpp \
    tests/packages/panels.cpp -o "$WORK/panels"
  same_panels "$WORK/panels"
  logged $compiler -std=gnu++17 -fsyntax-only $warnings -I"$WORK" "$WORK/thimble/thimble.cpp" "$WORK/thimble/drivers/"*.cpp
  # All that is public is in it: a program that wants light, water, particles and brick frames by name.
  logged $compiler -std=c++17 -fsyntax-only $warnings -I"$WORK" tests/packages/all_public.cpp
done
if [ -f "$WORK/thimble/thimble_c.h" ]; then
  printf '#include "thimble/thimble_c.h"\nint main(void) { return 0; }\n' >"$WORK/face.c"
  logged gcc -std=c99 $warnings -I"$WORK" -c "$WORK/face.c" -o "$WORK/face.o"
fi
if command -v arm-none-eabi-g++ >/dev/null 2>&1; then
  bare arm
  logged arm-none-eabi-g++ -std=gnu++17 $arm_options -I"$WORK" -c "$WORK/thimble/thimble.cpp" -o "$WORK/thimble.o"
  logged arm-none-eabi-g++ -std=gnu++17 $arm_options -I"$WORK" "$WORK/thimble.o" platform/examples/ball/main.cpp \
    $bare_link -lgcc -o "$WORK/ball.elf"
  logged arm-none-eabi-g++ -std=gnu++17 $arm_options -I"$WORK" "$WORK/thimble.o" "$WORK/thimble/drivers/"*.cpp \
    tests/packages/panels.cpp $bare_link -lgcc -o "$WORK/panels.elf"
  if command -v qemu-system-arm >/dev/null 2>&1; then
    same_ball in_qemu arm "$WORK/ball.elf"
    same_panels in_qemu arm "$WORK/panels.elf"
  fi
else
  say "skipped for arm-none-eabi-g++: it is not installed"
fi
say "two files, gcc, clang and a Cortex-M3: the ball is drawn; with the drivers beside them also on panels"
