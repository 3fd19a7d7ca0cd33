#!/bin/sh
# The README's program is the text of the file that its first line names, compiles, and runs.
# readme_program.sh ROOT WORK_DIR LIBTHIMBLE
set -eu
cd "$1"
work=$2
library=$3
rm -rf "$work"
mkdir -p "$work"
fail() {
  echo "readme_program: $1" >&2
  exit 1
}
blocks=$(grep -c '^```cpp' README.md || true)
[ "$blocks" = 1 ] || fail "README.md has $blocks blocks of C++; it shows one program"
awk '/^```cpp/ { inside = 1; next } /^```/ { inside = 0 } inside' README.md >"$work/main.cpp"
file=$(sed -n '1s,^// *\([A-Za-z0-9_./-]*\.cpp\)$,\1,p' "$work/main.cpp")
[ -n "$file" ] || fail "the program's first line is not // platform/examples/NAME/main.cpp"
[ -f "$file" ] || fail "the program says that it is $file, which is not there"
# The file need not say its own name.
tail -n +2 "$work/main.cpp" >"$work/unnamed.cpp"
if ! cmp -s "$work/main.cpp" "$file" && ! diff "$work/unnamed.cpp" "$file" >"$work/diff"; then
  cat "$work/diff"
  fail "the program is not the text of $file"
fi
g++ -std=c++17 -O1 -Wall -Wextra -Wpedantic -Werror -Iinclude "$work/main.cpp" "$library" -o "$work/program" ||
  fail "the program does not compile"
(cd "$work" && ./program </dev/null >out) || fail "the program fails"
[ -s "$work/out" ] || fail "the program prints nothing"
