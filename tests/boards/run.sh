#!/bin/sh
# Builds and runs the firmware of every board under its emulator and judges it: a line a board and application, exit status 1
# when anything failed. Two boards at a time.
#   run.sh [--budgets] [BOARD...]      --budgets writes tests/budgets/firmware.csv and lit_frames.csv anew from what was measured
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
# One job of those below: what it says comes at its end, all at once. What needs a board's images comes after them.
if [ "${1:-}" = --job ]; then
  log=$THIMBLE_FIRMWARE/$2.said
  status=0
  {
    case $2 in
      examples) sh "$here/examples.sh" "$THIMBLE_FIRMWARE/examples" || status=1 ;;
      frames) sh "$here/golden_frames.sh" || status=1 ;;
      *)
        sh "$here/board.sh" "$2" || status=1
        sh "$here/silicon.sh" "$2" || status=1
        ;;
    esac
    case $2 in
      lm3s6965evb)
        sh "$here/effects.sh" || status=1
        sh "$here/own_scene.sh" lm3s6965evb || status=1
        sh "$here/water.sh" || status=1
        ;;
      microbit)
        sh "$here/own_scene.sh" microbit || status=1
        sh "$here/formats.sh" microbit || status=1
        sh "$here/flash.sh" "$THIMBLE_FIRMWARE/flash" || status=1
        ;;
      pico)
        sh "$here/cores.sh" pico || status=1
        sh "$here/uf2.sh" pico || status=1
        ;;
      gba) sh "$here/cartridge.sh" gba || status=1 ;;
    esac
    # Here and below LONG=1 is all boards; else what a scene adds is tried once for each kind of core.
    case $2 in
      lm3s6965evb | microbit | mps2-an500 | netduinoplus2 | sifive_e | raspi0 | gba) sh "$here/scenes.sh" "$2" || status=1 ;;
      examples | frames) ;;
      *) [ -z "${LONG:-}" ] || sh "$here/scenes.sh" "$2" || status=1 ;;
    esac
    ! grep -q "^$2;" tests/budgets/scene_frames.csv || sh "$here/scene_frames.sh" "$2" || status=1
    case $2 in microbit | mps2-an500) sh "$here/emulate.sh" "$2" || status=1 ;; esac
    # Each form of image: .hex and .elf on Arm and RISC-V, .uf2, .gba.
    case $2 in
      microbit | sifive_e | pico | gba) sh "$here/images.sh" "$2" || status=1 ;;
      examples | frames) ;;
      *) [ -z "${LONG:-}" ] || sh "$here/images.sh" "$2" || status=1 ;;
    esac
    # One board of each compiler and emulator, the display of one bit among them.
    case $2 in
      sifive_e | pico-oled | gba) sh "$here/new.sh" "$2" || status=1 ;;
      lm3s6965evb | raspi0 | pico) [ -z "${LONG:-}" ] || sh "$here/new.sh" "$2" || status=1 ;;
    esac
    [ $status = 0 ] || echo "$2: FAILED, by what stands above"
  } >"$log" 2>&1
  cat "$log"
  exit $status
fi
update=0
if [ "${1:-}" = --budgets ]; then
  update=1
  shift
fi
export THIMBLE_FIRMWARE=build/boards
work=$THIMBLE_FIRMWARE
budgets=tests/budgets/firmware.csv
lit_frames=tests/budgets/lit_frames.csv
mkdir -p "$work"
g++ -std=c++20 -O1 -o "$work/stack_bound" tests/checks/stack_bound.cpp
g++ -std=c++20 -O1 -o "$work/qemu_screen" tests/boards/qemu_screen.cpp

all=$(cd platform/boards && for folder in */; do echo "${folder%/}"; done)
boards=${*:-$all}
for board in $boards; do
  rm -rf "${work:?}/$board.results" "${work:?}/$board.measured"
done
rm -f "$work"/*.said
failed=0
# Those with the largest pictures take longest, so they begin; then those with jobs of their own behind them.
{
  for board in $boards; do
    . platform/board_facts.sh
    case $board in
      lm3s6965evb) echo "100000 $board" ;;
      *) echo "$(($(fact WIDTH_PX) * $(fact HEIGHT_PX))) $board" ;;
    esac
  done
  printf '0 examples\n0 frames\n'
} | sort -k1,1nr -k2 | cut -d ' ' -f 2 | UPDATE=$update xargs -P 2 -n 1 sh "$here/run.sh" --job || failed=1
# What must be one number everywhere.
sh "$here/same.sh" $boards || failed=1

if [ $update = 1 ]; then
  {
    grep '^#' "$budgets"
    echo board,app,flash_bytes,ram_bytes,stack_bound_bytes,stack_painted_bytes
    for board in $all; do
      if [ -f "$work/$board.measured" ]; then
        # A little room, so that the table does not change with every line of code: flash in KiB, stacks in 64 bytes.
        awk -F, -v OFS=, 'function up(value, step) { return int((value + step - 1) / step) * step }
          { print $1, $2, up($3, 1024), $4, up($5, 64), up($6, 64) }' "$work/$board.measured"
        # What was left out this time (LONG) keeps its row.
        grep "^$board," "$budgets" | while IFS=, read -r _ app rest; do
          grep -q "^$board,$app," "$work/$board.measured" || echo "$board,$app,$rest"
        done
      else
        grep "^$board," "$budgets" || true
      fi
    done
  } >"$work/budgets.csv"
  mv "$work/budgets.csv" "$budgets"
  # The rows of what was measured, and those of the rest.
  {
    grep '^#' "$lit_frames"
    echo board,scene,instructions
    {
      for board in $boards; do
        cat "$work/$board.lit_frames"
      done
      sed '/^#/d; /^board,/d' "$lit_frames"
    } | awk -F, '!seen[$1, $2]++' | sort
  } >"$work/lit_frames.csv"
  mv "$work/lit_frames.csv" "$lit_frames"
  echo "test-boards: wrote $budgets, $lit_frames"
fi
if [ $failed = 0 ]; then
  echo "test-boards: all passed"
else
  # A log may keep its end alone.
  for log in "$work"/*.said; do
    if grep -q FAILED "$log"; then
      grep FAILED "$log"
      tail -n 8 "$log"
    fi
  done >&2
  echo "test-boards: something failed, see above" >&2
fi
exit $failed
