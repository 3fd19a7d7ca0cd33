#!/bin/sh
# Makes every archive again, compares, then unpacks each in an empty folder and builds it by its own rules: a line an
# ecosystem, exit status 1 when one failed. Two at a time.
#   run.sh [NAME...]      SCHEMAS=DIR: published schemas that the manifests are held to as well
set -eu
cd "$(dirname "$0")/../.."
PACKAGES=$PWD/build/packages
work=$PWD/build/test-packages
LIBTHIMBLE=$PWD/build/release/libthimble.a
VERSION=$(sed -n 's/^project(thimble VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)
export PACKAGES LIBTHIMBLE VERSION
if [ "${1:-}" = --one ]; then
  export WORK="$work/$2"
  exec sh "tests/packages/$2.sh"
fi
mkdir -p "$work"
# What each package's ball and panels must be, from the library of this tree.
g++ -std=c++17 -O1 -Iinclude platform/examples/ball/main.cpp "$LIBTHIMBLE" -o "$work/ball"
"$work/ball" >"$work/ball.txt"
g++ -std=c++17 -O1 -Iinclude tests/packages/panels.cpp "$LIBTHIMBLE" -o "$work/panels"
"$work/panels" >"$work/panels.txt"
# What a panel shows that got what a project of `thimble new` sends.
g++ -std=c++20 -O1 -Iinclude -Itests tests/packages/new/panel.cpp tests/support/page_model.cpp tests/support/color_model.cpp -o "$work/panel"
[ "$(grep -c '[*#]' "$work/ball.txt")" -gt 16 ] || {
  echo "test-packages: the README's program draws no ball" >&2
  exit 1
}
failed=0
# Those that take longest begin.
names=${*:-python library meson arduino cmake pair esp_idf zephyr platformio debian manifests}
for one in $names; do
  rm -rf "${work:?}/$one"
  mkdir -p "$work/$one"
done
printf '%s\n' $names | xargs -P 2 -n 1 sh tests/packages/run.sh --one || failed=1
[ $failed = 0 ] && echo "test-packages: all passed"
exit $failed
