#!/bin/sh
# Every source is as clang-format leaves it (`make format`); with STAMP, those that changed since that file was written
# by a run that passed. format.sh ROOT [STAMP]
set -eu
cd "$1"
if ! command -v clang-format >/dev/null 2>&1; then
  echo "skipped: clang-format is not installed"
  exit 77
fi
folders=
for folder in include src platform tools tests; do
  [ -d "$folder" ] && folders="$folders $folder"
done
stamp=${2:-}
newer=
if [ -n "$stamp" ]; then
  [ ! -e "$stamp" ] || [ .clang-format -nt "$stamp" ] || newer="-newer $stamp"
  : >"$stamp.next"
fi
if ! find $folders \( -name '*.h' -o -name '*.cpp' \) $newer -print | xargs -r clang-format --dry-run -Werror --style=file; then
  echo "format: run make format" >&2
  exit 1
fi
[ -z "$stamp" ] || mv "$stamp.next" "$stamp"
