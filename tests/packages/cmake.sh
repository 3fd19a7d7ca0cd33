#!/bin/sh
# The source archive with CMake: fetched by FetchContent from a file, where the ball is built; then by itself, installed in
# an empty prefix, found by find_package and by pkg-config, moved elsewhere and found again.
name=cmake
. tests/packages/common.sh
need cmake ninja
archive=$(cd "$PACKAGES" && pwd)/thimble-$VERSION.tar.gz
# The core needs no package, so none may be looked for. Rooms are compiled as one file where that is not what is tried.
none=
for package in ZLIB nlohmann_json CLI11 doctest; do none="$none -DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"; done
logged cmake -S tests/packages/cmake -B "$WORK/fetch" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DTHIMBLE_CORE_UNITY=ON -DARCHIVE="$archive" \
  $none --no-warn-unused-cli
logged cmake --build "$WORK/fetch" -- -j1
same_ball "$WORK/fetch/ball"
no_drivers "$WORK/fetch/ball"
same_panels "$WORK/fetch/panels"
unpack "thimble-$VERSION.tar.gz"
logged cmake -S "$WORK/thimble-$VERSION" -B "$WORK/build" -G Ninja -DCMAKE_BUILD_TYPE=Debug $none --no-warn-unused-cli
logged cmake --build "$WORK/build" -- -j1
logged cmake --install "$WORK/build" --prefix "$WORK/first"
for prefix in first moved; do
  [ $prefix = first ] || mv "$WORK/first" "$WORK/moved"
  logged cmake -S tests/consumer -B "$WORK/found_$prefix" -G Ninja -DCMAKE_PREFIX_PATH="$(cd "$WORK/$prefix" && pwd)" \
    $none --no-warn-unused-cli
  logged cmake --build "$WORK/found_$prefix"
  same_ball "$WORK/found_$prefix/consumer"
  same_panels "$WORK/found_$prefix/consumer_panels"
done
if command -v pkg-config >/dev/null 2>&1; then
  export PKG_CONFIG_PATH="$WORK/moved/lib/pkgconfig"
  [ "$(pkg-config --modversion thimble)" = "$VERSION" ] || fail "pkg-config says version $(pkg-config --modversion thimble)"
  logged c++ -std=c++17 platform/examples/ball/main.cpp $(pkg-config --cflags --libs thimble) -o "$WORK/by_pkg_config"
  same_ball "$WORK/by_pkg_config"
  logged c++ -std=c++20 -O1 -Itests tests/packages/golden.cpp tests/golden/scenes.cpp $(pkg-config --cflags --libs thimble) -o "$WORK/golden"
  logged "$WORK/golden"
fi
# A project of `thimble new` by a stand-in for the Pico's SDK, in C++ on an OLED and in C on an LCD.
if command -v arm-none-eabi-g++ >/dev/null 2>&1; then
  export PICO_SDK_PATH="$PWD/tests/packages/new"
  project oled --board pico --panel ssd1306 castle
  project lcd-1 --board pico --panel st7789 --language c castle
  for one in oled lcd-1; do
    logged cmake -S "$WORK/$one" -B "$WORK/$one/build" -G Ninja -DTHIMBLE="$archive" -DTHIMBLE_CORE_UNITY=ON -DCMAKE_SYSTEM_NAME=Generic -DCMAKE_BUILD_TYPE=None \
      -DCMAKE_C_COMPILER=arm-none-eabi-gcc -DCMAKE_CXX_COMPILER=arm-none-eabi-g++ -DCMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY \
      -DCMAKE_C_FLAGS="$(echo "$arm_options" | sed s/-fno-rtti//)" -DCMAKE_CXX_FLAGS="$arm_options -fno-threadsafe-statics -fno-tree-loop-distribute-patterns" \
      -DBARE_SCRIPT="$PWD/tests/packages/bare/arm.ld" \
      -DBARE_SOURCES="$PWD/tests/packages/bare/start.cpp;$PWD/platform/arch/common/memory.cpp"
    logged cmake --build "$WORK/$one/build" -- -j1
  done
  if command -v qemu-system-arm >/dev/null 2>&1; then
    shows_scene oled ssd1306 128x64 ink in_qemu arm "$WORK/oled/build/oled"
    shows_scene lcd-1 st7789 240x240 color in_qemu arm "$WORK/lcd-1/build/lcd-1"
    say "projects for the Pico's SDK, in C++ and in C, show their scene on a panel"
  fi
fi
say "FetchContent, find_package and pkg-config, the prefix moved: the ball is drawn, also on panels (CPM is not here: it calls FetchContent)"
