# bash completion for rasterslam: the program itself knows its commands, flags and names.
_rasterslam() {
  local IFS=$'\n'
  # shellcheck disable=SC2207  # one word per line
  COMPREPLY=($("${COMP_WORDS[0]}" complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null))
}
complete -o default -F _rasterslam rasterslam
