#!/bin/sh
# The completions in the shells that are there: bash completes as at a terminal, fish lists what it would offer, zsh
# reads its script.     completions.sh ROOT THIMBLE WORK_DIR
set -eu
root=$1
thimble=$2
work=$3
rm -rf "$work"
mkdir -p "$work/bin" "$work/here"
ln -s "$thimble" "$work/bin/thimble"
PATH=$work/bin:$PATH
export PATH
failed=0
cd "$work/here"
: >picture.png
: >"two words.vox"
# wants WHAT GIVEN WANTED
wants() {
  if [ "$2" != "$3" ]; then
    printf 'completions: %s: wanted\n%s\nand got\n%s\n' "$1" "$3" "$2" >&2
    failed=1
  fi
}

if command -v bash >/dev/null 2>&1; then
  # complete WORD...: what bash would put in the place of the last one.
  cat >"$work/ask.bash" <<'ASK'
source "$SCRIPT"
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_thimble
printf '%s\n' "${COMPREPLY[@]}"
ASK
  ask() { SCRIPT=$root/tools/completions/thimble.bash bash --norc "$work/ask.bash" "$@" 2>&1; }
  wants 'bash, a subcommand' "$(ask thimble rend)" render
  wants 'bash, an option' "$(ask thimble render castle --sha)" --shade
  wants 'bash, a value behind =' "$(ask thimble render --shade = col)" color
  wants 'bash, a file' "$(ask thimble render castle -o pic)" picture.png
  wants 'bash, a scene and a file with a blank' "$(ask thimble render two)" 'two words.vox'
  wants 'bash, nothing' "$(ask thimble render castle --size 1)" ''
  # At a terminal: a Tab, and the command that stands there then runs.
  if command -v script >/dev/null 2>&1; then
    printf 'source %s\nthimble vers\tion-of-nothing\nthimble --vers\t\nexit\n' "$root/tools/completions/thimble.bash" |
      script -qec 'bash --norc --noprofile -i' /dev/null >"$work/terminal" 2>&1 || true
    if ! grep -q '^wide renderer' "$work/terminal"; then
      cat "$work/terminal" >&2
      echo "completions: bash at a terminal does not complete thimble --vers" >&2
      failed=1
    fi
  fi
fi
if command -v zsh >/dev/null 2>&1; then
  zsh -n "$root/tools/completions/thimble.zsh" || failed=1
  # Zsh's own machinery, at a terminal of its own.
  cat >"$work/ask.zsh" <<'ASK'
zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell "PS1=; fpath=($WORK/functions \$fpath); autoload -Uz compinit; compinit -D -u; print ready"
zpty -r shell line '*ready*'
zpty -w -n shell $'thimble --vers\t\n'
zpty -r shell line '*windows*'
print -r -- $line
ASK
  mkdir -p "$work/functions"
  cp "$root/tools/completions/thimble.zsh" "$work/functions/_thimble"
  if ! WORK=$work timeout 20 zsh -f "$work/ask.zsh" >"$work/zsh" 2>&1 || ! grep -q 'wide renderer' "$work/zsh"; then
    cat "$work/zsh" >&2
    echo "completions: zsh at a terminal does not complete thimble --vers" >&2
    failed=1
  fi
fi
if command -v fish >/dev/null 2>&1; then
  HOME=$work
  export HOME
  ask() { fish --no-config -c "source $root/tools/completions/thimble.fish; complete -C '$1'" 2>&1 | cut -f 1; }
  wants 'fish, a subcommand' "$(ask 'thimble rend')" render
  wants 'fish, an option' "$(ask 'thimble render castle --sha')" --shade
  wants 'fish, a value' "$(ask 'thimble render --shade col')" color
  wants 'fish, a file' "$(ask 'thimble render castle -o pic')" picture.png
fi
[ $failed = 0 ] && echo "completions: as wanted"
exit $failed
