#!/bin/sh
# The core uses no floating point, no heap, no exceptions, no virtual functions and no C++ library: none of their
# words stands in include/ or src/ outside comments. words.sh ROOT
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$1"
words='float|double|new|delete|virtual|throw|try|catch|typeid|dynamic_cast|thread_local|malloc|free'
found=$(find include src \( -name '*.h' -o -name '*.cpp' \) -exec awk -f "$here/strip_comments.awk" {} + |
  sed 's/= *delete//g' | grep -E "^[^:]*:[0-9]+:(.*[^A-Za-z0-9_])?($words)([^A-Za-z0-9_]|\$)|^[^:]*:[0-9]+:.*std::" || true)
if [ -n "$found" ]; then
  echo "$found"
  echo "words: the core must do without: $words, std::" >&2
  exit 1
fi
