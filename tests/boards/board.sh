#!/bin/sh
# Builds and judges one board (run.sh): board.sh BOARD. Results are printed as lines at the end, all at once.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
board=$1
work=$THIMBLE_FIRMWARE/$board
results=$THIMBLE_FIRMWARE/$board.results
measured=$THIMBLE_FIRMWARE/$board.measured
. platform/board_facts.sh
limit_s=${THIMBLE_EMULATOR_LIMIT_S:-600}
failed=0
mkdir -p "$work"
: >"$results"
: >"$measured"
: >"$THIMBLE_FIRMWARE/$board.lit_frames"
# say APP RESULT...
say() {
  app_said=$1
  shift
  printf '%-18s %-10s %s\n' "$board" "$app_said" "$*" >>"$results"
}
# fail APP SENTENCE
fail() {
  say "$1" "FAILED: $2"
  failed=1
}
# emulate APP KEYS LOG: runs it, sending KEYS again and again, since a UART that is not on yet loses them. Sets `status`.
emulate() {
  status=0
  if [ -n "$2" ]; then
    for i in $(seq 100); do
      printf '%s' "$2" 2>/dev/null || break
      sleep 0.1
    done | timeout "$limit_s" sh platform/emulate.sh "$board" "$1" >"$3" 2>"$3.noise" || status=$?
  else
    timeout "$limit_s" sh platform/emulate.sh "$board" "$1" </dev/null >"$3" 2>"$3.noise" || status=$?
  fi
}

# An emulator of the board's own is slow: a choice of the cases, unless LONG=1.
default='selftest golden lit worlds bricks demo bench particles'
if [ -n "$(fact EMULATOR)" ]; then
  if ! why=$(sh "platform/emulators/$(fact EMULATOR)/fetch.sh"); then
    # Where everything is installed it must be there.
    [ -z "${CI:-}" ] || fail all "$why"
    say all "skipped: $why"
    cat "$results"
    exit $failed
  fi
  export PLACE=flash
  if [ -z "${LONG:-}" ]; then
    default='selftest golden demo bench particles'
    export CASE_STEP=16 MEASURED=ON
  fi
fi
# A board may leave to another one what the two have in common.
if [ -n "$(fact TESTS)" ] && [ -z "${LONG:-}" ]; then
  default=$(fact TESTS)
fi
# Of those that hold the demonstration's scene in RAM, two will do.
case $board in lm3s6965evb | pico) default="$default dig" ;; esac
# One board of each kind of core: Cortex-M3, M0, M7, M4, RV32.
case $board in lm3s6965evb | microbit | mps2-an500 | netduinoplus2 | sifive_e) default="$default map_light" ;; esac
# The applications that there are; faults is judged by itself below.
apps=
for app in ${THIMBLE_TEST_APPS:-$default}; do
  { [ -f "platform/apps/$app.cpp" ] || grep -q "^int $app()" tests/boards/apps/cases.cpp; } && apps="$apps $app"
done
list=faults
for app in $apps; do
  list="$list;$app"
done
if ! FRAMES=4 sh platform/build.sh "$board" "$list" demo >"$work/build.log" 2>&1; then
  cat "$work/build.log"
  fail all "does not build"
  cat "$results"
  exit 1
fi

for app in $apps; do
  log=$work/$app.log
  emulate "$app" "" "$log"
  said=
  if [ "$status" != 0 ]; then
    tail -n 5 "$log" >&2
    fail "$app" "exit status $status$([ "$status" = 124 ] && echo " (no end within $limit_s s)")"
  elif [ "$app" = selftest ] || [ "$app" = golden ] || [ "$app" = lit ] || [ "$app" = worlds ] || [ "$app" = bricks ] || [ "$app" = map_light ]; then
    said=$(grep -E '^[1-9][0-9]* passed, 0 failed' "$log" | head -n 1)
    [ -n "$said" ] || fail "$app" "did not say how many passed"
    said="$said, $(sed -n 's/^\([0-9]* skipped\).*/\1/p' "$log" | head -n 1); "
  elif [ "$app" = bench ]; then
    said="$(sed -n 's/^\([a-z_]*\)\.instructions_median,\([0-9]*\).*/\2 instructions a frame (\1)/p' "$log" | tr '\n' ';')"
    said="${said%;}; "
    # What a frame may cost.
    while IFS=, read -r row_board most least; do
      [ "$row_board" = "$board" ] || continue
      cost=$(sed -n 's/^brick_map\.instructions_median,//p' "$log")
      times=$(sed -n 's/^brick_map\.times_faster_than_dda,//p' "$log")
      [ "${cost:-999999999}" -le "$most" ] || fail bench "a frame takes ${cost:-no} instructions, at most $most"
      if [ -n "$least" ] && ! awk "BEGIN { exit !(${times:-0} >= $least) }"; then
        fail bench "${times:-not} times faster than the textbook's tracer, at least $least"
      fi
    done <tests/budgets/frames.csv
    # Every picture, whichever way it was drawn, is the golden one of this size and format.
    size=$(fact WIDTH_PX),$(fact HEIGHT_PX),$(fact FORMAT)
    sed -n "s/^[a-z_]*\.crc\.\([0-9]*\),\([0-9a-f]*\).*/$size,\1,\2/p" "$log" | sort -u >"$work/frames"
    grep "^$size," tests/golden/demo_frames.csv | sort >"$work/frames.golden" || true
    if [ -s "$work/frames" ] && cmp -s "$work/frames" "$work/frames.golden"; then
      said="${said}frames are the golden ones; "
    else
      fail bench "its frames are not those of tests/golden/demo_frames.csv (made by tests/boards/golden_frames.sh)"
    fi
    # BOARD_FRAME_INSTRUCTIONS, to a twentieth.
    cost=$(sed -n 's/^brick_map\.instructions_median,\([0-9]*\).*/\1/p' "$log")
    told=$(fact FRAME_INSTRUCTIONS)
    if [ "$((${cost:-0} * 20))" -lt "$((told * 19))" ] || [ "$((${cost:-0} * 20))" -gt "$((told * 21))" ]; then
      fail bench "BOARD_FRAME_INSTRUCTIONS is $told, measured: ${cost:-nothing}"
    fi
    # BOARD_VISITS_A_SECOND, by which a rate is held: what was measured, to a quarter.
    mhz=$(fact CORE_MHZ)
    if ! awk -F, -v mhz="${mhz:-$(fact CLOCK_MHZ)}" -v said="$(fact VISITS_A_SECOND)" '
      $1 == "tree.instructions_median" { cost = $2 }
      $1 == "tree.node_visits" { visits = $2 }
      END {
        if (said == 0 || visits == 0) exit 0
        right = mhz * 1000000 * visits / cost / 1.5
        if (said > right * 1.25 || said < right * 0.75) { printf "%d, measured: %d", said, right; exit 1 }
      }' "$log" >"$work/visits"; then
      fail bench "BOARD_VISITS_A_SECOND is $(cat "$work/visits")"
    fi
    # With light, the host's pictures.
    sed -n 's/^lit\.lit_crc\.[0-9]*,//p' "$log" | tr '[:lower:]' '[:upper:]' | tr -d '\r' >"$work/lit_crcs"
    if [ -n "$(fact DEMO_EFFECTS)" ]; then
      # The table has those of 128 x 64 in 16 greys; others are the simulator's.
      if [ "$(fact WIDTH_PX)$(fact FORMAT)" = 128gray4 ]; then
        sed -n '/kDemoLitFrameCrc32/,/};/s/0x\([0-9A-F]*\),/\1\n/gp' tests/golden/demo_table.h | tr -d ' ' | grep -x '[0-9A-F]\{8\}' >"$work/lit_golden"
      else
        build/release/thimble sim demo --effects "$(fact DEMO_EFFECTS)" --app bench --board "$board" --display none --quiet 2>/dev/null |
          sed -n 's/^lit\.lit_crc\.[0-9]*,//p' | tr '[:lower:]' '[:upper:]' >"$work/lit_golden"
      fi
      if cmp -s "$work/lit_crcs" "$work/lit_golden"; then
        said="${said}lit frames are the host's; "
        wrong=$(sh "$here/lit_budget.sh" "$board" demo "$log") || fail bench "$wrong"
      else
        fail bench "lit frames are $(tr '\n' ' ' <"$work/lit_crcs"), not the host's, $(tr '\n' ' ' <"$work/lit_golden")"
      fi
    fi
  elif [ "$app" = particles ]; then
    crc=$(sed -n 's/^steps 400 crc \([0-9a-f]*\)$/\1/p' "$log" | head -n 1)
    if [ -z "$crc" ] || ! grep -qi "0x$crc" tests/golden/particles_table.h; then
      fail particles "its state after 400 steps, ${crc:-none}, is not among the golden ones"
    fi
    said="state $crc after 400 steps; "
  elif [ "$app" = dig ]; then
    # What it does by itself: the simulator's picture, and an edit within a quarter of a frame.
    crc=$(sed -n 's/^last crc \([0-9a-f]*\).*/\1/p' "$log")
    edit=$(sed -n 's/^most instructions of an edit: \([0-9]*\).*/\1/p' "$log")
    build/release/thimble sim demo --effects none --app dig --board "$board" --display none --frames 4 --quiet >"$work/dig.sim" 2>&1 || true
    if [ -z "$crc" ] || ! grep -q "^last crc $crc" "$work/dig.sim"; then
      fail dig "its last picture, ${crc:-none}, is not the simulator's, $(grep '^last crc' "$work/dig.sim" || echo none)"
    fi
    most=$(($(fact FRAME_INSTRUCTIONS) / 4))
    [ "${edit:-99999999}" -le "$most" ] || fail dig "an edit takes ${edit:-unknown} instructions, at most $most"
    said="pictures are the simulator's; an edit takes at most $edit instructions; "
  fi
  sh "$here/budget.sh" "$board" "$app" "$log" >"$work/$app.budget" 2>&1 || failed=1
  grep FAILED "$work/$app.budget" | sed "s/^/$(printf '%-18s %-10s ' "$board" "$app")/" >>"$results" || true
  say "$app" "$said$(tail -n 1 "$work/$app.budget")"
done

# Each fault: told where the board can tell it, and nowhere a hang.
caught=
missed=
locked=
astray=$(fact GOES_ASTRAY)
for fault in stack ram flash nonsense scene; do
  # What then happens is nobody's word, so it is not tried.
  case " $astray " in *" $fault "*) continue ;; esac
  case $fault in stack) key=s ;; ram) key=r ;; flash) key=f ;; nonsense) key=n ;; scene) key=d ;; esac
  log=$work/fault_$fault.log
  emulate faults $key "$log"
  case " $(fact CATCHES) " in
    *" $fault "*)
      if [ "$status" = 97 ] && grep -q '^fault: ' "$log"; then
        caught="$caught $fault"
      else
        tail -n 5 "$log" >&2
        fail faults "$fault: exit status $status, wanted 97 and a message"
      fi
      ;;
    *)
      case " $(fact LOCKS_UP) " in
        *" $fault "*)
          locked="$locked $fault"
          [ "$status" = 98 ] || fail faults "$fault: exit status $status, wanted 98: the core locks up"
          continue
          ;;
      esac
      missed="$missed $fault"
      if [ "$status" != 1 ] || ! grep -q '^nobody noticed' "$log"; then
        fail faults "$fault is not among BOARD_CATCHES, and yet: exit status $status"
      fi
      ;;
  esac
done
say faults "caught:$caught$([ -n "$missed" ] && echo "; cannot be caught here:$missed")$([ -n "$locked" ] && echo "; the core locks up:$locked")$([ -n "$astray" ] && echo "; not tried: $astray")"

# A scene damaged in one byte, in the image: a sentence and status 1.
awk '/^ *[0-9]+,/ && ++line == 40 { sub(/[0-9]+/, ($1 + 1) % 256) } { print }' "$work/scene.h" >"$work/damaged.h"
if cmp -s "$work/scene.h" "$work/damaged.h"; then
  fail demo "the scene could not be damaged"
elif ! FRAMES=4 sh platform/build.sh "$board" demo "$work/damaged.h" >"$work/build.log" 2>&1; then
  fail demo "does not build with a damaged scene"
else
  emulate demo "" "$work/damaged.log"
  if [ "$status" = 1 ] && grep -q '^error: ' "$work/damaged.log"; then
    say demo "refuses a damaged scene"
  else
    fail demo "with a damaged scene: exit status $status, wanted 1 and a message"
  fi
fi

# What the display shows, and buttons.
if [ "$(fact DISPLAY)" != none ]; then
  sh "$here/display.sh" "$board" >"$work/display.results" 2>&1 || failed=1
  sed "s/^/$(printf '%-18s %-10s ' "$board" display)/" "$work/display.results" >>"$results"
fi

cat "$results"
exit $failed
