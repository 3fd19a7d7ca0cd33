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
# same ball|panels COMMAND...: prints, character by character, what that program printed with the library of this tree.
same() {
  said=$WORK/$1 right=$PACKAGES/../test-packages/$1.txt
  shift
  status=0
  "$@" </dev/null >"$said.txt" 2>"$said.err" || status=$?
  # A UART is a terminal's: some send a carriage return with each line.
  tr -d '\r' <"$said.txt" >"$said.plain"
  [ $status = 0 ] && cmp -s "$said.plain" "$right" || {
    head -n 40 "$said.plain" "$said.err" >&2
    fail "the $(basename "$said") prints something else (exit status $status): $*"
  }
}
# same_ball COMMAND...: the program of the README. same_panels COMMAND...: its ball by the drivers of two panels.
same_ball() { same ball "$@"; }
same_panels() { same panels "$@"; }
# no_drivers FILE: a program that draws on no panel holds nothing of their drivers.
no_drivers() {
  nm -C "$1" >"$WORK/symbols" && [ -s "$WORK/symbols" ] || fail "$1 has no symbols"
  ! grep -m 3 'thimble::drivers::' "$WORK/symbols" >&2 || fail "$1 holds drivers that it does not use"
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
# project NAME OPTION...: what `thimble new` writes, in WORK/NAME.
project() {
  place=$WORK/$1
  shift
  logged build/release/thimble new "$place" "$@" --quiet
}
# shows_scene NAME PANEL WxH ink|color COMMAND...: what that command sends to the panel is the picture that this machine
# draws of the project's scene.h.
shows_scene() {
  place=$WORK/$1 panel=$2 size=$3 shade=$4 ending=$([ "$4" = ink ] && echo pbm || echo ppm)
  shift 4
  "$@" </dev/null >"$place.wires" 2>"$place.err" || fail "the project $(basename "$place") ends with $?"
  tr -d '\r' <"$place.wires" | "$PACKAGES/../test-packages/panel" "$panel" >"$place.$ending" || fail "$panel takes not what $place sends"
  header=$(ls "$place/scene.h" "$place/src/scene.h" 2>/dev/null || true)
  $python -c 'import sys; text = open(sys.argv[1]).read().rpartition("{")[2].partition("}")[0]
sys.stdout.buffer.write(bytes(int(word) for word in text.split(",") if word.strip()))' "$header" >"$place.oct"
  logged build/release/thimble render "$place.oct" --size "$size" --shade "$shade" --quiet -o "$place.right.$ending"
  # 565 loses up to 7 of 255.
  $python -c 'import sys; one, other = (open(name, "rb").read() for name in sys.argv[1:3])
sys.exit(len(one) != len(other) or any(abs(a - b) > 7 for a, b in zip(one, other)))' "$place.$ending" "$place.right.$ending" ||
    fail "$panel shows another picture of $(basename "$place") than this machine draws"
}
