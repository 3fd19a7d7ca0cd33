#!/bin/sh
# `make install` puts the command where PREFIX says, below DESTDIR, also where PREFIX is empty; it finds its scenes from
# there, and `make uninstall` leaves nothing of ours and all that is not.     install.sh ROOT BUILD_DIR WORK_DIR
set -eu
root=$1
[ "$(readlink -f "$2")" = "$(readlink -f "$root/build/release")" ] || exit 77  # what the Makefile installs
work=$3
failed=0
complain() {
  echo "install: $1" >&2
  failed=1
}
rm -rf "$work"
mkdir -p "$work"
# What is built is not built once more.
make_it() {
  make -C "$root" --no-print-directory -o all "$@" >>"$work/log" 2>&1 || complain "make $* fails: $(tail -n 1 "$work/log")"
}
try() {  # try NAME BELOW MAKE_ARGS
  at=$work/$1$2
  mkdir -p "$at/bin" "$at/share/man/man1"
  echo theirs >"$at/bin/other"
  (cd "$work/$1" && find . | sort) >"$work/before"
  shift 2
  make_it install "$@"
  [ -x "$at/bin/thimble" ] || complain "with $* there is no bin/thimble"
  [ -f "$at/include/thimble/thimble.h" ] || complain "with $* there is no header"
  [ -f "$at/share/thimble/scenes/castle.vox" ] || complain "with $* there are no scenes"
  for entry in applications/thimble.desktop mime/packages/thimble.xml thumbnailers/thimble.thumbnailer; do
    [ -s "$at/share/$entry" ] || complain "with $* there is no share/$entry"
  done
  said=$(cd / && env -i "$at/bin/thimble" info castle 2>&1 | head -n 1)
  [ "$said" = "scene                castle" ] || complain "with $* the command says: $said"
  make_it uninstall "$@"
  (cd "${at%"$below"}" && find . ! -type d -o -path '*thimble*' | sort) >"$work/left"
  [ "$(cat "$work/left")" = ".$below/bin/other" ] || complain "with $* these are left: $(tr '\n' ' ' <"$work/left")"
  for line in $(cat "$work/before"); do
    [ -e "${at%"$below"}/$line" ] || complain "with $* $line is gone"
  done
}
below=
try "empty" "" DESTDIR="$work/empty" PREFIX=
below=/usr
try "usr" "/usr" DESTDIR="$work/usr" PREFIX=/usr
below=/opt/t
try "own" "/opt/t" DESTDIR= PREFIX="$work/own/opt/t"
[ $failed = 0 ] && echo "install: three prefixes, each removed again"
exit $failed
