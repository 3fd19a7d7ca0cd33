#!/bin/sh
# The core in somebody else's build: with options of theirs, as a part of a project that is strict, in a folder whose name
# has spaces, by both generators. Not optimised: what is looked at is whether it builds.
# builds.sh ROOT WORK_DIR CXX
set -eu
root=$(cd "$1" && pwd)
work=$2
cxx=$3
rm -rf "$work"
mkdir -p "$work/a folder with spaces" "$work/parent"
work=$(cd "$work" && pwd)
cp -R "$root/CMakeLists.txt" "$root/include" "$root/src" "$work/a folder with spaces/"
# build WHAT SOURCE GENERATOR OPTION...
build() {
  what=$1
  source=$2
  generator=$3
  shift 3
  if ! { cmake -S "$source" -B "$work/build $what" -G "$generator" -Wno-dev -DCMAKE_CXX_COMPILER="$cxx" "$@" &&
    cmake --build "$work/build $what" --parallel 2; } >"$work/log" 2>&1; then
    grep -E 'rror' "$work/log" | head -n 20 >&2
    echo "builds: the core does not build $what" >&2
    exit 1
  fi
}
build 'with position independent code' "$work/a folder with spaces" 'Unix Makefiles' -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_POSITION_INDEPENDENT_CODE=ON
cat >"$work/parent/CMakeLists.txt" <<'EOF'
cmake_minimum_required(VERSION 3.20)
project(parent LANGUAGES CXX)
add_subdirectory("../a folder with spaces" thimble)
file(WRITE ${CMAKE_BINARY_DIR}/main.cpp "#include <thimble/thimble.h>\nint main() { return thimble::status_text(thimble::Status::kOk) == nullptr; }\n")
add_library(theirs ${CMAKE_BINARY_DIR}/main.cpp)
target_link_libraries(theirs PRIVATE thimble::thimble)
EOF
build 'in a strict project of shared libraries' "$work/parent" Ninja -DCMAKE_BUILD_TYPE=Debug -DBUILD_SHARED_LIBS=ON \
  "-DCMAKE_CXX_FLAGS=-Wmissing-declarations -Werror"
echo "builds: by both generators, in a folder with spaces, with position independent code, in a strict project"
