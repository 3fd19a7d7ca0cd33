#!/bin/sh
# The component in a project of ours whose idf_component_register is a stand-in with IDF's rules: read once without a
# project, where it must leave at once, then compiled for RV32IMC (ESP32-C3) and linked with the ball, and with
# the ball on panels.
name=esp_idf
. tests/packages/common.sh
need cmake ninja riscv64-unknown-elf-g++
unpack "thimble-esp-idf-$VERSION.tar.gz" components
logged cmake -DESP_PLATFORM=1 -DCOMPONENT="$WORK/components/thimble" -P tests/packages/esp-idf/early.cmake
grep -q 'thimble registers' "$WORK/log" || fail "without a project it registers nothing"
bare riscv
logged cmake -S tests/packages/esp-idf -B "$WORK/build" -G Ninja -DCMAKE_SYSTEM_NAME=Generic -DCMAKE_BUILD_TYPE=None \
  -DCMAKE_CXX_COMPILER=riscv64-unknown-elf-g++ -DCMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY -DESP_PLATFORM=1 \
  -DCMAKE_CXX_FLAGS="$riscv_options" -DCOMPONENT="$WORK/components/thimble" \
  -DBARE="$PWD/tests/packages/bare/riscv.ld;$WORK/bare_start.o;$WORK/bare_memory.o"
logged cmake --build "$WORK/build" -- -j1
need qemu-system-riscv32
same_ball in_qemu riscv "$WORK/build/ball"
no_drivers "$WORK/build/ball"
same_panels in_qemu riscv "$WORK/build/panels"
say "registered twice as IDF does, compiled for rv32imc: the ball is drawn, also on panels"
