#!/bin/sh
# The lines and branches of src, drivers apart, that the tests take, by gcov: a table by room, and a sentence for each room that
# has fewer than tests/budgets/coverage.csv says, or a branch that none takes and tests/budgets/untaken.csv does not
# hold.      coverage.sh BUILD_DIR [--update]
#
# The portable cases and frames (which boards run too) count first, alone; then all cases of the core's rooms,
# and the lit pictures of the wide renderer, which tells the core's frames what their rays meet.
set -eu
cd "$(dirname "$0")/.."
build=$1
budget=tests/budgets/coverage.csv
out=$build/coverage
mkdir -p "$out"
find "$build" -name '*.gcda' -delete

# count NAME: what the objects have counted so far -> room,lines,lines taken,branches,branches taken
count() {
  gcovr --root . --object-directory "$build" --filter src/ --exclude src/drivers/ --csv "$out/$1.files.csv" \
    --json "$out/$1.json" >"$out/$1.log" 2>&1
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
for room in base tree trace picture light plane bake c; do
  "$build/thimble_tests_covered" --source-file="*/tests/$room/*" >"$out/$room.out" 2>&1 ||
    { cat "$out/$room.out"; exit 1; }
done
"$build/thimble_tests_covered" --test-case='wide: lit scenes in which rays end*,wide: a lit picture*,wide: lit scenes with slopes*' >"$out/wide.out" 2>&1 ||
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
if [ "${2:-}" = --update ]; then
  cp "$out/coverage.csv" "$budget"
  python3 -B tests/untaken.py "$out/all.json" tests/budgets/untaken.csv --update
  exit
fi
if [ ! -f "$budget" ]; then
  echo "coverage: nothing to compare with; coverage.sh $build --update writes $budget" >&2
  exit
fi
bad=0
python3 -B tests/untaken.py "$out/all.json" tests/budgets/untaken.csv || bad=1
awk -F, '
  NR == FNR { lines[$1 "," $2] = $3; branches[$1 "," $2] = $4; next }
  FNR > 1 && ($3 < lines[$1 "," $2] || $4 < branches[$1 "," $2]) {
    printf "%s, %s: %s and %s per mille of the lines and branches are taken, %s and %s were\n", $1, $2, $3, $4,
      lines[$1 "," $2], branches[$1 "," $2]
    bad = 1
  }
  END { exit bad }' "$budget" "$out/coverage.csv" || bad=1
exit $bad
