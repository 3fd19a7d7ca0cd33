#!/bin/sh
# What an effect takes of the flash, and that one which is left out takes nothing: effects.sh [--write]
#
# Links one image a set of effects for lm3s6965evb (tests/boards/effect_image.cpp), compares their sizes with
# platform/boards/effect_flash.h (--write writes that anew), looks for symbols that must not be there, and counts the
# instructions of a frame. Prints a line a question; exit status 1 when an answer is wrong.
set -eu
cd "$(dirname "$0")/../.."
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
board=lm3s6965evb
work=$THIMBLE_FIRMWARE/$board
header=platform/boards/effect_flash.h
failed=0
fail() {
  echo "FAILED: $*"
  failed=1
}
mkdir -p "$work"
# The applications, as they are, come along: a list of others would link those anew.
apps=$(sed -n 's/^THIMBLE_APP:[A-Z]*=//p' "$work/CMakeCache.txt" 2>/dev/null || true)
scene=demo
if ! FRAMES=${FRAMES:-4} sh platform/build.sh "$board" "${apps:-faults}" "$scene" >"$work/effects.log" 2>&1 ||
  ! cmake --build "$work" --target effect_images >>"$work/effects.log" 2>&1; then
  tail -n 20 "$work/effects.log"
  fail "the images do not build"
  exit 1
fi

# size_of IMAGE: bytes of flash.
size_of() {
  cut -d , -f 3 "$work/effects_$1.memory.csv"
}
# `0x001 kDirectLight` and so on.
names=$(sed -n 's/^  static constexpr EffectSet \(k[A-Za-z]*\) = 1U << \([0-9]*\);.*/\1 \2/p' include/thimble/light/scene.h |
  while read -r name bit; do printf '0x%03x %s\n' $((1 << bit)) "$name"; done)
{
  cat <<'TEXT'
/// What each effect takes of the flash of a firmware image, measured by linking: lm3s6965evb (Cortex-M3),
/// with the compiler flags of every image, code and constants. Written by
/// `sh tests/boards/effects.sh --write`, and held to the byte by `make test-boards`, with Debian 12's
/// gcc-arm-none-eabi 12.2.
///
/// An image that draws with `render_lit_band<SET>` takes, beyond the one that calls `render_band`,
///
///     kLitBaseFlashBytes + the bytes of each effect in SET
///
/// or less, since effects share parts: all of them take kAllEffectsFlashBytes. An effect that SET does not
/// name takes nothing; with Effect::kNone the image is the other one, byte for byte (the same test compares
/// them).
#pragma once

#include <stdint.h>

#include "thimble/light/scene.h"

namespace thimble {

TEXT
  base=$(size_of base)
  echo "/// The loop of a lit picture with no effect in it, its dither and what opens the lighting of a baked scene."
  echo "inline constexpr uint32_t kLitBaseFlashBytes = $((base - $(size_of plain)));"
  echo
  cat <<'TEXT'
struct EffectFlash {
  EffectSet effect;  ///< one
  /// The image with this effect alone less the one with the base alone. Effect::kShadows, which need
  /// Effect::kDirectLight: with both, less the one with Effect::kDirectLight. Effect::kEmitterLight: with
  /// these two, less the one with them; Effect::kRipples: with Effect::kWater, less the one with it.
  uint32_t bytes;
};
// clang-format off
inline constexpr EffectFlash kEffectFlash[] = {
TEXT
  echo "$names" | while read -r set name; do
    case $name in
      kShadows) echo "    {Effect::$name, $(($(size_of 0x003) - $(size_of 0x001)))}," ;;
      kRipples) echo "    {Effect::$name, $(($(size_of 0x4080) - $(size_of 0x080)))}," ;;
      kEmitterLight) echo "    {Effect::$name, $(($(size_of 0x1003) - $(size_of 0x003)))}," ;;
      *) echo "    {Effect::$name, $(($(size_of "$set") - base))}," ;;
    esac
  done
  cat <<'TEXT'
};
// clang-format on

/// All of them together, the base included: what the most general image takes beyond one without light.
TEXT
  echo "inline constexpr uint32_t kAllEffectsFlashBytes = $(($(size_of 0x7fff) - $(size_of plain)));"
  printf '\n}  // namespace thimble\n'
} >"$work/effect_flash.h"
if [ "${1:-}" = --write ]; then
  cp "$work/effect_flash.h" "$header"
  echo "wrote $header"
elif ! diff "$header" "$work/effect_flash.h" >"$work/effect_flash.diff" 2>&1; then
  fail "$header does not have the bytes that were measured with gcc $(arm-none-eabi-gcc -dumpversion); if that is meant, sh tests/boards/effects.sh --write:"
  cat "$work/effect_flash.diff"
else
  echo "effects: flash of each is what $header says; all $(sed -n 's/.*kAllEffectsFlashBytes = \([0-9]*\).*/\1/p' "$header") bytes"
fi

# Parts, and the effects that bring them: an image whose set has none of these must not have the part.
parts='0x001 ambient_light light_ray add_light
0x002 light_arrives
0x022 light_arrives_through
0x004 occlude
0x008 add_emission
0x010 send_mirrored
0x060 begin_leg meet_clear
0x0e0 go_straight
0x0a0 absorb cross
0x040 scatter
0x080 begin_in_water meet_water filter_by_water
0x100 fade_in_fog
0x200 sky_color
0x400 cue_depth
0x4000 cross_ripples sun_glint
0x2000 meets_edge is_same_gray darken_edge
0x800 slope_at light_on_slope surface_normal cross_slope'
for set in plain 0x000 base 0x001 0x002 0x004 0x008 0x010 0x020 0x040 0x080 0x100 0x200 0x400 0x003 0x0b3 0x7ff 0x800 0x1003 0x2000 0x4080 0x7fff; do
  arm-none-eabi-nm -C "$work/effects_$set.elf" >"$work/effects_$set.symbols"
  bits=$set
  case $set in plain | base) bits=0 ;; esac
  echo "$parts" | while read -r mask functions; do
    [ $((bits & mask)) = 0 ] || continue
    for function in $functions; do
      ! grep -q "thimble::lit::$function(" "$work/effects_$set.symbols" || echo "$function in the image for $set"
    done
  done
done >"$work/effects.unwanted"
[ ! -s "$work/effects.unwanted" ] || fail "parts of effects that the set does not name: $(cat "$work/effects.unwanted")"
for set in plain 0x000; do
  ! grep 'thimble::lit::\|Lit\|open_lighting\|WaterSurface' "$work/effects_$set.symbols" || fail "light in the image for $set"
done
! grep 'Water\|refract\|fresnel\|mirror\|lit::.*water\|lit::cross' "$work/effects_0x003.symbols" || fail "glass or water in the image for direct light and shadows"
# The names above are those of the source: each is somewhere.
cat "$work/effects_0x003.symbols" "$work/effects_0x040.symbols" "$work/effects_0x7ff.symbols" "$work/effects_0x7fff.symbols" >"$work/effects.all"
echo "$parts" | while read -r mask functions; do
  for function in $functions; do
    grep -q "thimble::lit::$function(" "$work/effects.all" || echo "$function"
  done
done >"$work/effects.unknown"
[ ! -s "$work/effects.unknown" ] || fail "not in any image, so this test looks for a wrong name: $(cat "$work/effects.unknown")"
[ $failed = 1 ] || echo "effects: no image holds a part of an effect that its set does not name"

# No effect, no time: the same bytes, and the same instructions for a frame.
cmp -s "$work/effects_plain.bin" "$work/effects_0x000.bin" || fail "with no effects the image differs from one that never heard of them"
for set in plain 0x000; do
  sh platform/emulate.sh "$board" "effects_$set" </dev/null 2>/dev/null | sed -n '/^instructions/p' >"$work/effects_$set.frame"
done
frame=$(cat "$work/effects_plain.frame")
[ -n "$frame" ] || fail "the plain image draws nothing"
[ "$frame" = "$(cat "$work/effects_0x000.frame")" ] || fail "a frame takes $(cat "$work/effects_0x000.frame") with no effects, $frame by render_band"
[ $failed = 1 ] || echo "effects: without any the image is that of render_band to the byte; a frame: $frame"
exit $failed
