# To be sourced, with `board`, `app` and the folder `work` set: how to say a result, and how to build.
failed=0
say() {
  printf '%-18s %-10s %s\n' "$board" "$app" "$1"
}
fail() {
  say "FAILED: $1"
  failed=1
}
# ends SENTENCE: says it where nothing failed.
ends() {
  [ $failed = 1 ] || say "$1"
  exit $failed
}
# builds APPS [SCENE]: the firmware, or ends.
builds() {
  sh platform/build.sh "$board" "$@" >"$work/$app.build.log" 2>&1 || {
    tail -n 5 "$work/$app.build.log" >&2
    fail "$1: does not build"
    exit 1
  }
}
