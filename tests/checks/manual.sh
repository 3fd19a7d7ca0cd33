#!/bin/sh
# The manual page as the formatters that are there see it: no warning.      manual.sh THIMBLE WORK_DIR
set -eu
mkdir -p "$2"
page=$2/thimble.1
"$1" manual >"$page"
looked=0
failed=0
if command -v man >/dev/null 2>&1; then
  looked=1
  said=$(LC_ALL=C.UTF-8 MANWIDTH=80 man --warnings -l "$page" 2>&1 >"$2/page.txt" || true)
  if [ -n "$said" ] || ! grep -q 'thimble render SCENE' "$2/page.txt"; then
    echo "manual: man says: $said" >&2
    failed=1
  fi
fi
if command -v mandoc >/dev/null 2>&1; then
  looked=1
  said=$(mandoc -T lint -W warning "$page" 2>&1 || true)
  if [ -n "$said" ]; then
    echo "$said" >&2
    failed=1
  fi
fi
[ $looked = 1 ] || exit 77
exit $failed
