#!/bin/sh
# What frames of every size take, in instructions: APP=bench for QEMU's MPS2 boards with other sizes, cores and scenes than
# a board has, Cortex-M0 code on the Cortex-M3, and RV32 on the SiFive's core, up to the pictures that its 16 KiB hold.
# Measuring targets: nothing here is a board of platform/boards.
#   bench_frames.sh [--write]     --write: the rows of tests/budgets/frame_sizes.csv that are measured are written anew; else what
#                                 grew beyond them fails, and rows that were measured on another scene (`scene_crc32`)
# In the environment: TARGETS, SIZES, SCENES choose some of those below; THIMBLE is another build/release/thimble.
# A picture is compared with that of the tree's rays on the first target that draws it, then by its CRCs; one with light with
# the simulator's.
set -eu
cd "$(dirname "$0")/../.."
table=tests/budgets/frame_sizes.csv
work=build/bench-frames
thimble=${THIMBLE:-build/release/thimble}
mkdir -p "$work"
. tests/boards/three_digits.sh
# core:machine
targets=${TARGETS:-cortex-m3:mps2-an385 cortex-m0:mps2-an385 cortex-m4:mps2-an386 cortex-m7:mps2-an500 rv32imac:sifive_e
  arm1176jz-s:raspi0}
# width:height:format
sizes=${SIZES:-128:64:gray4 160:128:rgb565 240:240:rgb565 320:240:rgb565 640:480:rgb565}
# name=what `thimble bake` takes: the demonstration's valley, many small faces, open sky; +effects: with light, in two sizes;
# deep...: worlds of level 9 and 10, on the Raspberry Pi alone, whose memory holds them
scenes=${SCENES:-valley=demo dust=cluster:6000,depth=6 castle=castle sun=demo+direct-light,shadows deep9=demo,depth=9
  deep10=demo,depth=10}
export CCACHE_DISABLE=1
for scene in $scenes; do
  what=${scene#*=}
  effects=none
  case $what in *+*) effects=${what#*+} ;; esac
  limit='--board mps2-an500'
  case $scene in deep*) limit='--brick-map --size 320x240' ;; esac
  "$thimble" bake "${what%%+*}" $limit --effects "$effects" -o "$work/${scene%%=*}.h" --quiet
done
: >"$work/measured.csv"
failed=0
for target in $targets; do
  core=${target%%:*}
  # The rays of the tree are drawn once for each picture.
  alone=ON
  [ "$target" = "${targets%% *}" ] && alone=OFF
  board=mps2-an500
  arch=cortex-m
  qemu="qemu-system-arm -M ${target#*:} -icount shift=6"
  facts=
  case $core in
    rv32*)
      board=sifive_e
      arch=riscv
      qemu="qemu-system-riscv32 -M ${target#*:} -icount shift=0"
      facts=';FRAMES=large;STACK_BYTES=8192'
      ;;
    arm1176*)
      board=raspi0
      arch=arm11
      qemu="qemu-system-arm -M ${target#*:} -icount shift=10"
      facts=';FLASH_BYTES=8355840'  # up to its RAM
      ;;
  esac
  for size in $sizes; do
    width=${size%%:*}
    format=${size##*:}
    height=${size#*:}
    height=${height%:*}
    [ "$core:$width" != rv32imac:640 ] || continue
    for scene in $scenes; do
      name=${scene%%=*}
      engine=brick_map
      what=$alone
      case $core:$width:$name in
        arm1176*:320:deep* | arm1176*:640:deep*) what=OFF ;;
        arm1176* | *:deep*) continue ;;
      esac
      case $scene in
        *+*)
          engine=lit
          what=ON
          case $core:$width$height in
            rv32*) continue ;;
            *:240240) shown=pico ;;
            *:320240) shown=mps2-an500 ;;
            *) continue ;;
          esac
          # The simulator's pictures.
          lit=${scene#*=}
          "$thimble" sim "${lit%%+*}" --effects "${lit#*+}" --board $shown --app bench --display none --quiet |
            grep '^lit\.lit_crc' >"$work/$width-$name.crc"
          ;;
      esac
      cmake -S . -B "$work/$core" -G Ninja -DCMAKE_TOOLCHAIN_FILE=platform/arch/$arch/toolchain.cmake \
        -DTHIMBLE_BOARD=$board -DTHIMBLE_APP=bench -DTHIMBLE_SCENE_HEADER="$PWD/$work/$name.h" -DTHIMBLE_MEASURED=$what \
        "-DTHIMBLE_FACTS=CPU=$core;WIDTH_PX=$width;HEIGHT_PX=$height;FORMAT=$format$facts" \
        --log-level=WARNING -Wno-dev --no-warn-unused-cli >/dev/null
      cmake --build "$work/$core" -- --quiet >/dev/null
      log=$work/$core-$width-$name.log
      if ! $qemu -display none -monitor none -serial stdio \
        -semihosting-config enable=on,target=native -kernel "$work/$core/bench.emulated.elf" >"$log" </dev/null; then
        echo "bench-frames: $core $width x $height $name failed; see $log" >&2
        failed=1
        continue
      fi
      crcs=$work/$width-$name.crc
      grep -E "^$engine\\.(lit_)?crc" "$log" >"$work/crc.now"
      [ "$what" = ON ] || cp "$work/crc.now" "$crcs"
      if ! grep -q '^exact,yes' "$log" || { [ -f "$crcs" ] && ! cmp -s "$crcs" "$work/crc.now"; }; then
        echo "bench-frames: $core $width x $height $name draws other pixels than the tree's rays; see $log" >&2
        failed=1
      fi
      baked=$(sed -n 's/^#define THIMBLE_SCENE_CRC32 0x\([0-9a-f]*\)u.*/\1/p' "$work/$name.h")
      awk -F, -v OFS=, -v row="$core,$name,$width,$height,$format" -v engine="$engine" -v baked="$baked" "$three_digits"'
        { value[$1] = $2 }
        END { print row, three_digits(value[engine ".instructions_median"]), three_digits(value[engine ".instructions_a_ray"]),
          value["stack_high_water_bytes"], baked }' "$log" | tee -a "$work/measured.csv"
    done
  done
done
if [ "${1:-}" = --write ]; then
  {
    grep '^#' "$table"
    echo core,scene,width,height,format,instructions_median,instructions_a_pixel,stack_bytes,scene_crc32
    awk -F, 'NR == FNR { new[$1,$2,$3,$4] = $0; next } /^#/ || /^core,/ { next }
      ($1,$2,$3,$4) in new { print new[$1,$2,$3,$4]; delete new[$1,$2,$3,$4]; next } { print }
      END { for (row in new) print new[row] }' "$work/measured.csv" "$table"
  } >"$work/frame_sizes.csv"
  mv "$work/frame_sizes.csv" "$table"
  echo "bench-frames: wrote $table"
else
  # One per cent, so that rounding and other versions of the compiler pass.
  awk -F, '/^#/ || /^core,/ { next } NR == FNR { old[$1,$2,$3,$4] = $6; scene[$1,$2,$3,$4] = $9; next }
    old[$1,$2,$3,$4] == "" { next }
    { row = "bench-frames: " $1 " " $2 " " $3 " x " $4 }
    scene[$1,$2,$3,$4] != "" && scene[$1,$2,$3,$4] != $9 { print row " is another scene than that of the table; bench_frames.sh --write"; bad = 1; next }
    $6 > 1.01 * old[$1,$2,$3,$4] { print row " takes " $6 " instructions, the table says " old[$1,$2,$3,$4]; bad = 1 }
    END { exit bad }' "$table" "$work/measured.csv" || failed=1
fi
exit $failed
