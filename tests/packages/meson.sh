#!/bin/sh
# The source archive with Meson: as a subproject by its wrap, and installed; what is installed is found by pkg-config, and
# the golden frames, drawn with it, have the CRCs that they have everywhere.
name=meson
. tests/packages/common.sh
need meson ninja pkg-config
mkdir -p "$WORK/app/subprojects/packagefiles"
cp tests/packages/meson/meson.build platform/examples/ball/main.cpp tests/packages/panels.cpp "$WORK/app/"
cp "$PACKAGES/thimble.wrap" "$WORK/app/subprojects/"
cp "$PACKAGES/thimble-$VERSION.tar.gz" "$WORK/app/subprojects/packagefiles/"
logged meson setup --buildtype=plain --fatal-meson-warnings --prefix=/opt/thimble --libdir=lib "$WORK/app/build" "$WORK/app"
logged ninja -j1 -C "$WORK/app/build"
same_ball "$WORK/app/build/ball"
no_drivers "$WORK/app/build/ball"
same_panels "$WORK/app/build/panels"

# A subproject is installed by what installs the project.
DESTDIR="$(cd "$WORK" && pwd)/root" logged meson install --no-rebuild -C "$WORK/app/build"
installed=$WORK/root/opt/thimble
[ "$(cd "$installed/include" && find thimble -name '*.h' | sort)" = "$(cd include && find thimble -name '*.h' | sort)" ] ||
  fail "the headers installed are not those of the tree"
export PKG_CONFIG_PATH="$installed/lib/pkgconfig"
[ "$(pkg-config --modversion thimble)" = "$VERSION" ] || fail "pkg-config says version $(pkg-config --modversion thimble)"
flags=$(pkg-config --define-variable=prefix="$installed" --cflags --libs thimble)
case $flags in *"$installed/include"*"$installed/lib"*-lthimble*) ;; *) fail "pkg-config says $flags" ;; esac
logged c++ -std=c++17 platform/examples/ball/main.cpp $flags -o "$WORK/ball"
same_ball "$WORK/ball"
logged c++ -std=c++17 tests/packages/panels.cpp $flags -o "$WORK/panels"
same_panels "$WORK/panels"
logged c++ -std=c++20 -O1 -Itests tests/packages/golden.cpp tests/golden/scenes.cpp $flags -o "$WORK/golden"
logged "$WORK/golden"
say "subproject, installed and found by pkg-config: $(cat "$WORK/log"), the ball is drawn, also on panels"
