#!/bin/sh
# The installed libraries for desktops: the examples are built in a project that knows only the package (find_package, then
# pkg-config), and run; the C face is held to C99.
name=library
. tests/packages/common.sh
need cmake ninja pkg-config
prefix=$(cd "$WORK" && pwd)/prefix
logged cmake --install build/release --prefix "$prefix"
logged cmake -S tools/library/examples -B "$WORK/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix"
logged cmake --build "$WORK/build" -- -j1
castle=$prefix/share/thimble/scenes/castle.vox
PKG_CONFIG_PATH=$prefix/lib/pkgconfig
LD_LIBRARY_PATH=$prefix/lib
export PKG_CONFIG_PATH LD_LIBRARY_PATH
[ "$(pkg-config --modversion thimble_files)" = "$VERSION" ] || fail "pkg-config says another version"
logged c++ -std=c++20 -O2 tools/library/examples/lidar.cpp $(pkg-config --cflags --libs thimble_files) -o "$WORK/lidar"
logged c++ -std=c++20 -O2 tools/library/examples/dig_and_place.cpp $(pkg-config --cflags --libs thimble_files thimble_wide) \
  -o "$WORK/dig"
logged cc -std=c99 -Wall -Wextra -Wpedantic -Wno-declaration-after-statement -Werror tests/packages/files.c \
  $(pkg-config --cflags --libs thimble_files) -o "$WORK/files_c"
# What the programs draw is looked at: it has many colours, and another once it was dug.
picture() {
  colors=$($python -c 'import sys; d = open(sys.argv[1], "rb").read()[15:]; print(len(set(zip(*[iter(d)] * 3))))' "$1") || exit 1
  [ "$colors" -ge "$2" ] || fail "$1 has $colors colours"
}
logged "$WORK/build/view" "$castle" 3 "$WORK/view.ppm"
picture "$WORK/view.ppm" 20
logged "$WORK/build/dig_and_place" "$castle" 1 "$WORK/dig1.ppm"
logged "$WORK/dig" "$castle" 20 "$WORK/dig20.ppm"
grep -q '^20 edits' "$WORK/log" || fail "not every frame had an edit: $(cat "$WORK/log")"
picture "$WORK/dig20.ppm" 20
! cmp -s "$WORK/dig1.ppm" "$WORK/dig20.ppm" || fail "nothing was dug"
"$WORK/build/lidar" "$castle" >"$WORK/one.f32" 2>"$WORK/said" || fail "lidar: $(cat "$WORK/said")"
"$WORK/lidar" "$castle" >"$WORK/two.f32" 2>>"$WORK/said" || fail "lidar: $(cat "$WORK/said")"
[ "$(wc -c <"$WORK/one.f32")" = 4000000 ] && cmp "$WORK/one.f32" "$WORK/two.f32" || fail "lidar writes other distances"
mkdir "$WORK/thumbnails"
logged "$WORK/build/server" "$WORK/thumbnails" "$prefix"/share/thimble/scenes/*.scene
for scene in "$prefix"/share/thimble/scenes/*.scene; do
  [ -s "$WORK/thumbnails/$(basename "$scene").png" ] || fail "server made no $(basename "$scene").png"
done
if "$WORK/build/server" "$WORK/thumbnails" "$WORK/log" 2>/dev/null; then fail "server takes what is no model"; fi
logged "$WORK/files_c"
logged "$WORK/files_c" "$castle"
# The command's own objects, and nothing of theirs under a name that others may have.
names=$(nm -D --defined-only "$prefix/lib/libthimble_files.so" | awk '{ print $3 }' | c++filt | grep -vE \
  '^(thimble_file_|thimble::files::|(typeinfo|vtable) (name )?for thimble::files::|_(init|fini|end|edata)$|__bss_start$)|std::' || true)
[ -z "$names" ] || fail "libthimble_files.so exports more than its headers: $(echo "$names" | head -n 5)"
say "find_package and pkg-config: view, dig_and_place, lidar, server and a program in C99 run: $(sed -n 's/.*, \(.* a second\).*/\1/p' "$WORK/said" | tail -n 1)"
