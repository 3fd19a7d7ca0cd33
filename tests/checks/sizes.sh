#!/bin/sh
# How long things are: no file of the product and no script above 800 lines, no function of the product above 100, no
# CMake file above 120; README.md has at most 150 lines, none above 110 columns. Of headers for callers there are so
# many: a newcomer finds his way. sizes.sh ROOT
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$1"
failed=0
complain() {
  if [ -n "$2" ]; then
    echo "$2"
    echo "sizes: $1" >&2
    failed=1
  fi
}
folders=
for folder in include src platform tools; do
  [ -d "$folder" ] && folders="$folders $folder"
done
sources() {
  find $folders \( -name '*.h' -o -name '*.cpp' \) -print | sort
}
# longer_than LINES: of the files whose names are read, those that are longer.
longer_than() {
  xargs -r wc -l | awk -v most="$1" '$2 != "total" && $1 > most { print $1, $2 }'
}
complain "these files are longer than 800 lines" "$(sources | longer_than 800)"
complain "these scripts are longer than 800 lines" \
  "$(find . \( -path ./build -o -path ./out -o -path ./.git -o -name node_modules \) -prune -o \
    \( -name '*.js' -o -name '*.mjs' -o -name '*.py' -o -name '*.sh' \) -print | sort | longer_than 800)"
complain "these functions are longer than 100 lines" \
  "$(sources | xargs -r awk -f "$here/strip_comments.awk" | awk -v most=100 -f "$here/functions.awk")"
complain "these CMake files are longer than 120 lines" \
  "$(find . \( -path ./build -o -path ./.git \) -prune -o \( -name CMakeLists.txt -o -name '*.cmake' \) -print |
    longer_than 120)"
# Those of thimble/ and of its rooms; what lies in detail/ and host/ is not for callers (layering.sh).
most_headers=37
headers=$(find include/thimble -name '*.h' ! -path '*/detail/*' ! -path '*/host/*' | wc -l)
[ "$headers" -le $most_headers ] || complain "a header for callers is one more to know" "$headers headers for callers, at most $most_headers"
if [ -f README.md ]; then
  complain "the README is longer than 150 lines" "$(echo README.md | longer_than 150)"
  # Characters, not bytes.
  complain "these lines of the README are wider than 110 columns" \
    "$(iconv -f UTF-8 -t UTF-32LE README.md | od -An -v -tu4 -w4 | awk '
      $1 == 10 { ++line; if (width > 110) { print "README.md:" line ": " width " columns" } width = 0; next }
      { ++width }')"
fi
exit $failed
