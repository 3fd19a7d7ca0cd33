#!/bin/sh
# Holds what a frame with light takes to tests/budgets/lit_frames.csv: lit_budget.sh BOARD SCENE LOG. LOG is what bench said.
# Says what is wrong; exit status 1 for a frame that takes over one per cent more (other versions of the compiler).
# run.sh --budgets (UPDATE=1) writes the table anew.
set -eu
cd "$(dirname "$0")/../.."
. tests/boards/three_digits.sh
cost=$(awk -F, "$three_digits"'$1 == "lit.instructions_median" { print three_digits($2) }' "$3")
if [ -z "$cost" ]; then
  echo "bench says no instructions of a lit frame"
  exit 1
fi
echo "$1,$2,$cost" >>"$THIMBLE_FIRMWARE/$1.lit_frames"
[ "${UPDATE:-0}" = 0 ] || exit 0
most=$(sed -n "s/^$1,$2,//p" tests/budgets/lit_frames.csv)
if [ -z "$most" ]; then
  echo "lit frames of $2 have no row in tests/budgets/lit_frames.csv (tests/boards/run.sh --budgets writes it)"
  exit 1
fi
if [ "$cost" -gt "$((most + most / 100))" ]; then
  echo "a lit frame of $2 takes $cost instructions, the table says $most"
  exit 1
fi
