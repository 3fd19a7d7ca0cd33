#!/bin/sh
# Compiles the core for TARGET and judges the objects: symbols (symbols.sh) and the worst stack (stack_bound).
# core_on.sh TARGET ROOT WORK_DIR STACK_BOUND STACK_CSV
set -eu
here=$(cd "$(dirname "$0")" && pwd)
target=$1
work=$3
stack_bound=$4
budgets=$5
cd "$2"
bare='-Os -ffreestanding -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit -fno-unwind-tables
  -fno-asynchronous-unwind-tables -ffunction-sections -fdata-sections'
case $target in
  host)
    prefix=
    flags='-O2 -ffreestanding -fno-exceptions -fno-rtti -fno-threadsafe-statics'
    [ "$(uname -m)" = x86_64 ] && flags="$flags -mpopcnt"
    ;;
  cortex-m0 | cortex-m3) prefix=arm-none-eabi- flags="-mcpu=$target -mthumb $bare" ;;
  rv32)
    prefix=riscv64-unknown-elf-
    flags="-march=rv32imac -misa-spec=2.2 -mabi=ilp32 -mcmodel=medany -msmall-data-limit=0 $bare"
    ;;
  *)
    echo "core_on: no such target: $target" >&2
    exit 2
    ;;
esac
if ! command -v ${prefix}g++ >/dev/null 2>&1; then
  echo "skipped: ${prefix}g++ is not installed"
  exit 77
fi
rm -rf "$work"
mkdir -p "$work"
# A compiler cache would hand out objects without their call graphs.
export CCACHE_DISABLE=1
# Without -fno-ipa-icf two equal functions share a body and one of them vanishes from the call graph.
for source in $(find src -name '*.cpp' | sort); do
  object=$(echo "${source#src/}" | tr / _)
  if ! ${prefix}g++ -std=c++17 -Wpedantic $flags -fno-ipa-icf -fcallgraph-info=su,da -Wall -Wextra -Werror -nostdinc++ -Iinclude \
    -c "$source" -o "$work/${object%.cpp}.o"; then
    echo "core_on: $source does not compile for $target" >&2
    exit 1
  fi
done
# A driver calls the board's functions, by pointers that it is given; whoever wrote those knows their stack.
for graph in "$work"/drivers_*.ci; do
  [ ! -f "$graph" ] || sed -i '/targetname: "__indirect_call"/d' "$graph"
done
failed=0
sh "$here/symbols.sh" "$prefix" "$here/symbols_$target.txt" "$work"/*.o || failed=1
echo "code and constants on $target, bytes:"
${prefix}size -t "$work"/*.o
"$stack_bound" "$target" "$budgets" "$work"/*.ci || failed=1
# Whole programs, where the tree has some.
if [ -n "$prefix" ] && [ -f tests/budgets/c_programs.csv ]; then
  # shellcheck disable=SC2086
  sh "$here/c_programs.sh" "$target" "$prefix" "$work" "$stack_bound" $flags || failed=1
fi
exit $failed
