#!/bin/sh
# thimble-fb on a real /dev/fb0: Debian's kernel in an emulated PC, keys through its keyboard.
#   framebuffer.sh ROOT WORK THIMBLE_FB SCENE.oct
# THIMBLE_FB is linked statically. Leaves first.ppm and moved.ppm in WORK: the screen before and after a key. The kernel's package is
# downloaded (about 70 MB) unless WORK holds it.
set -eu
root=$1
work=$2
program=$3
scene=$4
mkdir -p "$work"
fail() {
  echo "framebuffer: $1" >&2
  [ ! -f "$work/serial.log" ] || sed 's/^/  | /' "$work/serial.log" >&2
  exit 1
}

if ! [ -f "$work/vmlinuz" ] || ! [ -f "$work/evdev.ko" ]; then
  package=$(apt-cache depends linux-image-amd64 | awk '/Depends:/ { print $2; exit }')
  [ -n "$package" ] || fail "apt-cache knows no linux-image-amd64"
  echo "framebuffer: downloading $package, about 70 MB"
  (cd "$work" && apt-get download "$package" >/dev/null 2>&1) || fail "$package could not be downloaded"
  rm -rf "$work/unpacked" && mkdir "$work/unpacked"
  dpkg-deb --fsys-tarfile "$work"/linux-image-*.deb | tar -x -C "$work/unpacked" --wildcards './boot/vmlinuz*' '*/evdev.ko*'
  mv "$work"/unpacked/boot/vmlinuz* "$work/vmlinuz"
  find "$work/unpacked" -name evdev.ko -exec mv {} "$work/evdev.ko" \;
  rm -rf "$work/unpacked" "$work"/linux-image-*.deb
fi

# A file system in memory that holds the four files.
rm -rf "$work/files" && mkdir "$work/files"
g++ -std=c++20 -O1 -static -o "$work/files/init" "$root/tests/linux/init.cpp"
cp "$program" "$work/files/thimble-fb"
cp "$scene" "$work/files/scene.oct"
cp "$work/evdev.ko" "$work/files/evdev.ko"
(cd "$work/files" && find . | cpio --quiet -o -H newc | gzip -1) >"$work/initrd.gz"

# Waits until the serial line says $1 for the $2-th time.
await() {
  tries=0
  while [ "$(cat "$work/serial.log" 2>/dev/null | grep -c "$1")" -lt "$2" ]; do
    tries=$((tries + 1))
    [ "$tries" -lt 600 ] || return 1
    sleep 0.1
  done
}
rm -f "$work/serial.log" "$work/first.ppm" "$work/moved.ppm"
{
  await "init: start 1" 1 && sleep 3
  echo "screendump $work/first.ppm"
  sleep 1
  echo "sendkey right 400"
  sleep 2
  echo "screendump $work/moved.ppm"
  sleep 1
  echo "sendkey q"
  await "keyboard speaks" 2 || echo quit
  sleep 2
} | timeout 120 qemu-system-x86_64 -cpu max -m 256 -vga std -display none -no-reboot -kernel "$work/vmlinuz" \
  -initrd "$work/initrd.gz" -append "quiet vga=0x312 vt.global_cursor_default=1" -serial "file:$work/serial.log" -monitor stdio \
  >"$work/monitor.log" 2>&1 || fail "the emulated machine did not switch itself off"

expect() {
  [ "$(grep -c "$1" "$work/serial.log")" -eq "$2" ] || fail "not $2 times on the serial line: $1"
}
expect "init: evdev loaded: 1" 1
expect "init: status 0" 2
expect "init: console is text: 1" 2
expect "init: keyboard speaks: 1" 2
for shot in first moved; do
  [ -s "$work/$shot.ppm" ] || fail "there is no screen dump $shot.ppm"
done
if cmp -s "$work/first.ppm" "$work/moved.ppm"; then
  fail "the key moved nothing"
fi
echo "framebuffer: a picture on /dev/fb0 ($work/first.ppm), keys, and the console given back: passed"
