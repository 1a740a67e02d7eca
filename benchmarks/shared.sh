# shellcheck shell=sh
# For the benchmarks that are shell scripts: to be read with '.' by a script of sh with 'set -eu'.

# read_options "LETTER=VARIABLE ..." "$@": sets the variables from -LETTER VALUE; anything else ends the script with the line of
# its head that says how it is called.
read_options() {
  known_options=$1
  shift
  letters=
  for known in $known_options; do letters=$letters${known%%=*}:; done
  while getopts "$letters" option; do
    variable=
    for known in $known_options; do
      if [ "${known%%=*}" = "$option" ]; then variable=${known#*=}; fi
    done
    if [ -z "$variable" ]; then
      sed -n '/^# *benchmarks\//{s/^# *//p;q;}' "$0" >&2
      exit 2
    fi
    eval "$variable=\$OPTARG"
  done
}

# make_folders: $work, or where that is empty a temporary one that goes with the script, and $folder.
# shellcheck disable=SC2154  # both are of the script that reads this
make_folders() {
  if [ -z "$work" ]; then
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
  fi
  mkdir -p "$work" "$folder"
}
