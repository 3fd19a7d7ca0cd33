#!/bin/sh
# The README's commands, as written: each line of an indented or ```sh block that begins with make, thimble, c++ or
# build/ runs in a copy of the tree, one after the other, so that a later one finds what an earlier one made. `thimble` is
# BUILD_DIR/thimble.
#   Not run: what its comment marks `# hardware`; a summary of options (SCENE, [...], A|B).
#   What is marked `# window` opens one on a display that nobody sees, and Escape ends it; where Xvfb or xdotool are
#   missing it is left out.
#   `make TARGET` is only asked for (make -n), since it builds or tests everything. Of `make run` what follows the
#   build is run, for the pictures in out/; `make install` installs what is built, in a prefix of its own.
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
for made in "$build"/thimble "$build"/thimble-fb "$build"/thimble_*_table "$build"/libthimble.a; do
  [ ! -f "$made" ] || ln -s "$made" "$work/tree/build/release/"
done
[ ! -f "$build/cmake_install.cmake" ] || ln -s "$build/cmake_install.cmake" "$work/tree/build/release/"
cd "$work/tree"
export PATH="$work/tree/build/release:$PATH"
unset DISPLAY WAYLAND_DISPLAY

# A line each; a line that ends in \ continues in the next.
commands=$work/commands
awk '
  /^```/ { inside = !inside && /^```(sh|bash|console)?[ \t]*$/; next }
  inside || /^    / {
    sub(/^ +/, "")
    sub(/^\$ /, "")
    line = line $0
    if (line ~ /\\$/) { sub(/\\$/, " ", line); next }
    if (line ~ /^(make|thimble|c\+\+|build\/)/) print line
    line = ""
    next
  }
  { line = "" }' README.md >"$commands"
server=
trap '[ -z "$server" ] || kill $server' EXIT
# in_window COMMAND: it opens a window, and ends well after Escape.
in_window() {
  if [ -z "$server" ]; then
    rm -f "$work/display"
    Xvfb -displayfd 1 -screen 0 1280x900x24 -noreset -nolisten tcp >"$work/display" 2>/dev/null &
    server=$!
    # What stands for a terminal at which nobody types: a file that ended would end the simulator.
    rm -f "$work/keys"
    mkfifo "$work/keys"
    exec 4<>"$work/keys"
    for _ in $(seq 100); do
      [ ! -s "$work/display" ] || break
      sleep 0.2
    done
  fi
  DISPLAY=:$(cat "$work/display")
  export DISPLAY
  timeout 60 sh -c "exec $1" <&4 >"$work/log" 2>&1 &
  shown=$!
  status=1
  for _ in $(seq 150); do
    # The process is looked for first: what ends at once has shown nothing.
    kill -0 $shown 2>/dev/null || break
    if xdotool search --onlyvisible --name . >/dev/null 2>&1; then
      status=0
      break
    fi
    sleep 0.2
  done
  # Without a window manager the keys go to the window under the pointer, which may have just come.
  while [ $status = 0 ] && kill -0 $shown 2>/dev/null; do
    xdotool mousemove 100 100 key Escape >/dev/null 2>&1 || true
    sleep 0.2
  done
  wait $shown || status=1
  unset DISPLAY
  return $status
}
if [ ! -s "$commands" ]; then
  echo "readme_commands: the README shows no command" >&2
  exit 1
fi
failed=0
ran=0
while IFS= read -r line <&3; do
  command=$(printf '%s\n' "$line" | sed 's/[ \t][ \t]*#.*$//')
  case $line in *'# hardware'*) continue ;; esac
  if printf '%s\n' "$command" | grep -qE '\[|\||\.\.\.|(^| )(SCENE|FILE|NAME)( |$)'; then
    continue
  fi
  case $line in
    *'# window'*)
      if ! command -v Xvfb >/dev/null || ! command -v xdotool >/dev/null; then
        echo "left out, since Xvfb or xdotool is not installed: $command"
        continue
      fi
      ran=$((ran + 1))
      if ! in_window "$command"; then
        tail -n 5 "$work/log"
        echo "readme_commands: this opens no window, or Escape does not end it: $command" >&2
        failed=1
      fi
      continue
      ;;
  esac
  case $command in
    'make install')
      run="make -o all install PREFIX=$work/prefix && [ -n \"\$(find $work/prefix -type f)\" ]"
      rm -rf "$work/prefix"
      ;;
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
