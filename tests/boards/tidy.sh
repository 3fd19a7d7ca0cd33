#!/bin/sh
# clang-tidy over the code that runs on boards only, each file once, with a board that uses it. tidy.sh WORK_DIR
set -eu
cd "$(dirname "$0")/../.."
mkdir -p "$1"
work=$(cd "$1" && pwd)
if ! command -v clang-tidy >/dev/null 2>&1; then
  echo "skipped: clang-tidy is not installed"
  exit 77
fi
jobs=$work/jobs
: >"$jobs"
# lint BOARD FILE...
lint() {
  board=$1
  shift
  . platform/board_facts.sh
  case $(fact ARCH)-$(fact CPU) in
    cortex-m-cortex-m0 | cortex-m-cortex-m0plus) target=thumbv6m-none-eabi ;;
    cortex-m-cortex-m3) target=thumbv7m-none-eabi ;;
    cortex-m-*) target=thumbv7em-none-eabi ;;
    riscv-*) target=riscv32-none-elf ;;
    arm11-*) target=armv6k-none-eabi ;;
    arm7-*) target=armv4t-none-eabi ;;
  esac
  cores=
  [ -z "$(fact CORES)" ] || cores=" -DTHIMBLE_CORES=$(fact CORES)"
  cmake -DROOT="$PWD" -DBOARD="$board" -DOUT="$work/$board" -P tests/boards/facts.cmake
  for file; do
    echo "$file -- --target=$target -std=c++20 -Wreserved-identifier -Werror -ffreestanding -fno-exceptions -fno-rtti -Iinclude -Iplatform -Iplatform/arch" \
      "-Iplatform/boards/$board $(printf " -Iplatform/chips/%s" $(fact CHIP)) -I$work/$board -DTHIMBLE_APPLICATION=demo$cores" >>"$jobs"
  done
}
lint lm3s6965evb platform/arch/common/*.cpp platform/arch/cortex-m/*.cpp platform/drivers/*.cpp
lint sifive_e platform/arch/riscv/*.cpp
lint raspi0 platform/arch/arm11/*.cpp
lint gba platform/arch/arm7/*.cpp
# The demonstration as two cores draw it, too.
lint pico platform/chips/rp2040/*.cpp platform/chips/rp2040/lcd/*.cpp platform/apps/demo.cpp
for folder in platform/boards/*/; do
  for file in "$folder"*.cpp; do
    [ ! -f "$file" ] || lint "$(basename "$folder")" "$file"
  done
done
# Registers lie at addresses, so numbers become pointers here.
log=$work/tidy.log
if ! xargs -P 2 -L 1 clang-tidy --quiet --checks=-performance-no-int-to-ptr <"$jobs" >"$log" 2>"$log.noise"; then
  cat "$log"
  grep -E 'error' "$log.noise" || true
  echo "tidy: clang-tidy has complaints about the boards' code" >&2
  exit 1
fi
