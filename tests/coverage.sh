#!/bin/sh
# The lines and branches of src, drivers apart, that the tests take, by gcov: a table by room, and exit status 1 where the core
# falls below a floor.      coverage.sh BUILD_DIR
#
# The portable cases and frames (which boards run too) count first, alone; then all cases of the core's rooms, those of
# misuse, which hold what damaged bytes may do, and the lit pictures of the wide renderer, which tells the core's frames
# what their rays meet.
set -eu
cd "$(dirname "$0")/.."
build=$1
# Per mille of the core: lines by the portable suite; lines and branches by all.
portable_lines=900
all_lines=990
all_branches=940
out=$build/coverage
mkdir -p "$out"
find "$build" -name '*.gcda' -delete

# count NAME: what the objects have counted so far -> room,lines,lines taken,branches,branches taken
count() {
  gcovr --root . --object-directory "$build" --filter src/ --exclude src/drivers/ --csv "$out/$1.files.csv" \
    >"$out/$1.log" 2>&1
  awk -F, -v OFS=, '
    NR == 1 { for (i = 1; i <= NF; ++i) { column[$i] = i } next }
    {
      split($column["filename"], part, "/")
      room[part[2]]
      lines[part[2]] += $column["line_total"]; taken[part[2]] += $column["line_covered"]
      branches[part[2]] += $column["branch_total"]; gone[part[2]] += $column["branch_covered"]
    }
    END { for (r in room) { print r, lines[r], taken[r], branches[r], gone[r] } }
  ' "$out/$1.files.csv" | sort >"$out/$1.csv"
}

"$build/thimble_golden_tests_covered" >"$out/portable.out" 2>&1 || { cat "$out/portable.out"; exit 1; }
count portable
for room in base tree trace picture light plane bake c misuse; do
  "$build/thimble_tests_covered" --source-file="*/tests/$room/*" >"$out/$room.out" 2>&1 ||
    { cat "$out/$room.out"; exit 1; }
done
"$build/thimble_tests_covered" --test-case='wide: lit scenes*,wide: a lit picture*' >"$out/wide.out" 2>&1 ||
  { cat "$out/wide.out"; exit 1; }
count all

{
  echo room,suite,lines_per_mille,branches_per_mille
  for suite in portable all; do
    awk -F, -v OFS=, -v suite=$suite '
      { print $1, suite, int(1000 * $3 / $2), int(1000 * $5 / $4) }
      # The C face calls the core and is not counted as a part of it.
      $1 != "c" { l += $2; t += $3; b += $4; g += $5 }
      END { print "core", suite, int(1000 * t / l), int(1000 * g / b) }' "$out/$suite.csv"
  done
} >"$out/coverage.csv"
column -s, -t "$out/coverage.csv"
awk -F, -v portable_lines=$portable_lines -v all_lines=$all_lines -v all_branches=$all_branches '
  function hold(what, taken, floor) {
    ++held
    if (taken < floor) { printf "coverage: %s: %d per mille of the core, the floor is %d\n", what, taken, floor; bad = 1 }
  }
  $1 == "core" && $2 == "portable" { hold("lines by the portable cases", $3, portable_lines) }
  $1 == "core" && $2 == "all" { hold("lines", $3, all_lines); hold("branches", $4, all_branches) }
  END { exit bad || held != 3 }' "$out/coverage.csv"
