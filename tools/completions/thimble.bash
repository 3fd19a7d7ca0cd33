# Bash completes thimble's commands, options and values by what `thimble complete` answers.
_thimble() {
  local IFS=$'\n' line
  COMPREPLY=()
  for line in $("${COMP_WORDS[0]}" complete "${COMP_WORDS[*]:0:COMP_CWORD+1}" 2>/dev/null); do
    if [[ $line == /files ]]; then
      local word=${COMP_WORDS[COMP_CWORD]}
      [[ $word == = ]] && word=
      compopt -o filenames 2>/dev/null
      COMPREPLY+=($(compgen -f -- "$word"))
    else
      COMPREPLY+=("${line%%$'\t'*}")
    fi
  done
}
complete -F _thimble thimble
