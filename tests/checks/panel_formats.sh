#!/bin/sh
# A pixel format that an image leaves out (THIMBLE_PANEL_FORMATS) takes none of its flash: each source that asks
# is_format, compiled for a Cortex-M0 without formats of panels, is smaller than with all of them, small ones than with
# any one; and where nothing else is in it, nothing is left.     panel_formats.sh ROOT WORK_DIR
set -eu
root=$1
mkdir -p "$2"
work=$(cd "$2" && pwd)
cd "$root"
command -v arm-none-eabi-g++ >/dev/null 2>&1 || {
  echo "skipped: arm-none-eabi-g++ is not installed"
  exit 77
}
flags='-std=c++17 -Os -mcpu=cortex-m0 -mthumb -ffreestanding -nostdinc++ -fno-exceptions -fno-rtti -ffunction-sections -fdata-sections -Iinclude -Isrc'
failed=0
complain() {
  echo "panel_formats: $1" >&2
  failed=1
}
# Bytes of code and constants of SOURCE with the formats of MASK.
bytes() {
  arm-none-eabi-g++ $flags -DTHIMBLE_PANEL_FORMATS="${2}U" -c "$1" -o "$work/one.o"
  arm-none-eabi-size "$work/one.o" | awk 'NR == 2 { print $1 + $2 }'
}
sources=$(grep -l 'is_format<' -r src --include='*.cpp' | sort)
[ -n "$sources" ] || complain "no source of src asks is_format"
for source in $sources; do
  none=$(bytes "$source" 0)
  case $source in
    # Nothing else is in it: what is left is a return.
    */panel_*.cpp) [ "$none" -le 4 ] || complain "$source takes $none bytes in an image without formats of panels" ;;
  esac
  most=$(bytes "$source" 0x3fe0)
  [ "$none" -lt "$most" ] || complain "$source takes $none bytes without formats of panels, $most with all of them"
  echo "$source: $none bytes without formats of panels, $most with all"
  [ "$none" -lt 1024 ] || continue
  for mask in 0x20 0x40 0x80 0x100 0x200 0x400 0x800 0x1000 0x2000; do
    one=$(bytes "$source" $mask)
    [ "$none" -lt "$one" ] || complain "$source takes $none bytes without formats of panels, $one with that of bit $mask"
    [ "$one" -lt "$most" ] || complain "$source takes $one bytes with the format of bit $mask, $most with all of them"
  done
done
exit $failed
