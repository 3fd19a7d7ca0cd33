# Read by the scripts beside it, from the root of the source: `fact NAME` prints BOARD_NAME of $board.
if [ ! -f "platform/boards/$board/board.cmake" ]; then
  echo "thimble: there is no board '$board'; the boards are: $(cd platform/boards && echo */board.cmake | sed 's,/board\.cmake,,g')" >&2
  exit 2
fi
fact() {
  sed -n "s/^set(BOARD_$1 \"\\{0,1\\}\\([^\")]*\\)\"\\{0,1\\}.*)/\\1/p" "platform/boards/$board/board.cmake"
}
