#!/bin/sh
# The README's commands, as written: each line of an indented or ```sh block that begins with make, thimble or build/
# runs in a copy of the tree, one after the other, so that a later one finds what an earlier one made. `thimble` is
# BUILD_DIR/thimble.
#   Not run: what its comment marks `# hardware` or `# window`; a summary of options (SCENE, [...], A|B).
#   `make TARGET` is only asked for (make -n), since it builds or tests everything; of `make run` what follows the
#   build is run, for the pictures in out/.
# readme_commands.sh ROOT BUILD_DIR WORK_DIR
set -eu
cd "$1"
build=$(cd "$2" && pwd)
mkdir -p "$3"
work=$(cd "$3" && pwd)
rm -rf "$work/tree"
mkdir -p "$work/tree/build/release"
for entry in * .ci .clang-format; do
  case $entry in build | out) ;; *) [ ! -e "$entry" ] || cp -R "$entry" "$work/tree/" ;; esac
done
for program in "$build"/thimble*; do
  if [ -f "$program" ] && [ -x "$program" ]; then
    ln -s "$program" "$work/tree/build/release/"
  fi
done
cd "$work/tree"
export PATH="$work/tree/build/release:$PATH"
unset DISPLAY WAYLAND_DISPLAY

# A line each; a line that ends in \ goes on in the next.
commands=$work/commands
awk '
  /^```/ { inside = !inside && /^```(sh|bash|console)?[ \t]*$/; next }
  inside || /^    / {
    sub(/^ +/, "")
    sub(/^\$ /, "")
    line = line $0
    if (line ~ /\\$/) { sub(/\\$/, " ", line); next }
    if (line ~ /^(make|thimble|build\/)/) print line
    line = ""
    next
  }
  { line = "" }' README.md >"$commands"
if [ ! -s "$commands" ]; then
  echo "readme_commands: the README shows no command" >&2
  exit 1
fi
failed=0
ran=0
while IFS= read -r line <&3; do
  command=$(printf '%s\n' "$line" | sed 's/[ \t][ \t]*#.*$//')
  case $line in *'# hardware'* | *'# window'*) continue ;; esac
  if printf '%s\n' "$command" | grep -qE '\[|\||\.\.\.|(^| )(SCENE|FILE|NAME)( |$)'; then
    continue
  fi
  case $command in
    'make run') run='make -n run && sh tools/run_demo.sh build/release/thimble out' ;;
    make*) run="make -n ${command#make}" ;;
    *) run=$command ;;
  esac
  ran=$((ran + 1))
  if ! timeout 60 sh -c "$run" </dev/null >"$work/log" 2>&1; then
    tail -n 5 "$work/log"
    echo "readme_commands: this fails: $command" >&2
    failed=1
  fi
done 3<"$commands"
if [ $ran = 0 ]; then
  echo "readme_commands: the README shows no command that can be run" >&2
  exit 1
fi
echo "readme_commands: ran $ran"
exit $failed
