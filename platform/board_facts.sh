# Read by the scripts beside it, from the root of the source: `fact NAME` prints BOARD_NAME of $board.
if [ ! -f "platform/boards/$board/board.cmake" ]; then
  echo "thimble: there is no board '$board'; the boards are: $(cd platform/boards && echo */board.cmake | sed 's,/board\.cmake,,g')" >&2
  exit 2
fi
# Where the board includes other facts, its own count.
fact() {
  like=$(sed -n 's,^include(.*/\.\./\(.*\))$,platform/boards/\1,p' "platform/boards/$board/board.cmake")
  cat $like "platform/boards/$board/board.cmake" | sed -n "s/^set(BOARD_$1 \"\\{0,1\\}\\([^\")]*\\)\"\\{0,1\\}.*)/\\1/p" | tail -n 1
}
# choose_scene: what "auto" is for $board and $apps, in `scene` (the demonstration shows what reads on the board's display, all
# others the valley); and the effects that it is baked for, in `effects`, where they are not its own.
choose_scene() {
  if [ "$scene" = auto ]; then
    scene=demo
    if [ "$apps" = demo ] && [ "$(fact DISPLAY)" = oled ]; then
      scene=oled
    fi
  fi
  effects=${EFFECTS:-}
  if [ -z "$effects" ]; then
    case $scene in demo | valley) effects=$(fact DEMO_EFFECTS) ;; esac
  fi
}
