#!/bin/sh
# Shows each check a tree with one fault, and a tree without: a check that cannot fail proves nothing.
# selftest.sh WORK_DIR STACK_BOUND
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
work=$(cd "$1" && pwd)
stack_bound=$2
tree=$work/tree
failed=0
log=$work/log

# A small sound tree, made anew for each case.
fresh() {
  rm -rf "$tree"
  mkdir -p "$tree/include/thimble" "$tree/src" "$tree/tools" "$tree/platform" "$tree/tests/reference"
  cp "$here/../../.clang-format" "$here/../../.clang-tidy" "$tree/"
  cat >"$tree/include/thimble/sum.h" <<'H'
/// new float double: words in comments do not count.
#ifndef THIMBLE_SUM_H
#define THIMBLE_SUM_H

#include <stdint.h>

namespace thimble {
int32_t sum(const int32_t* values, int32_t count);
}  // namespace thimble

#endif
H
  cat >"$tree/src/sum.cpp" <<'C'
#include "thimble/sum.h"

namespace thimble {
int32_t sum(const int32_t* values, int32_t count) {
  int32_t total = 0;
  for (int32_t i = 0; i < count; ++i) {
    total += values[i];
  }
  return total;
}
}  // namespace thimble
C
  printf '#include "thimble/sum.h"\n' >"$tree/tools/tool.cpp"
  printf '#include <vector>\n' >"$tree/tests/reference/judge.cpp"
  printf 'pattern,target,limit_bytes\n*,*,512\n' >"$tree/stack.csv"
}
# Adds to a file of the tree.
add() { printf '%s\n' "$2" >>"$tree/$1"; }
check() {
  case $1 in
    core.*) sh "$here/core_on.sh" "${1#core.}" "$tree" "$work/objects" "$stack_bound" "$tree/stack.csv" ;;
    tidy)
      cp "$here/tidy_tree.cmake" "$tree/CMakeLists.txt"
      sh "$here/tidy.sh" "$tree" "$work/tidy" src
      ;;
    *) sh "$here/$1.sh" "$tree" ;;
  esac >"$log" 2>&1
}
# passes CHECK
passes() {
  status=0
  check "$1" || status=$?
  if [ $status = 77 ]; then
    echo "skipped: $1"
    return
  fi
  if [ $status != 0 ]; then
    cat "$log"
    echo "selftest: $1 fails on a sound tree" >&2
    failed=1
  fi
}
# catches CHECK WORDS: it must fail, and say WORDS.
catches() {
  status=0
  check "$1" || status=$?
  if [ $status = 77 ]; then
    echo "skipped: $1"
  elif [ $status != 1 ] || ! grep -q -- "$2" "$log"; then
    cat "$log"
    echo "selftest: $1 should have failed with '$2' (status $status)" >&2
    failed=1
  fi
  fresh
}

fresh
for name in layering words format headers arduino one_unit tidy core.host core.cortex-m0 core.cortex-m3 core.rv32; do
  passes $name
done

fresh
add include/thimble/sum.h '#include <string.h>'
catches layering 'public header includes more'
add src/sum.cpp '#include <vector>'
catches layering 'src includes more'
add src/secret.h ''
add tools/tool.cpp '#include "secret.h"'
catches layering 'never src'
add platform/port.cpp '#include "../src/sum.h"'
catches layering 'never src'
add platform/port.cpp '#include "portable/case.h"'
catches layering 'platform sees no test'
mkdir -p "$tree/platform/apps" "$tree/tests/portable"
add platform/apps/selftest.cpp '#include "portable/case.h"'
add tests/portable/case.h '#include "thimble/sum.h"'
passes layering
add platform/apps/selftest.cpp '#include "support/heap.h"'
catches layering 'platform sees no test'
mkdir -p "$tree/tests/portable"
add tests/portable/case.h '#include <vector>'
catches layering 'the cases that run on boards'
add tests/reference/judge.cpp '#include "thimble/sum.h"'
catches layering 'shares no code'

for fault in 'float x;' 'int* p = new int;' 'auto y = std::move(x);' 'virtual void f();' '/* a */ double z; // b'; do
  add src/sum.cpp "$fault"
  catches words 'must do without'
done
add src/sum.cpp 'int   x   ;'
catches format 'make format'
add include/thimble/lone.h 'inline thimble::Vec3i zero() { return {}; }'
catches headers 'lone.h does not compile alone'
add include/thimble/lone.h 'struct Low { bool operator==(const Low&) const = default; };'
catches headers 'lone.h does not compile alone'
add include/thimble/lone.h 'struct Range { int LOW; };'
catches arduino 'after Arduino'
add include/thimble/lone.h 'constexpr int max(int a, int b) { return a < b ? b : a; }'
catches arduino 'after Arduino'
add include/thimble/lone.h 'template <int B1> struct Counted {};'
catches arduino 'after Arduino'
add src/sum.cpp 'namespace { struct Frame { int left; }; int width(Frame frame) { return frame.left; } } int a() { return width({1}); }'
add src/other.cpp 'namespace { struct Frame { int top; }; int height(Frame frame) { return frame.top; } } int b() { return height({2}); }'
catches one_unit 'one translation unit'
add src/sum.cpp 'int* nothing() { return 0; }'
catches tidy 'nullptr'

for target in host cortex-m0 cortex-m3 rv32; do
  add src/sum.cpp 'extern "C" void* malloc(__SIZE_TYPE__); void* get(unsigned n) { return malloc(n); }'
  catches core.$target 'needs malloc'
  add src/sum.cpp 'int counter = 3; int next() { return ++counter; }'
  catches core.$target 'no writable data'
  add src/sum.cpp 'int tally; int next() { return ++tally; }'
  catches core.$target 'no writable data'
  add src/sum.cpp 'int from(); int from() { volatile int x = 1; return x; } extern const int kValue; const int kValue = from();'
  catches core.$target 'run no constructors'
  add src/sum.cpp 'int rec(int n) { return n < 2 ? n : rec(n - 1) * rec(n - 2) + 1; }'
  catches core.$target 'is recursive'
  add src/sum.cpp 'int odd(int n); __attribute__((noinline)) int even(int n) { return n == 0 ? 1 : odd(n - 1) + 2; }'
  add src/sum.cpp '__attribute__((noinline)) int odd(int n) { return n == 0 ? 0 : even(n - 1) + 3; }'
  catches core.$target 'is recursive'
  add src/sum.cpp 'int call(int (*f)(int)) { return f(3) + 1; }'
  catches core.$target 'through a pointer'
  add src/sum.cpp 'int grow(int n) { volatile char* p = static_cast<char*>(__builtin_alloca(n)); p[0] = 1; return p[n - 1]; }'
  catches core.$target 'not known when compiling'
  add src/sum.cpp 'bool seldom(int n) { if (n == 0) [[unlikely]] { return true; } auto l = [&]<int k>() { return n == k; }; return l.template operator()<3>(); }'
  catches core.$target 'does not compile'
  add src/sum.cpp 'int wide(int n) { volatile int a[200]; a[n] = 1; return a[n + 1]; }'
  catches core.$target 'the limit is 512'
  printf 'nothing,*,10\n' >"$tree/stack.csv"
  catches core.$target 'no row'
done
for target in cortex-m0 cortex-m3 rv32; do
  add src/sum.cpp 'int64_t divide(int64_t a, int64_t b) { return a / b; }'
  catches core.$target 'divmod\|divdi3'
  add src/sum.cpp 'double scale(double a) { return a * 3; }'
  catches core.$target 'dmul\|muldf3'
done

# The bound of a whole image: a chain through a constructor's second name, a call through a pointer, an interrupt on top.
graph=$work/image.ci
printf '%s\n' root taken unused _ZN5ThingC2Ev deep tick >"$work/kept"
node() {
  printf 'node: { title: "%s" label: "%s\\nhere\\n%s bytes (static)\\n0 dynamic objects" }\n' "$1" "$1" "$2"
}
edge() { echo "edge: { sourcename: \"$1\" targetname: \"$2\" }"; }
image() {
  "$stack_bound" --image root tick "$work/kept" "$graph" >"$log" 2>&1
}
{
  node root 8; node file.cpp:_ZN5ThingC2Ev 100; node deep 24; node taken 200; node dropped 4000; node tick 16
  edge root file.cpp:_ZN5ThingC1Ev; edge file.cpp:_ZN5ThingC2Ev deep; edge deep __aeabi_lmul
} >"$graph"
# wants WHAT BYTES
wants() {
  if ! image || [ "$(head -n 1 "$log")" != "$2" ]; then
    cat "$log"
    echo "selftest: the bound of an image: $1: wanted $2" >&2
    failed=1
  fi
}
wants 'a constructor, an interrupt' $((8 + 100 + 24 + 64 + 36 + 16))
edge deep __indirect_call >>"$graph"
wants 'a call through a pointer' $((8 + 100 + 24 + 200 + 64 + 36 + 16))
edge deep nowhere >>"$graph"
if image || ! grep -q 'nowhere is called, and has no call graph' "$log"; then
  cat "$log"
  echo "selftest: a function without a call graph should have been missed" >&2
  failed=1
fi

[ $failed = 0 ] && echo "selftest: every check fails when it should"
exit $failed
