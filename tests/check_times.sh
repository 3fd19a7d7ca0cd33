#!/bin/sh
# What `make check` builds again after an edit: seconds by the clock and of the processor, for each file that is named, or
# each public header. No compiler cache has a part in it. Nothing is edited: a file gets a newer time.
#   check_times.sh [BUILD_DIR [FILE...]]       BUILD_DIR: build/release, which `make check` configures
set -eu
cd "$(dirname "$0")/.."
build=${1:-build/release}
[ $# = 0 ] || shift
[ $# != 0 ] || set -- $(find include/thimble -name '*.h' | sort)
export CCACHE_DISABLE=1
# What is stale already counts for no file.
make_it() {
  ninja -C "$build" thimble_tests thimble_golden_tests_O2 >"$build/check_times.log" 2>&1 || {
    tail -n 20 "$build/check_times.log" >&2
    return 1
  }
}
# The user's and the system's seconds of all that this shell has waited for: the second line of `times`.
processor() {
  times >"$build/check_times.used"
  awk 'NR == 2 {
    for (i = 1; i <= 2; ++i) { split($i, part, /[ms]/); sum += 60 * part[1] + part[2] }
    printf "%d\n", 100 * sum
  }' "$build/check_times.used"
}
make_it
echo 'file,objects,clock_s,processor_s'
for file in "$@"; do
  touch -c "$file"
  began=$(date +%s%N)
  # Not in $(...): what a child of this shell waits for is counted as its own, too late.
  processor >"$build/check_times.before"
  make_it
  processor >"$build/check_times.after"
  ended=$(date +%s%N)
  objects=$(grep -c 'Building C' "$build/check_times.log" || true)
  awk -v file="$file" -v objects="$objects" -v clock=$(((ended - began) / 10000000)) \
    -v before="$(cat "$build/check_times.before")" -v after="$(cat "$build/check_times.after")" \
    'BEGIN { printf "%s,%d,%.0f,%.0f\n", file, objects, clock / 100, (after - before) / 100 }'
done
