#!/bin/sh
# Who may include whom. layering.sh ROOT
#   include, src     <stdint.h>, <stddef.h>, and headers of their own room or of a room below it; a public header
#                    none of src; only src and public headers those of a folder `detail`, and only they, platform/wide, gpu,
#                    tools/instruments (which measure it) and tests those of a folder `host`, which no caller needs
#   drivers          of panels: rooms up to the picture, and thimble_c.h for their face for C; no room sees them
#   src/c            all rooms but drivers, and thimble/thimble_c.h, which only they see
#   tools, platform  no header of src
#   tools            files and pictures (output, readers), then scene and particles, then viewer, web and instruments, then
#                    commands, library and python: a folder sees itself and those before it; library/examples what is
#                    installed
#   platform         nothing of the tests
#   tests/portable   what a board has: <stdint.h>, <stddef.h>, "thimble/..." and themselves; so do the golden scenes
#   tests/reference  nothing of the product: neither the core's nor the tools' headers
set -eu
cd "$1"
failed=0
# complain SENTENCE LINES: reports LINES unless there are none.
complain() {
  if [ -n "$2" ]; then
    echo "$2"
    echo "layering: $1" >&2
    failed=1
  fi
}
includes() {
  for folder in "$@"; do
    if [ -d "$folder" ]; then
      find "$folder" \( -name '*.h' -o -name '*.cpp' \) -exec grep -HnE '^[[:space:]]*#[[:space:]]*(include|import)' {} + || true
    fi
  done
}
# What a room may see besides itself. Each is named before those that stand above it.
rooms_below() {
  case $1 in
    base) echo ;;
    tree) echo base ;;
    trace) echo base tree ;;
    picture) echo base tree trace ;;
    light) echo base tree trace picture ;;
    plane) echo base ;;
    extras) echo base tree ;;
    bake | drivers) echo base tree trace picture ;;
    c) echo base tree trace picture light plane bake ;;
    *) echo "layering: src/$1 is no room that tests/checks/layering.sh knows" >&2 && return 1 ;;
  esac
}
# resolve ROOT FILE:LINE:#include "PATH" ...: each include in quotes as FILE:LINE: FILE'S ROOM, PLACE MEANT (as
# include/... or src/...).
resolve() {
  awk -v root="$1" '{
    split($0, part, ":"); file = part[1]
    if (!match($0, /"[^"]*"/)) next
    path = substr($0, RSTART + 1, RLENGTH - 2)
    room = substr(file, length(root) + 2); sub(/\/.*/, "", room)
    folder = file; sub(/[^\/]*$/, "", folder)
    if (path ~ /^thimble\//) place = "include/" path
    else {
      place = folder path
      while (match(place, /[^\/.]+\/\.\.\//)) place = substr(place, 1, RSTART - 1) substr(place, RSTART + RLENGTH)
    }
    print file ":" part[2] ": " room " " place
  }'
}
complain "the core includes more than <stdint.h>, <stddef.h> and headers in quotes" \
  "$(includes include src | grep -vE '#[[:space:]]*include[[:space:]]*(<stdint\.h>|<stddef\.h>|"[a-z0-9_./]+\.h")' || true)"
for root in include/thimble src; do
  for folder in "$root"/*/; do
    [ -d "$folder" ] || continue
    room=$(basename "$folder")
    below=$(rooms_below "$room") || failed=1
    allowed="$room"
    for other in $below; do
      allowed="$allowed|$other"
    done
    places="include/thimble/($allowed)/"
    [ "$root" = src ] && places="$places|src/($allowed)/"
    case $folder in src/c/ | */drivers/) places="$places|include/thimble/thimble_" ;; esac
    complain "$folder sees only itself and the rooms below it ($below)" \
      "$(includes "$folder" | resolve "$root" | grep -vE ": $room ($places)[a-z0-9_/]+\.h\$" || true)"
  done
  complain "the files of $root stand in rooms (besides thimble.h and thimble_c.h of include/thimble)" \
    "$(find "$root" -maxdepth 1 \( -name '*.h' -o -name '*.cpp' \) ! -path include/thimble/thimble.h \
      ! -path include/thimble/thimble_c.h)"
done
complain "thimble_c.h is read by C: it includes <stdint.h> and <stddef.h> alone" \
  "$(includes include/thimble | grep '^include/thimble/thimble_c\.h:.*"' || true)"
complain "a public header finds the others from where it stands, so that the folder can be moved" \
  "$(includes include | grep '"thimble/' || true)"
complain "what lies in a folder detail is the core's own" \
  "$(includes tools platform tests | grep -E '"thimble/[a-z0-9_/]*detail/' || true)"
complain "what lies in a folder host is for the host's own renderers, platform/wide and gpu, not for callers" \
  "$(includes tools platform | grep -E '"thimble/[a-z0-9_/]*host/' | grep -vE '^(platform/(wide|gpu)|tools/instruments)/' || true)"
installed=$(sed -n 's/^ *foreach(header \(.*\))$/\1/p' platform/wide/CMakeLists.txt 2>/dev/null | tr ' ' '|')
complain "of platform/wide the command sees what is installed for others" \
  "$(includes tools | grep -E '"wide/' | grep -vE "\"wide/($installed)\.h\"" || true)"
complain "a public header for callers includes none of a folder host" \
  "$(includes include | grep -v '^include/thimble/[a-z]*/host/' | grep -E '"[a-z0-9_./]*host/' || true)"
for room in output readers scene particles instruments viewer web; do
  case $room in
    output | readers) below="output|readers" ;;
    scene | particles) below="output|readers" ;;
    instruments) below="output|readers|scene|particles" ;;
    *) below="output|readers|scene" ;;
  esac
  complain "tools/$room sees only itself and, of the other folders of tools, $below" \
    "$(includes "tools/$room" | grep -E '"(output|readers|scene|particles|instruments|viewer|web|commands)/' |
      grep -vE "\"($room|$below)/" || true)"
done
complain "the libraries stand above the command, which sees neither" \
  "$(includes tools platform | grep -vE '^tools/(library|python)/' | grep -E '"thimble/files(_c)?\.h"' || true)"
complain "programs that know the installed package see nothing else" \
  "$(includes tools/library/examples | grep '"' | grep -vE '"(thimble|wide)/' || true)"
complain "tools and platform see public headers only, never src" \
  "$(includes tools platform | grep -E '["/]src/' || true)"
complain "platform sees no test; the applications that do stand in tests/boards/apps" \
  "$(includes platform | grep -E '["/](golden|portable|support|reference|tests)/' || true)"
board='#[[:space:]]*include[[:space:]]*(<stdint\.h>|<stddef\.h>|"(thimble|portable|golden)/[a-z0-9_/]+\.(h|inc)")'
complain "the cases that run on boards include more than <stdint.h>, <stddef.h>, \"thimble/...\" and one another" \
  "$(includes tests/portable tests/golden | grep -v '^tests/golden/main\.cpp:' | grep -vE "$board" || true)"
complain "the reference shares no code with the product" \
  "$(includes tests/reference | grep -E '["</](thimble|src|tools|readers|scene|platform)/' || true)"
exit $failed
