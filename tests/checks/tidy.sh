#!/bin/sh
# clang-tidy over the sources of some folders. tidy.sh ROOT BUILD_DIR FOLDER...
# BUILD_DIR is only configured, with clang, so that clang-tidy reads flags it knows.
set -eu
root=$(cd "$1" && pwd)
mkdir -p "$2"
build=$(cd "$2" && pwd)
shift 2
if ! command -v clang-tidy >/dev/null 2>&1; then
  echo "skipped: clang-tidy is not installed"
  exit 77
fi
# clang-tidy reads a file once for each command that compiles it, so there are no tests: they would only build the core
# and the applications again, at other levels of optimisation.
configure() {
  cmake -S "$root" -B "$1" -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DTHIMBLE_TESTS=OFF -DTHIMBLE_GOLDEN=OFF --no-warn-unused-cli \
    --log-level=WARNING -Wno-dev -DTHIMBLE_UNITY="$2" -DTHIMBLE_CORE_UNITY="$2" -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null
  ninja -C "$1" --quiet thimble_generated
}
configure "$build" ON
cd "$root"
folders=
for folder in "$@"; do
  [ -d "$folder" ] && folders="$folders $folder"
done
work=$build/lint
rm -rf "$work"
mkdir -p "$work"
# What only a board's compiler can read is linted by tests/boards/tidy.sh; what needs Python's headers, or hooks of gcc, by none.
find $folders -name '*.cpp' -print | grep -Ev '^(platform/(arch|chips|counted|drivers|examples|web|boards/[^/]+)|tools/(web|python))/' |
  sed "s|^|$PWD/|" >"$work/files"
# A file costs seconds before its own first line: every check reads the standard library's declarations. So what the
# build compiles as one file is linted as one. Such a unit that is clean proves its files; those of another are linted
# alone. The largest begin: otherwise one processor waits at the end for such a file.
files_of() { sed -n 's/^#include "\(.*\)"$/\1/p' "$1"; }
sed -n 's|^ *"file": "\(.*/Unity/unity_.*\)",*$|\1|p' "$build/compile_commands.json" | while read -r unit; do
  if files_of "$unit" | grep -qxFf "$work/files"; then
    echo "$(files_of "$unit" | xargs cat | wc -l) $unit"
    files_of "$unit" >>"$work/in_units"
  fi
done >"$work/sizes"
touch "$work/in_units"
grep -vxFf "$work/in_units" "$work/files" | while read -r file; do
  echo "$(wc -l <"$file") $file"
done >>"$work/sizes"
sort -rn "$work/sizes" | cut -d ' ' -f 2 >"$work/list"
# The analyzer leaves alone what a unit includes, unless a flag says otherwise. It follows the paths of a function for so
# many steps, not for its own 225,000: those would take ten times as long, and no fault of ours was ever found there. In the
# tools and the ports it takes three quarters of the time: it looks at the core.
deep='--extra-arg=-Xclang --extra-arg=-analyzer-config --extra-arg=-Xclang --extra-arg=max-nodes=4000'
included="--config-file=$root/.clang-tidy --extra-arg=-Xclang --extra-arg=-analyzer-opt-analyze-headers"
# lint BUILD <FILES: prints those with complaints; what is said of them lies in $work.
lint() {
  while read -r file; do
    options=$deep
    case $file in */Unity/unity_*) options="$options $included" ;; esac
    case $file in "$root"/tools/* | "$1"/tools/* | "$root"/platform/* | "$1"/platform/*) options="$options --checks=-clang-analyzer-*" ;; esac
    echo "$file $options"
  done | xargs -r -P 2 -L 1 sh -c 'build=$1
    shift
    said=$0/$(echo "$1" | tr / _)
    clang-tidy -p "$build" --quiet "$@" >"$said.log" 2>"$said.noise" || echo "$1"' "$work" "$1"
}
lint "$build" <"$work/list" >"$work/doubtful"
[ ! -s "$work/doubtful" ] || configure "$build/alone" OFF
while read -r file; do
  case $file in */Unity/unity_*) files_of "$file" ;; *) echo "$file" ;; esac
done <"$work/doubtful" | lint "$build/alone" >"$work/bad"
while read -r file; do
  said=$work/$(echo "$file" | tr / _)
  cat "$said.log"
  grep -v 'warnings generated\|warnings treated as errors\|Suppressed\|Use -header-filter' "$said.noise" || true
done <"$work/bad"
if [ -s "$work/bad" ]; then
  echo "tidy: clang-tidy has complaints" >&2
  exit 1
fi
