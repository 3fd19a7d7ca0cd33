#compdef thimble
# Zsh completes thimble's commands, options and values by what `thimble complete` answers.
_thimble() {
  local line word
  local -a offered
  for line in ${(f)"$(${words[1]} complete "${(F)words[1,CURRENT]}" 2>/dev/null)"}; do
    if [[ $line == /files ]]; then
      _files
    else
      word=${line%%$'\t'*}
      offered+=("${word//:/\\:}:${line#*$'\t'}")
    fi
  done
  (( $#offered )) && _describe -t words 'thimble' offered
}
_thimble "$@"
