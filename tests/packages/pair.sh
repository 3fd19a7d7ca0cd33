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
# Where size_t and uint32_t are one type, and where they are not.
for compiler in arm-linux-gnueabihf-g++ i686-linux-gnu-g++ 'clang++ --target=armv6m-none-eabi' \
  'clang++ --target=armv7m-none-eabi'; do
  command -v "${compiler%% *}" >/dev/null 2>&1 || {
    say "skipped for $compiler: it is not installed"
    continue
  }
  logged $compiler -std=c++17 -ffreestanding -fsyntax-only $warnings -I"$WORK" "$WORK/thimble/thimble.cpp"
done
# An Uno's owner reads what is the matter before anything else.
if command -v clang++ >/dev/null 2>&1; then
  for header in thimble.h thimble_c.h; do
    echo "#include \"thimble/$header\"" | clang++ --target=avr -mmcu=atmega328p -std=c++17 -ffreestanding -fsyntax-only \
      -I"$WORK" -x c++ - >"$WORK/log" 2>&1 && fail "$header compiles for AVR"
    grep -m 1 'error:' "$WORK/log" | grep -q 'AVR is not supported: int has 16 bits' || fail "$header says for AVR: $(cat "$WORK/log")"
  done
fi
# Two files that keep a function of one name to themselves make no pair.
$python - <<'EOF' || fail "equal names of two files are taken"
import sys
sys.path.insert(0, "tools/packages")
import pair
one = b"namespace thimble {\nnamespace {\nvoid put(int* to) {\n}\n}  // namespace\n}  // namespace thimble\n"
other = b"namespace thimble {\nnamespace {\n[[gnu::noinline]] uint8_t* put(char* to) {\n}\n}  // namespace\n}  // namespace thimble\n"
try:
    pair.refuse_equal_names({"a.cpp": one, "b.cpp": other})
except SystemExit:
    pair.refuse_equal_names({"a.cpp": one, "b.cpp": other.replace(b"put", b"get")})
else:
    raise SystemExit(1)
EOF
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
