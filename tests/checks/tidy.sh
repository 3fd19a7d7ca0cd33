#!/bin/sh
# clang-tidy over the sources of some folders. tidy.sh ROOT BUILD_DIR FOLDER...
# BUILD_DIR is only configured, with clang, so that clang-tidy reads flags it knows.
set -eu
root=$(cd "$1" && pwd)
build=$2
shift 2
if ! command -v clang-tidy >/dev/null 2>&1; then
  echo "skipped: clang-tidy is not installed"
  exit 77
fi
# clang-tidy reads a file once for each command that compiles it, so there are no tests: they would only build the core
# and the applications again, at other levels of optimisation.
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DTHIMBLE_TESTS=OFF -DTHIMBLE_GOLDEN=OFF --no-warn-unused-cli \
  --log-level=WARNING -Wno-dev -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null
ninja -C "$build" --quiet thimble_generated
cd "$root"
folders=
for folder in "$@"; do
  [ -d "$folder" ] && folders="$folders $folder"
done
log=$build/tidy.log
mkdir -p "$build"
# What only a board's compiler can read is linted by tests/boards/tidy.sh. The largest begin, since they take longest:
# otherwise one processor waits at the end for such a file.
ours() {
  find $folders -name '*.cpp' -print | grep -Ev '^platform/(arch|drivers|examples|boards/[^/]+)/' | xargs -r ls -S
}
if ! ours | xargs -r -P 2 -n 1 clang-tidy -p "$build" --quiet >"$log" 2>"$log.noise"; then
  cat "$log"
  grep -v 'warnings generated\|warnings treated as errors\|Suppressed\|Use -header-filter' "$log.noise" || true
  echo "tidy: clang-tidy has complaints" >&2
  exit 1
fi
