#!/bin/sh
# The Debian package: lintian, where it is there, has nothing to say; unpacked in an empty folder the command finds its
# scenes, and draws one.     package.sh ROOT BUILD_DIR WORK_DIR
set -eu
command -v dpkg-shlibdeps >/dev/null 2>&1 || exit 77
root=$1
build=$2
work=$3
rm -rf "$work"
mkdir -p "$work/unpacked"
sh "$root/tools/package.sh" "$build" >"$work/log" 2>&1 || {
  cat "$work/log" >&2
  exit 1
}
deb=$(ls "$build"/thimble_*.deb)
failed=0
complain() {
  echo "package: $1" >&2
  failed=1
}
if command -v lintian >/dev/null 2>&1; then
  # As root it warns that it runs as root.
  lintian --fail-on error,warning --allow-root "$deb" >"$work/lintian" 2>&1 || {
    cat "$work/lintian" >&2
    complain "lintian does not accept it"
  }
fi
for need in libc6 libx11-6 libhwy1 libtbb; do
  dpkg-deb -f "$deb" Depends | grep -q "$need" || complain "it does not depend on $need"
done
dpkg-deb -x "$deb" "$work/unpacked"
cd "$work/unpacked"
for file in bin/thimble share/man/man1/thimble.1.gz share/doc/thimble/copyright share/doc/thimble/changelog.gz \
  share/bash-completion/completions/thimble share/fish/vendor_completions.d/thimble.fish \
  share/zsh/vendor-completions/_thimble include/thimble/thimble.h; do
  [ -f "usr/$file" ] || complain "it lacks usr/$file"
done
if grep -rqsF "$root" usr; then
  complain "a file names the folder that it was built in: $(grep -rlF "$root" usr | head -n 3 | tr '\n' ' ')"
fi
mkdir "$work/empty"
cd "$work/empty"
env -i PATH="$work/unpacked/usr/bin" thimble render castle --size 64x48 --quiet -o castle.png || complain "it does not draw the castle"
[ -s castle.png ] || complain "there is no picture"
said=$(env -i PATH="$work/unpacked/usr/bin" thimble render nothing -o n.png 2>&1 || true)
case $said in
  *castle*house*lagoon*ship*) ;;
  *) complain "an unknown name lists: $said" ;;
esac
[ $failed = 0 ] && echo "package: $(basename "$deb"), $(wc -c <"$deb") bytes"
exit $failed
