#!/bin/bash
# Puts one bug at a time into a copy of the sources, builds the room's tests and counts how many bugs they notice.
#   tests/mutation/run.sh [-c] [-l LIST] [-w FOLDER] [-j JOBS] [ROOM | NUMBER ...]
# -c: only checks that every line's text stands in its file, once.
# LIST (tests/mutation/list.txt) has a line per bug, fields parted by " @ ":
#   FILE under libslam/ @ TEXT that stands in it once @ what stands there instead (\n: the end of a line) @ what a user would see of it
# Chosen by room or by line number; all without. FOLDER holds the copy and its build, and is kept when it is given; so the next run is quick.
# A bug is noticed when the tests of its file's room fail, or do not end within 10 minutes. Exit code 0: at least 90 % in every room;
# 1: fewer; 2: a line that cannot be carried out (no such text, or it does not compile).
set -u
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
list=$root/tests/mutation/list.txt work='' jobs=2 checks_only=no
while getopts cl:w:j: option; do
  case $option in
    c) checks_only=yes ;;
    l) list=$OPTARG ;;
    w) work=$OPTARG ;;
    j) jobs=$OPTARG ;;
    *) sed -n '2,10s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
chosen=" $* "

stands_once() { OLD=$old perl -0ne '$n += () = /\Q$ENV{OLD}\E/g; END { exit($n == 1 ? 0 : 1) }' "$1"; }

prepare() {
  if [ -z "$work" ]; then
    work=$(mktemp -d) || exit 2
    trap 'rm -rf "$work"' EXIT
  fi
  mkdir -p "$work/tree" && work=$(cd "$work" && pwd) || exit 2

  # Changed files only, so that what was built stays.
  files() { (cd "$root" && git ls-files -co --exclude-standard | while IFS= read -r file; do [ -e "$file" ] && echo "$file"; done | sort); }
  files | tar c -C "$root" -T - | tar x --keep-newer-files -C "$work/tree" 2> /dev/null
  # A run that was ended left its bug in.
  sed -n 's/^\([^# ]*\) @ .*/libslam\/\1/p' "$list" | sort -u | while IFS= read -r file; do
    cmp -s "$root/$file" "$work/tree/$file" || cp "$root/$file" "$work/tree/$file"
  done
  (cd "$work/tree" && find . -path ./build -prune -o -type f -printf '%P\n' | sort | comm -23 - <(files) | xargs -r -d '\n' rm -f)
  build=$work/tree/build/release  # where the presets build, so that a compiler cache knows what it has compiled
  cmake -S "$work/tree" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DRASTERSLAM_WERROR=OFF > "$work/configure.txt" 2>&1 || { cat "$work/configure.txt"; exit 2; }
}

# The programs that try a room: its own, or that of the room on whose tests it relies, or both.
tests_of() {
  case $1 in
    bags | rawlogs) echo logs ;;
    objects) echo "objects logs" ;;
    sweep) echo apps ;;
    methods) echo mapping ;;
    goals) echo "goals navigate" ;;
    drafting) echo check ;;
    keyframes) echo "keyframes graph" ;;
    loops) echo "loops graph" ;;
    uncertainty) echo "uncertainty graph" ;;
    tracking) echo "tracking graph" ;;
    bundle) echo "bundle graph" ;;
    particles) echo "particles mapping" ;;
    choices | strategies | safety) echo "$1 navigate" ;;
    movers) echo "movers sim" ;;
    calibration) echo "calibration doctor" ;;
    truth) echo "truth record" ;;
    results) echo "results run" ;;
    teams | reach) echo "$1 explore" ;;
    summary) echo "summary study" ;;
    *) echo "$1" ;;
  esac
}
filter_of() { case $1 in sweep) echo 'Bench*' ;; *) echo '*' ;; esac; }
builds() {
  # shellcheck disable=SC2046  # words
  cmake --build "$build" -j "$jobs" --target $(printf 'test_%s ' $(tests_of "$1")) > "$work/build.txt" 2>&1
}
passes() {
  local program
  for program in $(tests_of "$1"); do
    (cd "$build" && timeout 600 "tests/test_$program" --gtest_brief=1 --gtest_fail_fast --gtest_filter="$(filter_of "$1")" > "$work/tests.txt" 2>&1) || return 1
  done
}

[ $checks_only = yes ] || prepare
declare -A all noticed ready
broken=0 number=0
while IFS= read -r line; do
  number=$((number + 1))
  case $line in '' | '#'*) continue ;; esac
  file=${line%% @ *} rest=${line#* @ }
  old=${rest%% @ *} rest=${rest#* @ }
  new=${rest%% @ *} reason=${rest#* @ }
  old=${old//\\n/$'\n'} new=${new//\\n/$'\n'}
  room=${file%%/*}
  [ "$chosen" = "  " ] || [[ $chosen == *" $room "* ]] || [[ $chosen == *" $number "* ]] || continue
  if ! stands_once "$root/libslam/$file"; then
    echo "line $number: '$old' stands not once in $file"
    broken=1
    continue
  fi
  [ $checks_only = no ] || continue
  if [ -z "${ready[$room]-}" ]; then
    if ! builds "$room" || ! passes "$room"; then
      echo "$room: its tests fail as it is: $work/build.txt, $work/tests.txt"
      exit 2
    fi
    ready[$room]=1
  fi
  path=$work/tree/libslam/$file
  cp -p "$path" "$work/kept"
  OLD=$old NEW=$new perl -0pi -e 's/\Q$ENV{OLD}\E/$ENV{NEW}/' "$path"
  if ! builds "$room"; then
    echo "line $number: does not compile: $(grep -m1 error: "$work/build.txt")"
    broken=1
  else
    all[$room]=$((${all[$room]-0} + 1))
    if passes "$room"; then
      echo "NOT noticed: line $number, $file: $reason"
    else
      noticed[$room]=$((${noticed[$room]-0} + 1))
      echo "noticed: line $number, $file, by $(grep -m1 -o '^\[  FAILED  \] [^ ,]*' "$work/tests.txt" | cut -c14-)"
    fi
  fi
  cp "$work/kept" "$path"
done < "$list"

code=$((broken * 2))
for room in "${!all[@]}"; do
  echo "$room: ${noticed[$room]-0} of ${all[$room]} noticed"
  [ $((10 * ${noticed[$room]-0})) -ge $((9 * ${all[$room]})) ] || [ $code -ne 0 ] || code=1
done
exit $code
