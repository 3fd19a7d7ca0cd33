#!/bin/sh
# Judges an image by what it takes and what is in it: budget.sh BOARD APP LOG. LOG is what it said when it ran.
# Prints a line; exit status 1 for growth past tests/budgets/firmware.csv and for code that must not be in an image.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
board=$1
app=$2
log=$3
work=$THIMBLE_FIRMWARE/$board
measured=$THIMBLE_FIRMWARE/$board.measured
. platform/board_facts.sh
case $(fact ARCH) in riscv) prefix=riscv64-unknown-elf- ;; *) prefix=arm-none-eabi- ;; esac
failed=0
complain() {
  echo "FAILED: $*"
  failed=1
}

# Heap, floating point on Arm and by its common names, 64-bit division: by the names of those who do it.
symbols=$work/$app.symbols
"${prefix}nm" "$work/$app.elf" | awk '{ print $NF }' >"$symbols"
forbidden='_*(malloc|calloc|realloc|free|sbrk)(_r)?|_Z(n[wa]|d[la]).*'
forbidden="$forbidden|__aeabi_c?[df](add|sub|rsub|mul|div|cmp.*|2.*)|__aeabi_u?[il]2[df]"
forbidden="$forbidden|__(add|sub|mul|div|neg|eq|ne|lt|le|gt|ge|unord)[sdt]f[23]|__(float|fix|extend|trunc)[a-z]*[sdt][if].*"
forbidden="$forbidden|__aeabi_u?ldivmod|__u?(div|mod|divmod)[dt]i[34]"
found=$(grep -Ex "$forbidden" "$symbols" | tr '\n' ' ' || true)
[ -z "$found" ] || complain "the image holds $found"

IFS=, read -r _ _ flash ram stack _ <"$work/$app.memory.csv"
painted=$(sed -n 's/^stack: \([0-9]*\) of [0-9]* bytes used.*/\1/p' "$log" | tail -n 1)
graphs=$(find "$work/CMakeFiles/$app.dir" "$work"/CMakeFiles/thimble*.dir "$work/src" -name '*.ci')
bound_log=$work/$app.stack
# A second core has a stack of its own, and no interrupts.
other=
grep -qx thimble_second_core "$symbols" && other=,thimble_second_core
if "$THIMBLE_FIRMWARE/stack_bound" --image "thimble_run$other" thimble_systick "$symbols" $graphs >"$bound_log" 2>"$bound_log.err"; then
  bound=$(head -n 1 "$bound_log")
else
  bound=0
  complain "no bound of the stack: $(head -n 3 "$bound_log.err" | tr '\n' ' ')"
fi
[ -n "$painted" ] || { painted=0 && complain "it did not say how much stack it used"; }
[ "$painted" -le "$bound" ] || complain "used $painted bytes of stack, more than the bound $bound"
[ "$bound" -le "$stack" ] || complain "may need $bound bytes of stack, the board keeps $stack"
if [ -n "$other" ]; then
  core_painted=$(sed -n "s/^second core's stack: \([0-9]*\) of [0-9]* bytes used.*/\1/p" "$log" | tail -n 1)
  core_kept=$(sed -n "s/^second core's stack: [0-9]* of \([0-9]*\) bytes used.*/\1/p" "$log" | tail -n 1)
  core_bound=0
  if "$THIMBLE_FIRMWARE/stack_bound" --image thimble_second_core,thimble_run none "$symbols" $graphs >"$bound_log.core" 2>"$bound_log.err"; then
    core_bound=$(head -n 1 "$bound_log.core")
  else
    complain "no bound of the second core's stack: $(head -n 3 "$bound_log.err" | tr '\n' ' ')"
  fi
  [ "${core_painted:-0}" -gt 0 ] || complain "it did not say how much stack the second core used"
  [ "${core_painted:-0}" -le "$core_bound" ] || complain "the second core used $core_painted bytes of stack, more than the bound $core_bound"
  [ "$core_bound" -le "${core_kept:-0}" ] || complain "the second core may need $core_bound bytes of stack, it has $core_kept"
  # No budget of its own: it does a part of what the first does.
  [ "$core_bound" -le "$bound" ] || complain "the second core may need $core_bound bytes of stack, the first $bound"
fi
echo "$board,$app,$flash,$ram,$bound,$painted" >>"$measured"

row=$(grep "^$board,$app," tests/budgets/firmware.csv || true)
if [ "${UPDATE:-0}" = 0 ]; then
  if [ -z "$row" ]; then
    complain "has no row in tests/budgets/firmware.csv (tests/boards/run.sh --budgets writes it)"
  else
    IFS=, read -r _ _ most_flash most_ram most_bound most_painted <<ROW
$row
ROW
    [ "$flash" -le "$most_flash" ] || complain "flash: $flash bytes, budget $most_flash"
    [ "$ram" -le "$most_ram" ] || complain "data and bss: $ram bytes, budget $most_ram"
    [ "$bound" -le "$most_bound" ] || complain "bound of the stack: $bound bytes, budget $most_bound"
    [ "$painted" -le "$most_painted" ] || complain "stack used: $painted bytes, budget $most_painted"
  fi
fi
echo "flash $flash, data and bss $ram, stack $painted used, $bound at most, $stack kept${other:+; second core: $core_painted used, $core_bound at most}"
exit $failed
