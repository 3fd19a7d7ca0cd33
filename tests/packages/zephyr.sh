#!/bin/sh
# The module as Zephyr takes it: module.yml and Kconfig read, its CMakeLists.txt run with a stand-in for Zephyr's functions,
# the library, the sample and the ball compiled for a Cortex-M3; the sample's first frame is drawn in both orders of bytes.
name=zephyr
. tests/packages/common.sh
need cmake ninja arm-none-eabi-g++
unpack "thimble-zephyr-$VERSION.tar.gz"
module=$WORK/thimble
$python tests/packages/zephyr/module.py "$module" >"$WORK/module" || fail "the module's files are not as Zephyr wants them"
. "$WORK/module"
bare arm
logged cmake -S tests/packages/zephyr -B "$WORK/build" -G Ninja -DCMAKE_SYSTEM_NAME=Generic -DCMAKE_BUILD_TYPE=None \
  -DCMAKE_CXX_COMPILER=arm-none-eabi-g++ -DCMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY -DCONFIG_THIMBLE=y \
  -DCMAKE_CXX_FLAGS="$arm_options" -DMODULE="$module/$module_cmake" -DSAMPLE="$module/$module_sample" \
  -DBARE="$PWD/tests/packages/bare/arm.ld;$WORK/bare_start.o;$WORK/bare_memory.o"
logged cmake --build "$WORK/build" -- -j1
need qemu-system-arm
same_ball in_qemu arm "$WORK/build/ball"
no_drivers "$WORK/build/ball"
same_panels in_qemu arm "$WORK/build/panels"
for order in RGB_565 BGR_565 RGB_888; do
  in_qemu arm "$WORK/build/sample_$order" </dev/null >"$WORK/$order.shown" 2>"$WORK/$order.err" ||
    fail "the sample ends with $? on a display with $order: $(tail -n 1 "$WORK/$order.shown")"
done
# High byte first, low byte first: the same pixels.
sed 's/\(..\)\(..\)/\2\1/g' "$WORK/BGR_565.shown" | cmp - "$WORK/RGB_565.shown" || fail "the orders of bytes show two pictures"
[ "$(sort -u "$WORK/RGB_888.shown" | wc -l)" -gt 8 ] || fail "the sample shows no ball"
in_qemu arm "$WORK/build/sample_MONO01" </dev/null >"$WORK/mono.shown" 2>"$WORK/mono.err" && fail "a display that the sample does not draw on is taken"
grep -q 'RGB_565 and RGB_888' "$WORK/mono.shown" || fail "on another display the sample says: $(cat "$WORK/mono.shown")"
say "module.yml, Kconfig, CMake and the sample: the ball is drawn, also on panels"
