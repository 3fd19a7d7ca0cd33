#!/bin/sh
# Runs the portable cases, golden frames and frames by brick maps among them, as other machines compute them: of both orders of
# bytes, with 32 and 64 bits, with words that stand at any even address. A machine whose compiler or emulator is not
# here is skipped (`.ci/deps machines` installs them). Without names one of each kind: powerpc and m68k are as mips, but
# for m68k's words at even addresses.
# machines.sh ROOT WORK_DIR [MACHINE...]
set -eu
root=$1
work=$2
shift 2
[ $# -gt 0 ] || set -- i686 s390x mips
run=0
failed=0
for machine in "$@"; do
  cxx=$machine-linux-gnu-g++
  # g++ names a processor of its own, qemu the family.
  case $machine in
    i686) emulator=qemu-i386 bits='32 bits, little-endian' ;;
    s390x) emulator=qemu-s390x bits='64 bits, big-endian' ;;
    mips) emulator=qemu-mips bits='32 bits, big-endian' ;;
    powerpc) emulator=qemu-ppc bits='32 bits, big-endian' ;;
    m68k) emulator=qemu-m68k bits='32 bits, big-endian, words at even addresses' ;;
    *)
      echo "machines: no such machine: $machine" >&2
      exit 2
      ;;
  esac
  if ! command -v "$cxx" >/dev/null 2>&1 || ! command -v $emulator >/dev/null 2>&1; then
    echo "machines: skipped $machine: $cxx or $emulator is not installed"
    continue
  fi
  # A room is one unit, and the emulator makes up for -O1: half of the time of -O2, file by file.
  build=$work/$machine
  program=thimble_golden_tests_O1
  mkdir -p "$build"
  if ! { cmake -S "$root" -B "$build" -G Ninja -Wno-dev -DCMAKE_SYSTEM_NAME=Linux \
    -DCMAKE_SYSTEM_PROCESSOR=$machine -DCMAKE_CXX_COMPILER=$cxx -DCMAKE_EXE_LINKER_FLAGS=-static \
    -DCMAKE_BUILD_TYPE=None -DTHIMBLE_TOOLS=OFF -DTHIMBLE_TESTS=OFF -DTHIMBLE_GOLDEN=ON -DTHIMBLE_GOLDEN_LEVELS=O1 \
    -DTHIMBLE_CORE_UNITY=ON &&
    cmake --build "$build" --target $program; } >"$build/log" 2>&1; then
    tail -n 30 "$build/log" >&2
    echo "machines: the core or its cases do not build for $machine" >&2
    failed=1
    continue
  fi
  status=0
  timeout 300 $emulator "$build/$program" >"$build/said" 2>&1 || status=$?
  if [ $status != 0 ] || ! grep -q ' frames by maps, 0 wrong' "$build/said"; then
    grep -v passed "$build/said" | head -n 20 >&2
    echo "machines: $machine computes something else (exit status $status)" >&2
    failed=1
    continue
  fi
  echo "machines: $machine ($bits) computes the same"
  run=1
done
[ $failed = 0 ] || exit 1
[ $run = 1 ] || exit 77
