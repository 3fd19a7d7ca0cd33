#!/bin/sh
# Removes what `make install` installs: it is installed once more, elsewhere, to see what that is.
#   uninstall.sh BUILD_DIR DESTDIR PREFIX
set -eu
list=$(mktemp -d)
trap 'rm -rf "$list"' EXIT
DESTDIR="$list" cmake --install "$1" --prefix "$3" >/dev/null
cd "$list$3"
find . ! -type d | while IFS= read -r file; do
  rm -f "$2$3/$file"
done
# The folders that are ours: others stay, even where nothing else is in them.
find . -depth -type d -path '*thimble*' | while IFS= read -r folder; do
  rmdir "$2$3/$folder" 2>/dev/null || true
done
echo "removed from $2$3"
