#!/bin/sh
# Every source is as clang-format leaves it (`make format`). format.sh ROOT
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
if ! find $folders \( -name '*.h' -o -name '*.cpp' \) -print | xargs clang-format --dry-run -Werror --style=file; then
  echo "format: run make format" >&2
  exit 1
fi
