#!/bin/sh
# Builds firmware for a board into build/firmware/BOARD and says what each image takes of it.
#   build.sh BOARD|all APP[;APP...] [SCENE]     SCENE: what `thimble bake` takes, or a header (.h) that it made;
#                                               "auto" is the demonstration's for the board; without it there is none
# all: each board that can be built, then a table; exit status 1 where one cannot.
# In the environment: BAKE="OPTION..." has more options of `thimble bake`, such as BAKE="--depth 6 --coarsen";
# EFFECTS=LIST bakes the scene for these effects (bake --effects; without it for those that it calls for, and
# SCENE=demo for the board's BOARD_DEMO_EFFECTS); FRAMES=N ends the application after N frames; HOLD=true waits for a `q` then;
# PANEL_FORMATS=MASK has other formats of panels than the board's (picture/pixel.h); HOLD_FPS=N holds a rate of frames;
# WITHIN=SET has the scene behind the program, with effects within SET (images/README.md);
# CASE_STEP=N runs every Nth test case, MEASURED=ON has bench measure the fastest engine alone; THIMBLE_FIRMWARE is another
# place than build/firmware.
set -eu
cd "$(dirname "$0")/.."
if [ "$1" = all ]; then
  work=${THIMBLE_FIRMWARE:-build/firmware}
  mkdir -p "$work"
  status=0
  printf 'board\timage\tflash\tof\tdata, bss, stack\tof\n' >"$work/all.table"
  for board in $(cd platform/boards && echo */board.cmake | sed 's,/board\.cmake,,g'); do
    . platform/board_facts.sh
    if sh platform/build.sh "$board" "$2" "${3:-}" 2>"$work/all.said"; then
      cat "$work/all.said" >&2
      for app in $(echo "$2" | tr ';' ' '); do
        IFS=, read -r _ _ flash ram stack _ <"$work/$board/$app.memory.csv"
        printf '%s\t%s\t%s\t%s\t%s\t%s\n' "$board" "$app" "$flash" "$(fact FLASH_BYTES)" $((ram + stack)) \
          "$(fact RAM_BYTES)" >>"$work/all.table"
      done
    else
      cat "$work/all.said" >&2
      status=1
      printf '%s\tnot built: %s\n' "$board" "$(grep '^thimble: \|^build: ' "$work/all.said" | head -n 1 | cut -c 1-160)" >>"$work/all.table"
    fi
  done
  echo
  awk -F '\t' '$2 ~ /^not built/ { printf "%-18s %s\n", $1, $2; next } { printf "%-18s %-10s %10s %10s %17s %9s\n", $1, $2, $3, $4, $5, $6 }' "$work/all.table"
  exit $status
fi
board=$1
apps=$2
scene=${3:-}
. platform/board_facts.sh
work=${THIMBLE_FIRMWARE:-build/firmware}/$board
mkdir -p "$work"
choose_scene
case $scene in
  *.h) [ -z "${BAKE:-}" ] || { echo "build: BAKE=\"$BAKE\" is for a scene that is baked, and $scene is" >&2 && exit 2; } ;;
esac
case $scene in
  "") header= ;;
  /*.h) header=$scene ;;
  *.h) header=$PWD/$scene ;;
  *)
    header=$PWD/$work/scene.h
    # Words, as BAKE has them. What was left out to make it fit is said.
    # shellcheck disable=SC2086
    build/release/thimble bake "$scene" --board "$board" ${effects:+--effects "$effects"} ${BAKE:-} -o "$header" 2>"$work/bake.log" || {
      cat "$work/bake.log" >&2
      exit 1
    }
    grep '^without \|^coarsened ' "$work/bake.log" || true
    ;;
esac
# A compiler cache would hand out objects without their call graphs.
export CCACHE_DISABLE=1
cmake -S . -B "$work" -G Ninja -DCMAKE_TOOLCHAIN_FILE="platform/arch/$(fact ARCH)/toolchain.cmake" -DTHIMBLE_BOARD="$board" \
  -DTHIMBLE_APP="$apps" -DTHIMBLE_SCENE_HEADER="$header" -DTHIMBLE_SCENE_IN_FLASH="${WITHIN:-}" -DTHIMBLE_FRAMES="${FRAMES:-0}" \
  -DTHIMBLE_HOLD="${HOLD:-false}" -DTHIMBLE_HOLD_FPS="${HOLD_FPS:-0}" -DTHIMBLE_PANEL_FORMATS="${PANEL_FORMATS:-}" \
  -DTHIMBLE_CASE_STEP="${CASE_STEP:-1}" -DTHIMBLE_MEASURED="${MEASURED:-OFF}" --log-level=WARNING -Wno-dev \
  --no-warn-unused-cli >/dev/null
# What does not fit the flash: the linker counts the bytes, of which the scene is what can be less.
if ! cmake --build "$work" -- --quiet >"$work/cmake.log" 2>&1; then
  over=$(sed -n 's/.*region .FLASH. overflowed by \([0-9]*\) bytes.*/\1/p' "$work/cmake.log" | sort -n | tail -n 1)
  bytes=
  [ -z "$header" ] || bytes=$(sed -n 's/^#define THIMBLE_SCENE_BYTES \([0-9]*\)u.*/\1/p' "$header")
  if [ -n "$over" ] && [ "${bytes:-0}" -gt "$over" ]; then
    fits=$(((bytes - over) / 8 * 8))
    echo "build: $board $apps: image $over bytes larger than the flash, with $bytes bytes of scene." >&2
    echo "The scene may take $fits: its brick map is left out first, then its light, then voxels merge; as options of bake" >&2
    echo "  make firmware BOARD=$board SCENE=... BAKE=\"--memory $fits --coarsen\"" >&2
  else
    cat "$work/cmake.log" >&2
  fi
  exit 1
fi
cat "$work/cmake.log"
# A drive takes images for RAM, too (APP_ram.uf2), where they leave an arena. PLACE=flash: not wanted.
if [ -n "$(fact UF2)" ] && [ "${PLACE:-}" != flash ]; then
  targets=
  for app in $(echo "$apps" | tr ';' ' '); do
    IFS=, read -r _ _ flash ram stack _ <"$work/$app.memory.csv"
    if [ $((flash + ram + stack + 32768)) -le "$(fact RAM_BYTES)" ]; then
      targets="$targets ${app}_ram"
    else
      echo "$board $app: too large for an image in RAM"
    fi
  done
  [ -z "$targets" ] || ninja -C "$work" --quiet $targets
fi
