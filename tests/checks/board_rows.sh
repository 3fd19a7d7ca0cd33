#!/bin/sh
# The table of boards in platform/README.md repeats the budgets of `demo` (tests/budgets/firmware.csv): flash in KiB, stack used
# and its bound; and BOARD_FRAME_INSTRUCTIONS of the boards, three digits of it, which `make test-boards` compares with what
# it measures. board_rows.sh ROOT [--write]     --write: puts these numbers there
set -eu
cd "$1"
page=platform/README.md
budgets=tests/budgets/firmware.csv
made=$(mktemp)
facts=$(mktemp)
trap 'rm -f "$made" "$facts"' EXIT
for board in platform/boards/*/board.cmake; do
  [ ! -f "$board" ] ||
    sed -n "s|^set(BOARD_FRAME_INSTRUCTIONS \([0-9]*\))|$(basename "$(dirname "$board")"),\1|p" "$board"
done >"$facts"
# A row begins with a board's name and has KiB and two numbers in the columns after the RAM.
awk -F, '
  function commas(number) { return number < 1000 ? number "" : int(number / 1000) "," sprintf("%03d", number % 1000) }
  function millions(number) { return sprintf(number < 9995000 ? "%.2f" : "%.1f", number / 1000000) " million" }
  FILENAME == ARGV[1] { if ($2 == "demo") row[$1] = int($3 / 1024) " KiB | " commas($6) ", " commas($5); next }
  FILENAME == ARGV[2] { if ($2 > 0) frame[$1] = millions($2); next }
  {
    line = $0
    if (match(line, /\| [0-9]+ KiB \| [0-9,]+, [0-9,]+ \|/)) {
      split(line, cells, / *\| */)
      if (cells[2] in row) {
        rest = substr(line, RSTART + RLENGTH)
        if (cells[2] in frame) {
          sub(/^ [0-9.]+ million/, " " frame[cells[2]], rest)
        }
        line = substr(line, 1, RSTART - 1) "| " row[cells[2]] " |" rest
      }
    }
    print line
  }' "$budgets" "$facts" "$page" >"$made"
if [ "${2:-}" = --write ]; then
  cp "$made" "$page"
  exit 0
fi
failed=0
if ! cmp -s "$made" "$page"; then
  diff "$page" "$made" | sed -n 's/^> /the budgets say: /p'
  echo "$page: the table of boards differs from $budgets or board.cmake; sh tests/checks/board_rows.sh . --write makes it"
  failed=1
fi
for board in $(sed -n 's/^\([^#,]*\),demo,.*/\1/p' "$budgets"); do
  if ! grep -Eq "^\| $board \|.*\| [0-9]+ KiB \| [0-9,]+, [0-9,]+ \|" "$page"; then
    echo "$page: the table of boards has no row for $board"
    failed=1
  fi
done
exit $failed
