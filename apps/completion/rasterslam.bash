# bash completion for rasterslam: the program itself knows its commands, flags, names and keys.
_rasterslam() {
  local IFS=$'\n' word words=() glue=
  # bash breaks section.key=value into three words.
  for word in "${COMP_WORDS[@]:1:COMP_CWORD}"; do
    if [[ -n $glue || ( $word == = && ${#words[@]} -gt 0 ) ]]; then
      words[-1]+=$word
      glue=
      [[ $word == = ]] && glue=yes
    else
      words+=("$word")
    fi
  done
  # shellcheck disable=SC2207  # one word per line
  COMPREPLY=($("${COMP_WORDS[0]}" complete "${words[@]}" 2>/dev/null))
  case ${COMPREPLY[0]-} in *=) compopt -o nospace 2>/dev/null ;; esac
  if [[ ${words[-1]} == *=* && $COMP_WORDBREAKS == *=* ]]; then
    COMPREPLY=("${COMPREPLY[@]#"${words[-1]%=*}="}")
  fi
}
complete -o default -F _rasterslam rasterslam
