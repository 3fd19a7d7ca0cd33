# What the tests of the packages share; each sets `name` and reads this from the root of the tree.
# PACKAGES: where the archives lie; WORK: an empty folder for this test; VERSION: what they must say.
set -eu
# Debian's modules belong to Debian's interpreter.
python=/usr/bin/python3
[ -x $python ] || python=python3
export PYTHONDONTWRITEBYTECODE=1
fail() {
  echo "$name: FAILED: $1" >&2
  exit 1
}
say() {
  echo "$name: $1"
}
# need COMMAND...: the test is skipped where one is missing.
need() {
  for tool in "$@"; do
    command -v "$tool" >/dev/null 2>&1 || {
      say "skipped: there is no $tool"
      exit 0
    }
  done
}
# unpack ARCHIVE [FOLDER]: into an empty folder.
unpack() {
  mkdir -p "$WORK/${2:-.}"
  $python -m "${3:-tarfile}" -e "$PACKAGES/$1" "$WORK/${2:-.}" || fail "$1 does not unpack"
}
# logged COMMAND...: prints what it said only where it fails.
logged() {
  "$@" >"$WORK/log" 2>&1 || {
    tail -n 30 "$WORK/log" >&2
    fail "$*"
  }
}
# same_ball COMMAND...: prints the ball of the README, character by character what the library of this tree printed.
same_ball() {
  status=0
  "$@" </dev/null >"$WORK/ball.txt" 2>"$WORK/ball.err" || status=$?
  # A UART is a terminal's: some send a carriage return with each line.
  tr -d '\r' <"$WORK/ball.txt" >"$WORK/ball.plain"
  [ $status = 0 ] && cmp -s "$WORK/ball.plain" "$PACKAGES/../test-packages/ball.txt" || {
    head -n 40 "$WORK/ball.plain" "$WORK/ball.err" >&2
    fail "the ball is another one (exit status $status): $*"
  }
}
chip_options='-ffreestanding -ffunction-sections -fdata-sections -fno-exceptions -fno-rtti -Wall -Wextra -Werror'
arm_options="-mcpu=cortex-m3 -mthumb -Os $chip_options"
riscv_options="-march=rv32imc -mabi=ilp32 -mcmodel=medany -Os $chip_options"
# bare arm|riscv: what a program for that chip is linked with, as objects in WORK.
bare() {
  case $1 in
    arm) bare_cxx="arm-none-eabi-g++ $arm_options" ;;
    riscv) bare_cxx="riscv64-unknown-elf-g++ $riscv_options" ;;
  esac
  for source in tests/packages/bare/start.cpp platform/arch/common/memory.cpp; do
    logged $bare_cxx -std=c++17 -fno-tree-loop-distribute-patterns -c $source -o "$WORK/bare_$(basename $source .cpp).o"
  done
  bare_link="-nostdlib -Wl,--gc-sections -T tests/packages/bare/$1.ld $WORK/bare_start.o $WORK/bare_memory.o"
}
in_qemu() {
  case $1 in
    arm) timeout 60 qemu-system-arm -M lm3s6965evb -semihosting -display none -monitor none -serial stdio -kernel "$2" ;;
    riscv) timeout 60 qemu-system-riscv32 -M virt -bios none -display none -monitor none -serial stdio -kernel "$2" ;;
  esac
}
