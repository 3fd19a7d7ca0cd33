#!/bin/sh
# What no run under an emulator shows of an image that is flashed: how it ends without a debugger, its vectors, and what a
# loader of its ELF file writes.      silicon.sh BOARD, after board.sh has built it
set -eu
cd "$(dirname "$0")/../.."
board=$1
. platform/board_facts.sh
export THIMBLE_FIRMWARE="${THIMBLE_FIRMWARE:-build/boards}"
work=$THIMBLE_FIRMWARE/$board
case $(fact ARCH) in riscv) prefix=riscv64-unknown-elf- ;; *) prefix=arm-none-eabi- ;; esac
app=silicon
. tests/boards/say.sh
FRAMES=1 PLACE=flash builds "particles;faults" ""
if [ -n "$(fact EMULATOR)" ] && ! why=$(sh "platform/emulators/$(fact EMULATOR)/fetch.sh"); then
  say "skipped: $why"
  exit 0
fi

# runs APP KEY TEXT: the image that is flashed, as without a debugger, until it has said TEXT and a second longer. The log is
# $work/silicon.log.
runs() {
  # The log goes, too: the machine empties it only after it is there, so what the last one said would be found.
  rm -f "$work/silicon.keys" "$work/silicon.log"
  mkfifo "$work/silicon.keys"
  FLASHED=yes sh platform/emulate.sh "$board" "$1" <"$work/silicon.keys" >"$work/silicon.log" 2>"$work/silicon.noise" &
  machine=$!
  exec 3>"$work/silicon.keys"
  tries=0
  until grep -aqs "$3" "$work/silicon.log" || [ $tries -ge 600 ]; do
    [ -z "$2" ] || printf '%s' "$2" >&3 2>/dev/null || true
    sleep 0.1
    tries=$((tries + 1))
  done
  sleep 1
  kill -0 $machine 2>/dev/null || fail "$1 did not stand still at its end: $(tail -n 1 "$work/silicon.noise")"
  kill $machine 2>/dev/null || true
  wait $machine 2>/dev/null || true
  exec 3>&-
  grep -aqs "$3" "$work/silicon.log" || fail "$1 does not say '$3'"
}
runs particles "" '^stack: '
! grep -aq '^fault: ' "$work/silicon.log" || fail "particles ends with a fault: $(grep -a '^fault: ' "$work/silicon.log" | head -n 1)"
# d: the scene that is not there. A fault is printed once.
for fault in ram scene; do
  case " $(fact CATCHES) " in *" $fault "*) ;; *) continue ;; esac
  case $fault in ram) key=r ;; scene) key=d ;; esac
  runs faults $key '^fault: '
  told=$(grep -ac '^fault: ' "$work/silicon.log" || true)
  [ "$told" = 1 ] || fail "$fault: $told faults are printed"
done

# The image for emulators is that one but for a word.
"${prefix}objcopy" -O binary "$work/particles.emulated.elf" "$work/silicon.bin"
differ=$(cmp -l "$work/particles.bin" "$work/silicon.bin" | wc -l)
{ [ "$differ" -ge 1 ] && [ "$differ" -le 4 ]; } || fail "the image for emulators differs in $differ bytes"

# Reserved vectors are 0: on Armv6-M the words 4 to 10, 12 and 13, on Armv7-M 7 to 10 and 13.
if [ "$(fact ARCH)" = cortex-m ]; then
  case $(fact CPU) in cortex-m0*) reserved='4 5 6 7 8 9 10 12 13' ;; *) reserved='7 8 9 10 13' ;; esac
  at=$("${prefix}nm" "$work/particles.elf" | awk '$3 == "thimble_image_vectors" { print $1 }')
  offset=$((0x$at - $(fact FLASH_ORIGIN)))
  words=$(od -An -v -tx4 -w4 -j "$offset" -N 64 "$work/particles.bin" | awk '{ print NR - 1 ":" $1 }')
  for word in $words; do
    case " $reserved " in
      *" ${word%:*} "*) [ "${word#*:}" = 00000000 ] || fail "reserved vector ${word%:*} is ${word#*:}" ;;
      *) [ "${word#*:}" != 00000000 ] || [ "${word%:*}" = 15 ] || fail "vector ${word%:*} is 0" ;;
    esac
  done
fi

# A loader of the ELF file writes to flash alone, and none of the file's headers.
"${prefix}readelf" -lW "$work/particles.elf" | awk -v from="$(fact FLASH_ORIGIN)" -v bytes="$(fact FLASH_BYTES)" '
  function number(text,  value, i) {
    value = 0
    text = tolower(substr(text, 3))
    for (i = 1; i <= length(text); i++) value = value * 16 + index("0123456789abcdef", substr(text, i, 1)) - 1
    return value
  }
  $1 == "LOAD" && number($5) > 0 {
    if (number($2) == 0) print "a segment begins with the headers of the file"
    if (number($4) < number(from) || number($4) + number($5) > number(from) + bytes) print "a segment is loaded to " $4
  }' >"$work/silicon.segments"
[ ! -s "$work/silicon.segments" ] || fail "$(head -n 1 "$work/silicon.segments")"

# The OLED: what its panel wants of the controller comes before it is on, once, and bits are no faster than the display
# takes them; the PLL has its voltage. QEMU's registers say what was written.
if [ "$board" = lm3s6965evb ]; then
  {
    sleep 3
    printf 'xp /1xw 0x40008010\nxp /1xw 0x400fe034\nquit\n'
    sleep 1
  } | timeout 30 $(fact QEMU) -display none -serial null -monitor stdio -kernel "$work/faults.elf" >"$work/silicon.registers" 2>&1 || true
  divider=$(sed -n 's/^0*40008010: *0x0*\([0-9a-f]*\).*/\1/p' "$work/silicon.registers")
  ns=$((0x${divider:-0} * 1000 / $(fact CLOCK_MHZ)))
  [ $ns -ge 250 ] || fail "a bit for the display takes $ns ns, 250 at least (SSD0323 data sheet)"
  grep -q '^0*400fe034: *0x0*1b' "$work/silicon.registers" || fail "revision A2 has no 2.75 V: $(grep 400fe034 "$work/silicon.registers" | tail -n 1)"
  sequence=$("${prefix}objdump" -t "$work/particles.elf" | awk '/kStartSequence/ { print $1, $(NF - 1) }')
  at=$((0x${sequence% *} - $(fact FLASH_ORIGIN)))
  od -An -v -tu1 -w1 -j "$at" -N $((0x${sequence#* })) "$work/particles.bin" | awk '
    BEGIN {
      # Bytes that follow each command (SSD0323 data sheet, command table), in decimal.
      split("21:2 117:2 129:1 132:0 133:0 134:0 160:1 161:1 162:1 164:0 165:0 166:0 167:0 168:1 173:1 174:0 175:0 176:1 177:1 178:1 179:1 184:8 187:1 188:1 190:1 191:1 227:0", table, " ")
      for (i in table) { split(table[i], pair, ":"); takes[pair[1]] = pair[2] }
    }
    left > 0 { if (left == takes[code]) value[code] = $1; left--; next }
    !($1 in takes) { print "the display has no command " $1; next }
    { if ($1 in seen) print "command " $1 " comes twice"; code = $1; seen[code] = 1; left = takes[code] }
    END {
      if (left > 0) print "a command lacks bytes"
      split("160 162 168 173 177 178 179 184 188 190 191", wanted, " ")
      for (i in wanted) if (!(wanted[i] in seen)) print "command " wanted[i] " is not sent"
      if (value[162] != 76 || value[160] != 82 || value[173] != 3) print "offset, wiring or converter are not the panel'\''s"
    }' >"$work/silicon.oled"
  [ ! -s "$work/silicon.oled" ] || fail "$(head -n 1 "$work/silicon.oled")"
fi
ends "without a debugger it ends without a fault and tells one once; vectors and segments are a chip's"
