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
  mkdir -p "$tree/include/thimble/base" "$tree/include/thimble/tree" "$tree/src/base" "$tree/src/tree" "$tree/src/drivers" \
    "$tree/tools" "$tree/platform/apps" "$tree/platform/examples" "$tree/tests/reference" "$tree/tests/portable"
  cp "$here/../../.clang-format" "$here/../../.clang-tidy" "$tree/"
  cat >"$tree/include/thimble/base/sum.h" <<'H'
/// new float double: words in comments do not count.
#ifndef THIMBLE_SUM_H
#define THIMBLE_SUM_H

#include <stdint.h>

namespace thimble {
int32_t sum(const int32_t* values, int32_t count);
}  // namespace thimble

#endif
H
  cat >"$tree/src/base/sum.cpp" <<'C'
#include "thimble/base/sum.h"

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
  printf '#include "thimble/base/sum.h"\n' >"$tree/tools/tool.cpp"
  printf '#include <vector>\n' >"$tree/tests/reference/judge.cpp"
  printf 'pattern,target,limit_bytes\n*,*,512\n' >"$tree/stack.csv"
  printf 'hello:\n\t@echo hello\n' >"$tree/Makefile"
  cat >"$tree/platform/examples/sum.cpp" <<'C'
// platform/examples/sum.cpp
#include <stdio.h>

int main() {
  puts("none");
}
C
  {
    printf '# [Sum](src/base/sum.cpp)\n\n    make hello   # says so\n    thimble -o made\n    thimble made # a file that is there\n'
    printf '\n```cpp\n'
    cat "$tree/platform/examples/sum.cpp"
    printf '```\n'
  } >"$tree/README.md"
}
# What stands for the command: makes what -o names, and wants to find what else is named.
mkdir -p "$work/bin"
cat >"$work/bin/thimble" <<'C'
#!/bin/sh
case $1 in -o) echo made >"$2" ;; --window) exit 1 ;; *) [ -e "$1" ] ;; esac
C
chmod +x "$work/bin/thimble"
ar rc "$work/libempty.a"
# Adds to a file of the tree.
add() { printf '%s\n' "$2" >>"$tree/$1"; }
check() {
  case $1 in
    core.*) sh "$here/core_on.sh" "${1#core.}" "$tree" "$work/objects" "$stack_bound" "$tree/stack.csv" ;;
    tidy)
      cp "$here/tidy_tree.cmake" "$tree/CMakeLists.txt"
      sh "$here/tidy.sh" "$tree" "$work/tidy" src
      ;;
    readme_program) sh "$here/readme_program.sh" "$tree" "$work/program" "$work/libempty.a" ;;
    readme_commands) sh "$here/readme_commands.sh" "$tree" "$work/bin" "$work/commands" ;;
    panel_formats) sh "$here/panel_formats.sh" "$tree" "$work/formats" ;;
    subjects) sh "$here/subjects.sh" "$tree" "$base" ;;
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

# fault CHECK WORDS FILE TEXT...: what the check catches where each file holds that, too.
fault() {
  check=$1
  words=$2
  shift 2
  while [ $# -gt 0 ]; do
    add "$1" "$2"
    shift 2
  done
  catches "$check" "$words"
}

fresh
for name in layering words format headers arduino one_unit tidy core.host core.cortex-m0 core.cortex-m3 core.rv32 sizes links \
  readme_program readme_commands; do
  passes $name
done

# Subjects of commits.
commit() { git -C "$tree" -c user.name=n -c user.email=e commit -q --allow-empty -m "$1"; }
long=$(printf '%073d' 0)
base=none
passes subjects  # no history: skipped
if command -v git >/dev/null 2>&1; then
  git -C "$tree" init -q
  commit "$long"
  base=$(git -C "$tree" rev-parse HEAD)
  commit "${long#0}"
  passes subjects
  commit "$long"
  catches subjects "$long"
fi

# The table of boards repeats the budgets.
mkdir -p "$tree/platform" "$tree/tests/budgets"
board_tree() {
  printf 'some,demo,2048,8,%s,64\n' "$1" >"$tree/tests/budgets/firmware.csv"
  printf '| some | core | RAM | 2 KiB | 64, 1,280 | text |\n' >"$tree/platform/README.md"
}
board_tree 1280
passes board_rows
board_tree 1344
catches board_rows 'the budgets say: | some | core | RAM | 2 KiB | 64, 1,344 | text |'
mkdir -p "$tree/platform" "$tree/tests/budgets"
board_tree 1280
echo 'other,demo,2048,8,1280,64' >>"$tree/tests/budgets/firmware.csv"
catches board_rows 'has no row for other'
# frame_tree INSTRUCTIONS: a board that says what a frame takes.
frame_tree() {
  mkdir -p "$tree/platform/boards/some" "$tree/tests/budgets"
  board_tree 1280
  sed -i 's/text/3.01 million (a few)/' "$tree/platform/README.md"
  echo "set(BOARD_FRAME_INSTRUCTIONS $1)" >"$tree/platform/boards/some/board.cmake"
}
frame_tree 3014999
passes board_rows
frame_tree 3015001
catches board_rows 'the budgets say: .* 3.02 million (a few) |'

fresh
fault layering 'the core includes more' include/thimble/base/sum.h '#include <string.h>'
fault layering 'the core includes more' src/base/sum.cpp '#include <vector>'
add src/tree/tree.cpp '#include "../base/sum.h"'
add src/base/sum.h ''
passes layering
fault layering 'src/base/ sees only itself and the rooms below it' src/tree/node.h '' \
  src/base/sum.cpp '#include "../tree/node.h"'
fault layering 'src/tree/ sees only itself and the rooms below it' src/drivers/panel.h '' \
  src/drivers/panel.cpp '#include "thimble/base/sum.h"' src/tree/tree.cpp '#include "../drivers/panel.h"'
fault layering 'include/thimble/base/ sees only itself' include/thimble/tree/node.h '' \
  include/thimble/base/sum.h '#include "../tree/node.h"'
fault layering 'from where it stands' include/thimble/base/vec.h '' \
  include/thimble/base/sum.h '#include "thimble/base/vec.h"'
mkdir -p "$tree/src/attic"
fault layering 'is no room' src/attic/old.cpp ''
fault layering 'stand in rooms' src/lone.cpp ''
fault layering "the core's own" tools/tool.cpp '#include "thimble/base/detail/sum.h"'
mkdir -p "$tree/include/thimble/base/host" "$tree/platform/wide" "$tree/tests/base"
add include/thimble/base/host/sum.h '#include "../sum.h"'
add src/base/sum.cpp '#include "thimble/base/host/sum.h"'
add tests/base/test_sum.cpp '#include "thimble/base/host/sum.h"'
add platform/wide/sum.cpp '#include "thimble/base/host/sum.h"'
passes layering
fault layering "host's own renderer" platform/apps/app.cpp '#include "thimble/base/host/sum.h"'
fault layering "host's own renderer" tools/tool.cpp '#include "thimble/base/host/sum.h"'
mkdir -p "$tree/include/thimble/base/host"
fault layering 'for callers includes none of a folder host' include/thimble/base/host/more.h '' \
  include/thimble/base/sum.h '#include "host/more.h"'
fault layering 'sees what is installed' tools/tool.cpp '#include "wide/rays/job.h"'
fault layering 'never src' tools/tool.cpp '#include "../src/base/sum.h"'
mkdir -p "$tree/tools/commands" "$tree/tools/instruments"
add tools/commands/stats.cpp '#include "instruments/study.h"'
passes layering
fault layering 'tools/instruments sees only itself' tools/instruments/study.h '#include "commands/stats.h"'
fault layering 'libraries stand above' tools/trace.cpp '#include "thimble/files.h"'
mkdir -p "$tree/tools/library/examples"
fault layering 'know the installed package' tools/library/examples/view.cpp '#include "scene/workers.h"'
fault layering 'never src' platform/port.cpp '#include "../src/base/sum.h"'
fault layering 'platform sees no test' platform/port.cpp '#include "portable/case.h"'
mkdir -p "$tree/tests/boards/apps"
add tests/boards/apps/cases.cpp '#include "portable/case.h"'
add tests/portable/case.h '#include "thimble/base/sum.h"'
passes layering
fault layering 'the cases that run on boards' tests/portable/case.h '#include <vector>'
fault layering 'shares no code' tests/reference/judge.cpp '#include "thimble/base/sum.h"'

# lines COUNT TEXT
lines() {
  awk -v count="$1" -v text="$2" 'BEGIN { for (i = 0; i < count; ++i) print text }'
}
fault sizes 'longer than 800 lines' tools/tool.cpp "$(lines 800 '// nothing')"
fault sizes 'longer than 120 lines' tools/CMakeLists.txt "$(lines 121 '# nothing')"
for kind in js py sh; do
  add "tools/script.$kind" "$(lines 800 nothing)"
  passes sizes
  fault sizes 'these scripts are longer than 800 lines' "tools/script.$kind" nothing
done
# headers COUNT: so many for callers, and two that are not.
headers() {
  mkdir -p "$tree/include/thimble/base/detail" "$tree/include/thimble/base/host"
  for number in $(seq 2 "$1") detail/0 host/0; do
    echo >"$tree/include/thimble/base/$number.h"
  done
}
headers 37
passes sizes
headers 38
catches sizes '38 headers for callers'
fault sizes 'longer than 150 lines' README.md "$(lines 150 nothing)"
fault sizes 'wider than 110 columns' README.md "$(lines 23 'five ' | tr -d '\n')"
add README.md "$(lines 55 'é ' | tr -d '\n')"
passes sizes
# 98 lines between its first and its last are a hundred; what stands around a function does not count.
long_function() {
  add src/base/sum.cpp "namespace a { struct S { $(lines 60 'int g() const;')"
  add src/base/sum.cpp "  S(const char* text)
      : a{text},
        b{'{'} {"
  add src/base/sum.cpp "$(lines "$1" '    if (a) { f("}"); }')"
  add src/base/sum.cpp "  }
$(lines 60 'int g() const;')
}; }"
}
long_function 96
passes sizes
long_function 97
catches sizes 'longer than 100 lines'
fault links 'src/gone.cpp' README.md '[There](src/gone.cpp#here)'
printf '# One: two parts\n\n[Here](#one-two-parts)\n' >"$tree/src/page.md"
add README.md '[There](src/page.md#one-two-parts)'
passes links
printf '# One: two parts\n\n[Here](#two)\n' >"$tree/src/page.md"
catches links 'src/page.md#two'
fault readme_program 'is not the text of' platform/examples/sum.cpp '// more'
sed -i 's/none/many/' "$tree/README.md"
catches readme_program 'is not the text of'
sed -i 's/puts/put/' "$tree/README.md" "$tree/platform/examples/sum.cpp"
catches readme_program 'does not compile'
sed -i 's/sum\.cpp$/gone.cpp/' "$tree/README.md"
catches readme_program 'not there'
sed -i 's/^```cpp/```/' "$tree/README.md"
catches readme_program 'blocks of C++'
fault readme_commands 'thimble gone.vox' README.md '    thimble gone.vox   # a scene'
fault readme_commands 'make unheard-of' README.md '    make unheard-of'
if command -v Xvfb >/dev/null && command -v xdotool >/dev/null; then
  fault readme_commands 'opens no window' README.md '    thimble --window     # window'
fi
add README.md '    make install   # somewhere'
add Makefile 'all:
	false
install: all
	mkdir -p "$(PREFIX)" && echo installed >"$(PREFIX)/made"'
passes readme_commands
sed -i 's/echo installed/false/' "$tree/Makefile"
catches readme_commands 'this fails: make install'

for fault in 'float x;' 'int* p = new int;' 'auto y = std::move(x);' 'virtual void f();' '/* a */ double z; // b'; do
  add src/base/sum.cpp "$fault"
  catches words 'must do without'
done
add include/thimble/base/sum.h 'struct Sum { static Status make(int a); static Status open(int a); Status begin(); };'
passes words
for fault in 'static Status begin(int a);' 'static constexpr Status set(int a);'; do
  add include/thimble/base/sum.h "struct Total { $fault };"
  catches words 'is called open or make'
done
add include/thimble/thimble_c.h 'int32_t thimble_sum_make(int count);'
passes words
fault words 'in C a handle is filled by' include/thimble/thimble_c.h 'int32_t thimble_sum_begin(int count);'
# Phrases, taken apart here since no file may hold one: in a comment, in a page, in a message.
for fault in 'is ~told the rest' 'was ~asked for' 'ray goes ~on' 'rays that go ~on' 'What a box ha~s of itself' 'Asked ~were two'; do
  text=$(echo "$fault" | tr -d '~')
  for file in src/base/sum.cpp tools/tool.cpp; do
    add $file "// It $text"
    catches words "field's noun"
  done
  add src/base/README.md "$text"
  catches words "field's noun"
  add src/base/LOG.md "$text"
  add src/base/sum.cpp '// Two are told apart, or told from a third.'
  passes words
  fresh
done
for fault in 'return int64_t{a} * b;' 'return b * static_cast<uint64_t>(f(a));' 'return x * affine.step_x[axis];'; do
  add src/base/sum.cpp "// $fault"
  mkdir -p "$tree/src/trace" "$tree/src/plane"
  add src/plane/sum.cpp "long f(int a) { $fault }"
  add src/trace/sum.cpp 'long f(int a) { return (int64_t{a} << 3) + int64_t{1} - affine.step_x[axis]; }'
  passes words
  add src/trace/sum.cpp "long f(int a) { $fault }"
  catches words 'a product of 64 bits has a name'
done
fault format 'make format' src/base/sum.cpp 'int   x   ;'
fault headers 'lone.h does not compile alone' include/thimble/lone.h 'inline thimble::Vec3i zero() { return {}; }'
fault headers 'lone.h does not compile alone' include/thimble/lone.h 'struct Low { bool operator==(const Low&) const = default; };'
fault arduino 'after Arduino' include/thimble/lone.h 'struct Range { int LOW; };'
fault arduino 'after Arduino' include/thimble/lone.h 'struct Range { int max() const; };'
fault arduino 'after Arduino' include/thimble/lone.h 'template <int B1> struct Counted {};'
fault one_unit 'one translation unit' src/base/sum.cpp 'namespace { struct Frame { int left; }; int width(Frame frame) { return frame.left; } } int a() { return width({1}); }' \
  src/other.cpp 'namespace { struct Frame { int top; }; int height(Frame frame) { return frame.top; } } int b() { return height({2}); }'
fault tidy 'nullptr' src/base/sum.cpp 'int* nothing() { return 0; }'
fault tidy 'Dereference of null pointer' src/base/sum.cpp 'namespace { int look(int k) { int* p = nullptr; return k > 3 ? *p : k; } } int seen(int k) { return look(k); }'

for target in host cortex-m0 cortex-m3 rv32; do
  fault core.$target 'needs malloc' src/base/sum.cpp 'extern "C" void* malloc(__SIZE_TYPE__); void* get(unsigned n) { return malloc(n); }'
  fault core.$target 'no writable data' src/base/sum.cpp 'int counter = 3; int next() { return ++counter; }'
  fault core.$target 'no writable data' src/base/sum.cpp 'int tally; int next() { return ++tally; }'
  fault core.$target 'run no constructors' src/base/sum.cpp 'int from(); int from() { volatile int x = 1; return x; } extern const int kValue; const int kValue = from();'
  fault core.$target 'is recursive' src/base/sum.cpp 'int rec(int n) { return n < 2 ? n : rec(n - 1) * rec(n - 2) + 1; }'
  fault core.$target 'is recursive' src/base/sum.cpp 'int odd(int n); __attribute__((noinline)) int even(int n) { return n == 0 ? 1 : odd(n - 1) + 2; }' \
    src/base/sum.cpp '__attribute__((noinline)) int odd(int n) { return n == 0 ? 0 : even(n - 1) + 3; }'
  fault core.$target 'through a pointer' src/base/sum.cpp 'int call(int (*f)(int)) { return f(3) + 1; }'
  # A driver may, since what it calls is the board's.
  add src/drivers/panel.cpp 'int call(int (*f)(int)) { return f(3) + 1; }'
  passes core.$target
  fault core.$target 'is recursive' src/drivers/panel.cpp 'int rec(int n) { return n < 2 ? n : rec(n - 1) * rec(n - 2) + 1; }'
  fault core.$target 'not known when compiling' src/base/sum.cpp 'int grow(int n) { volatile char* p = static_cast<char*>(__builtin_alloca(n)); p[0] = 1; return p[n - 1]; }'
  fault core.$target 'does not compile' src/base/sum.cpp 'bool seldom(int n) { if (n == 0) [[unlikely]] { return true; } auto l = [&]<int k>() { return n == k; }; return l.template operator()<3>(); }'
  fault core.$target 'the limit is 512' src/base/sum.cpp 'int wide(int n) { volatile int a[200]; a[n] = 1; return a[n + 1]; }'
  printf 'nothing,*,10\n' >"$tree/stack.csv"
  catches core.$target 'no row'
done
for target in cortex-m0 cortex-m3 rv32; do
  fault core.$target 'divmod\|divdi3' src/base/sum.cpp 'int64_t divide(int64_t a, int64_t b) { return a / b; }'
  fault core.$target 'dmul\|muldf3' src/base/sum.cpp 'double scale(double a) { return a * 3; }'
done

# Formats of panels that are left out. formats WORD...: a source that stores nine of them, behind WORD each.
formats() {
  mkdir -p "$tree/src/picture"
  {
    echo 'template <int number> constexpr bool is_format() { return (THIMBLE_PANEL_FORMATS >> number & 1U) != 0; }'
    echo 'void store(volatile int* to) {'
    for number in 5 6 7 8 9 10 11 12 13; do
      case " $* " in *" $number "*) echo "  *to = $number;" ;; *) echo "  if (is_format<$number>()) { *to = $number; }" ;; esac
    done
    echo '  static_cast<void>(to);'
    echo '  static_cast<void>(is_format<5>());'
    echo '}'
  } >"$tree/src/picture/panel_store.cpp"
}
catches panel_formats 'no source of src asks is_format'
formats
passes panel_formats
formats 7
catches panel_formats 'panel_store.cpp takes .* bytes in an image without formats of panels'
formats 5 6 7 8 9 10 11 12 13
catches panel_formats 'panel_store.cpp takes .* bytes without formats of panels'

# What is written in C: its header, and programs with a budget.
catches c_header 'there is no include/thimble/thimble_c.h'
add include/thimble/thimble_c.h 'int thimble_sum(int count);'
passes c_header
fault c_header 'does not compile alone with gcc' include/thimble/thimble_c.h 'int thimble_default(int count = 3);'
fault c_header 'does not compile alone with g++' include/thimble/thimble_c.h 'int thimble_class(int class);'
fault c_header 'does not compile alone with gcc' include/thimble/thimble_c.h 'int thimble_sum();'
# program BUDGETS: a program in C over the tree's core, and its row.
program() {
  mkdir -p "$tree/tests/budgets" "$tree/tests/c/programs"
  add src/base/sum.cpp 'extern "C" int32_t c_sum(const int32_t* values) { return thimble::sum(values, 3); }'
  printf '#include <stdint.h>\nint32_t c_sum(const int32_t*);\nint32_t program(const int32_t*);\n' >"$tree/tests/c/programs/one.c"
  add tests/c/programs/one.c 'int32_t program(const int32_t* v) { return c_sum(v) + c_sum(v + 3); }'
  printf 'program,target,effects,flash_bytes,stack_bytes,without\none,cortex-m0,,%s\n' "$1" >"$tree/tests/budgets/c_programs.csv"
}
program '200,200,thimble::other'
passes core.cortex-m0
fresh
program '1,200,thimble::other'
catches core.cortex-m0 'bytes of flash on cortex-m0, budget 1'
program '200,8,thimble::other'
catches core.cortex-m0 'bytes of stack on cortex-m0, budget 8'
program '200,200,thimble::sum'
catches core.cortex-m0 'holds what it does not call'

# The bound of a whole image: a chain through a constructor's second name, a call through a pointer, an interrupt on top.
graph=$work/image.ci
printf '%s\n' root taken unused _ZN5ThingC2Ev deep tick >"$work/kept"
node() {
  printf 'node: { title: "%s" label: "%s\\nhere\\n%s bytes (static)\\n0 dynamic objects" }\n' "$1" "$1" "$2"
}
edge() { echo "edge: { sourcename: \"$1\" targetname: \"$2\" }"; }
image() {
  "$stack_bound" --image "${cores:-root}" tick "$work/kept" "$graph" >"$log" 2>&1
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
# Where another core begins nobody calls, and it is no one's call through a pointer.
{ node second 500; edge second __indirect_call; } >>"$graph"
echo second >>"$work/kept"
if image || ! grep -q 'is recursive' "$log"; then
  cat "$log"
  echo "selftest: the loop of another core should count as called through a pointer, unless it is named" >&2
  failed=1
fi
cores=root,second
wants 'another core' $((8 + 100 + 24 + 200 + 64 + 36 + 16))
cores=second,root
wants 'the other core itself' $((500 + 200 + 64 + 36 + 16))
cores=root,second
edge deep nowhere >>"$graph"
if image || ! grep -q 'nowhere is called, and has no call graph' "$log"; then
  cat "$log"
  echo "selftest: a function without a call graph should have been missed" >&2
  failed=1
fi

[ $failed = 0 ] && echo "selftest: every check fails when it should"
exit $failed
