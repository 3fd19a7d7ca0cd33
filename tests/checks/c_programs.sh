#!/bin/sh
# What whole programs in C take: links each of tests/c/programs with the core's objects that core_on.sh has made, and
# holds flash and stack to tests/budgets/c_programs.csv; no program may hold what it does not call. Run by core_on.sh:
# c_programs.sh TARGET PREFIX OBJECT_DIR STACK_BOUND FLAGS...     in the tree; UPDATE=1 prints the table instead
set -eu
target=$1
prefix=$2
objects=$3
stack_bound=$4
shift 4
budgets=tests/budgets/c_programs.csv
work=$objects/programs
failed=0
complain() {
  echo "c_programs: $1" >&2
  failed=1
}
mkdir -p "$work"
# compile COMPILER SOURCE OBJECT OPTION...
compile() {
  compiler=$1 source=$2 object=$3
  shift 3
  "$compiler" "$@" -Iinclude -c "$source" -o "$object"
}
# The language's flags of C++ mean nothing in C.
c_flags=$(for flag in "$@"; do case $flag in -fno-rtti | -fno-threadsafe-statics | -fno-use-cxa-atexit) ;; *) echo "$flag" ;; esac; done)
# What a program brings besides the core: the functions that a C library has.
memory=platform/arch/common/memory.cpp
[ ! -f $memory ] || compile "${prefix}g++" $memory "$work/memory.o" -std=c++17 -nostdinc++ "$@" -fcallgraph-info=su \
  -fno-tree-loop-distribute-patterns
grep -v '^#' $budgets | tail -n +2 >"$work/rows"
while IFS=, read -r program row_target effects most_flash most_stack without; do
  [ "$row_target" = "$target" ] || continue
  name=$program${effects:+_$effects}
  # shellcheck disable=SC2086
  compile "${prefix}gcc" "tests/c/programs/$program.c" "$work/$name.o" -std=c99 -Wall -Wextra -Wpedantic -Werror $c_flags \
    -fcallgraph-info=su,da || {
    complain "$program.c does not compile for $target"
    continue
  }
  list=$(ls "$objects"/*.o)
  graphs=$(ls "$objects"/*.ci)
  if [ -n "$effects" ]; then
    compile "${prefix}g++" src/c/light_render.cpp "$work/light_$effects.o" -std=c++17 -nostdinc++ "$@" -fno-ipa-icf \
      -fcallgraph-info=su,da -DTHIMBLE_C_EFFECTS="$effects"
    list="$(echo "$list" | grep -v '/c_light_render\.o$') $work/light_$effects.o"
    graphs="$(echo "$graphs" | grep -v '/c_light_render\.ci$') $work/light_$effects.ci"
  fi
  # shellcheck disable=SC2086
  if ! "${prefix}gcc" "$@" -nostdlib -Wl,--gc-sections,-e,program -o "$work/$name.elf" "$work/$name.o" $list \
    $(ls "$work/memory.o" 2>/dev/null) -lgcc; then
    complain "$program does not link for $target"
    continue
  fi
  flash=$("${prefix}size" "$work/$name.elf" | awk 'NR == 2 { print $1 + $2 }')
  ram=$("${prefix}size" "$work/$name.elf" | awk 'NR == 2 { print $2 + $3 }')
  "${prefix}nm" "$work/$name.elf" | awk '{ print $NF }' >"$work/$name.symbols"
  # shellcheck disable=SC2086
  "$stack_bound" --image program none "$work/$name.symbols" $graphs "$work/$name.ci" $(ls "$work/memory.ci" 2>/dev/null) \
    >"$work/$name.stack" 2>&1 || complain "no bound of the stack of $program: $(head -n 2 "$work/$name.stack")"
  stack=$(head -n 1 "$work/$name.stack")
  if [ "${UPDATE:-0}" = 1 ]; then
    echo "$program,$target,$effects,$(((flash + 1023) / 1024 * 1024)),$(((stack + 63) / 64 * 64)),$without"
    continue
  fi
  echo "$program in C on $target${effects:+ with the effects $effects}: flash $flash of $most_flash, stack $stack of $most_stack"
  [ "$flash" -le "$most_flash" ] || complain "$program takes $flash bytes of flash on $target, budget $most_flash"
  [ "$stack" -le "$most_stack" ] || complain "$program takes $stack bytes of stack on $target, budget $most_stack"
  [ "$ram" = 0 ] || complain "$program keeps $ram bytes of data on $target; the core keeps none"
  held=$("${prefix}nm" -C "$work/$name.elf" | grep -E -- "${without:-^$}" | head -n 3 || true)
  [ -z "$held" ] || complain "$program holds what it does not call: $held"
done <"$work/rows"
exit $failed
