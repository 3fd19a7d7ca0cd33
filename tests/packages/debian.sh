#!/bin/sh
# The Debian packages, unpacked in an empty root: lintian has nothing to say, the command draws without the others, the
# library is found by pkg-config.
name=debian
. tests/packages/common.sh
need dpkg-deb
command=$(ls "$PACKAGES"/thimble_*.deb 2>/dev/null) || {
  say "skipped: no .deb was made here"
  exit 0
}
others=$(ls "$PACKAGES"/libthimble-files?.*_*.deb "$PACKAGES"/libthimble-dev_*.deb)
for deb in $command $others; do
  if command -v lintian >/dev/null 2>&1; then
    logged lintian --fail-on error,warning --allow-root "$deb"
  else
    say "skipped: lintian is not installed"
  fi
  case $(dpkg-deb -f "$deb" Version) in "$VERSION"*) ;; *) fail "the version of $deb is $(dpkg-deb -f "$deb" Version)" ;; esac
done
mkdir -p "$WORK/root"
# Installed as dpkg does it, but for what it depends on, in a root of its own.
if [ "$(id -u)" -eq 0 ]; then
  mkdir -p "$WORK/root/var/lib/dpkg/updates" "$WORK/root/var/lib/dpkg/info"
  : >"$WORK/root/var/lib/dpkg/status"
fi
# installed PACKAGE...: in that root
installed() {
  if [ "$(id -u)" -ne 0 ]; then
    for deb in "$@"; do logged dpkg-deb -x "$deb" "$WORK/root"; done
    return
  fi
  logged dpkg --root="$(cd "$WORK/root" && pwd)" --force-depends --force-script-chrootless --log=/dev/null --install "$@"
  dpkg --root="$(cd "$WORK/root" && pwd)" --verify >"$WORK/verify" 2>&1 && [ ! -s "$WORK/verify" ] || fail "dpkg --verify: $(cat "$WORK/verify")"
}
for need in libc6 libx11-6 libhwy1 libtbb; do
  dpkg-deb -f "$command" Depends | grep -q "$need" || fail "it does not depend on $need"
done
installed "$command"
[ -z "$(find "$WORK/root/usr/lib" "$WORK/root/usr/include" -type f 2>/dev/null)" ] || fail "the command's package holds a library"
env -i PATH="$WORK/root/usr/bin" thimble render castle --size 64x48 --quiet -o "$WORK/castle.png" || fail "the command does not draw"
said=$(env -i PATH="$WORK/root/usr/bin" thimble render nothing -o "$WORK/nothing.png" 2>&1 || true)
case $said in
  *castle*house*lagoon*ship*) ;;
  *) fail "an unknown name lists: $said" ;;
esac
installed $others
for file in bin/thimble include/thimble/thimble.h include/thimble/drivers/panel.h include/thimble/files.h \
  include/thimble/wide/threads.h lib/libthimble.a lib/libthimble_files.so lib/libthimble_wide.a \
  lib/cmake/thimble/thimbleConfig.cmake share/doc/thimble/copyright share/doc/libthimble-dev/README.md.gz \
  share/bash-completion/completions/thimble share/fish/vendor_completions.d/thimble.fish \
  share/zsh/vendor-completions/_thimble share/man/man1/thimble.1.gz share/applications/thimble.desktop share/mime/packages/thimble.xml \
  share/thumbnailers/thimble.thumbnailer share/icons/hicolor/scalable/apps/thimble.svg; do
  [ -s "$WORK/root/usr/$file" ] || fail "it lacks usr/$file"
done
! grep -rlsF "$PWD" "$WORK/root/usr" >&2 || fail "these name the folder that they were built in"
# Templates come along, and programs for boards where `make images` has built them.
env -i PATH="$WORK/root/usr/bin" thimble new "$WORK/project" --board pico --panel ssd1306 castle --quiet && [ -s "$WORK/project/main.cpp" ] ||
  fail "the command writes no project"
if [ -e build/images/pico-demo-sun.elf.gz ]; then
  env -i PATH="$WORK/root/usr/bin" thimble image castle --board pico --quiet -o "$WORK/castle.uf2" || fail "the command makes no image"
  logged build/release/thimble image castle --board pico --quiet -o "$WORK/here.uf2"
  cmp "$WORK/castle.uf2" "$WORK/here.uf2" || fail "its image is another one"
fi
# As a file manager runs it: the entry's own line, with its letters replaced.
thumbnailer=$(sed -n 's/^Exec=//p' "$WORK/root/usr/share/thumbnailers/thimble.thumbnailer" |
  sed "s|%s|64|; s|%i|$WORK/root/usr/share/thimble/scenes/castle.vox|; s|%o|$WORK/thumbnail.png|")
env -i PATH="$WORK/root/usr/bin" $thumbnailer && [ -s "$WORK/thumbnail.png" ] || fail "this draws no picture: $thumbnailer"
# The same where it sees nothing but the system's libraries, the package, the input and the output, which is there before.
if command -v bwrap >/dev/null 2>&1 && bwrap --unshare-all --ro-bind / / true 2>/dev/null; then
  : >"$WORK/made.png"
  logged bwrap --unshare-all --die-with-parent --ro-bind /usr /usr --symlink usr/lib /lib --symlink usr/lib64 /lib64 \
    --ro-bind "$WORK/root/usr/bin" /bin --ro-bind "$WORK/root/usr/share/thimble/scenes/castle.vox" /in \
    --bind "$WORK/made.png" /out --clearenv ${thumbnailer%% "$WORK"*} /in /out
  cmp "$WORK/thumbnail.png" "$WORK/made.png" || fail "in a sandbox the small picture is another one"
fi
grep -q '^MimeType=model/x-vox;.*;model/gltf-binary;$' "$WORK/root/usr/share/applications/thimble.desktop" || fail "the desktop entry lacks types"
if command -v pkg-config >/dev/null 2>&1; then
  PKG_CONFIG_PATH=$(dirname "$(find "$WORK/root/usr/lib" -name thimble.pc)")
  export PKG_CONFIG_PATH
  logged c++ -std=c++17 platform/examples/ball/main.cpp $(pkg-config --cflags --libs thimble) -o "$WORK/ball"
  same_ball "$WORK/ball"
  no_drivers "$WORK/ball"
  logged c++ -std=c++17 tests/packages/panels.cpp $(pkg-config --cflags --libs thimble) -o "$WORK/panels"
  same_panels "$WORK/panels"
fi
say "$(basename "$command") and its libraries: lintian, dpkg, the command and the library: the ball is drawn, also on panels"
