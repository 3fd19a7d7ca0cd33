#!/bin/sh
# Writes an image to a real board, the way its board.cmake says (BOARD_PROBE). flash.sh BOARD APP [SCENE]
# In the environment: IMAGE=yes makes it first, of a program that is built already and SCENE, baked with EFFECTS and BAKE as in
# build.sh (images/README.md); PLACE=ram writes the image for RAM where the board has one (BOARD_UF2); THIMBLE_DRIVE is where the board's
# drive is mounted, THIMBLE_DRIVE_S how long its answer is waited for (20 s).
set -eu
cd "$(dirname "$0")/.."
board=$1
app=$2
. platform/board_facts.sh
image=${THIMBLE_FIRMWARE:-build/firmware}/$board/$app
[ "${PLACE:-}" != ram ] || image=${image}_ram
probe=$(fact PROBE)
with=${probe#* }
fail() {
  echo "thimble: cannot flash $board: $1" >&2
  exit 1
}
need() {
  command -v "$1" >/dev/null 2>&1 || fail "$1 is not installed (Debian: apt-get install $2)"
}
case $probe in
  "openocd "*) ending=elf ;;
  *.hex) ending=hex ;;
  *.elf) ending=elf ;;
  *.uf2) ending=uf2 ;;
  *) ending=bin ;;
esac
if [ -n "${IMAGE:-}" ]; then
  scene=${3:-auto}
  apps=$app
  choose_scene
  mkdir -p "${image%/*}"
  # Words, as BAKE has them.
  # shellcheck disable=SC2086
  build/release/thimble image "$scene" --board "$board" --app "$app" ${effects:+--effects "$effects"} ${BAKE:-} -o "$image.$ending"
fi
[ -f "$image.$ending" ] || fail "$image.$ending is not there; make firmware BOARD=$board APP=$app builds it"
case $probe in
  "openocd "*)
    need openocd openocd
    log=$(mktemp)
    trap 'rm -f "$log"' EXIT
    if ! openocd -f "$with" -c "program $image.elf verify reset exit" >"$log" 2>&1; then
      sed 's/^/  openocd: /' "$log" | grep -i error >&2 || sed 's/^/  openocd: /' "$log" >&2
      fail "openocd found no probe, or no board behind it; is its USB cable in?"
    fi
    ;;
  "st-flash "*)
    need st-flash stlink-tools
    log=$(mktemp)
    trap 'rm -f "$log"' EXIT
    if ! st-flash --reset write "$image.bin" "$with" >"$log" 2>&1; then
      sed 's/^/  st-flash: /' "$log" >&2
      fail "st-flash found no ST-LINK, or no board behind it; is its USB cable in?"
    fi
    ;;
  "copy "*)
    drive=
    file=${with#* }
    with=${with%% *}
    # As desktops mount a drive by its label; THIMBLE_DRIVE names another place.
    for place in ${THIMBLE_DRIVE:+"$THIMBLE_DRIVE"} "/media/${USER:-root}/$with" "/run/media/${USER:-root}/$with" "/media/$with" \
      "/mnt/$with" "/Volumes/$with"; do
      if [ -d "$place" ]; then
        drive=$place
        break
      fi
    done
    how="connect the board"
    case $file in *.uf2) how="hold BOOTSEL while you connect the board, or copy $image.uf2 onto it by hand" ;; esac
    [ -n "$drive" ] || fail "no drive $with is mounted; $how, or say where it is: THIMBLE_DRIVE=/path"
    from=$image.$ending
    # What was there before under a name that is not ours, a system's kernel.img, is kept: the first one.
    case $file in
      */thimble.* | thimble.*) ;;
      *)
        if [ -f "$drive/$file" ] && [ ! -e "$drive/$file.bak" ] && ! cmp -s "$from" "$drive/$file"; then
          cp "$drive/$file" "$drive/$file.bak" && cmp -s "$drive/$file" "$drive/$file.bak" ||
            fail "cannot keep $drive/$file as $file.bak"
          echo "$board: $file that was on the drive is $file.bak now"
        fi
        ;;
    esac
    # DAPLink (a drive with DETAILS.TXT) programs the chip, then comes back without the file; FAIL.TXT on it says why not.
    # One that is there already tells of an earlier time.
    old=$(cat "$drive/FAIL.TXT" 2>/dev/null || true)
    is_daplink=no
    [ ! -f "$drive/DETAILS.TXT" ] || is_daplink=yes
    taken=yes
    cp "$from" "$drive/$file" || taken=no
    sync
    if [ $is_daplink = yes ]; then
      waited=0
      while [ $waited -lt $((${THIMBLE_DRIVE_S:-20} * 5)) ] && { [ -e "$drive/$file" ] || [ ! -f "$drive/DETAILS.TXT" ]; }; do
        sleep 0.2
        waited=$((waited + 1))
      done
      [ -e "$drive/$file" ] || old=
    fi
    why=$(cat "$drive/FAIL.TXT" 2>/dev/null || true)
    if [ -n "$why" ] && { [ "$why" != "$old" ] || [ $taken = no ]; }; then
      fail "its drive says in FAIL.TXT: $(printf %s "$why" | tr -d '\r' | tr '\n' ' ')"
    fi
    [ $taken = yes ] || fail "the drive does not take it"
    ;;
  *) fail "its board.cmake has no BOARD_PROBE that this script knows: $probe" ;;
esac
echo "$board: $app is on the board"
