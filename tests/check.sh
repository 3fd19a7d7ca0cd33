#!/bin/sh
# The quick tests of a build, two groups at a time, one line a group; what fails is named, with all that it said.
# A group is a folder of tests, the golden frames, or the checks of the sources that take seconds. Cases of
# tests/slow_cases.txt are left to `make test`.      check.sh BUILD_DIR [--group NAME]
set -u
cd "$(dirname "$0")/.." || exit 1
build=$1

if [ "${2:-}" = "" ]; then
  mkdir -p "$build/check"
  # The longest begin.
  first='commands platform golden trace wide light'
  others=$(for file in tests/*/test_*.cpp; do basename "$(dirname "$file")"; done | sort -u |
    grep -vxE "$(echo "$first soak" | tr ' ' '|')") # all of soak is slow
  if ! printf '%s\n' $first $others checks | xargs -P 2 -n 1 sh tests/check.sh "$build" --group; then
    echo "check: something failed, see above" >&2
    exit 1
  fi
  echo "check: all passed; \`make test\` runs slow cases, too; \`make test-all\` sanitizers, clang, fuzzing, lint"
  exit
fi

group=$3
log=$build/check/$group.log
started=$(date +%s%N)
status=0
case $group in
  golden)
    { "$build/thimble_golden_tests_O2" && "$build/thimble_golden_tests_O2" --arena 6144; } >"$log" 2>&1 || status=1
    what='all frames and cases, then those that 6 KiB hold'
    ;;
  checks)
    : >"$log"
    quick='layering words format sizes links subjects'
    for check in $quick; do
      stamp=
      [ "$check" != format ] || stamp=$build/check/format.stamp
      sh "tests/checks/$check.sh" . $stamp >"$log.one" 2>&1 || case $? in
        77) ;;
        *)
          status=1
          echo "tests/checks/$check.sh:"
          cat "$log.one"
          ;;
      esac >>"$log"
    done
    what=$quick
    ;;
  *)
    # A comma would end a name.
    slow=$(sed -n 's/,/*/g; s/^~//; s/^\([^#].*\)$/\1*,/p' tests/slow_cases.txt | tr -d '\n')
    "$build/thimble_tests" --source-file="*/$group/test_*" ${slow:+"--test-case-exclude=$slow"} >"$log" 2>&1 || status=1
    what=$(sed -n 's/^\[doctest\] test cases: *\([0-9]*\) .*/\1 cases/p' "$log")
    case $what in '' | '0 cases') status=1 ;; esac
    ;;
esac
tenths=$((($(date +%s%N) - started) / 100000000))
if [ $status = 0 ]; then
  printf '%-12s %3d.%d s  %s\n' "$group" $((tenths / 10)) $((tenths % 10)) "$what"
else
  { printf '%-12s %3d.%d s  FAILED\n' "$group" $((tenths / 10)) $((tenths % 10))
    cat "$log"
    sed -n "s/^TEST CASE: */FAILED in $group: /p" "$log" | sort -u
  } >&2
fi
exit $status
