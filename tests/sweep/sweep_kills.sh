#!/bin/sh
# kill -9 of the process that runs a sweep, or of one that does a cell, 20 times at random (seeded) events, an event being
# that a folder or file has come: --resume then gives the same bytes as a sweep that nobody disturbed.
#
#   sweep_kills.sh PROGRAM [SEED]
set -eu

program=$1
seed=${2:-1}
. "$(dirname "$0")/sweep_common.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
write_tiny_suite tiny.ini
"$program" bench tiny.ini -o whole -q -j 2 > /dev/null
# Events and victims, one a line: so many cells are complete and then so many files (and folders) lie in those in flight.
# Of six cells a log has up to 12, a run up to 9; an event that never comes is followed by the next line.
awk -v seed="$seed" 'BEGIN {
  srand(seed)
  for (i = 0; i < 200; ++i) print int(rand() * 6), 1 + int(rand() * 12), rand() < 0.5 ? "runner" : "worker"
}' > plan.txt

# Without a process of its own, so that it looks often: whether there are $1 or more of the paths that follow.
are_there() {
  least=$1
  shift
  [ "$least" -eq 0 ] || { [ -e "$1" ] && [ $# -ge "$least" ]; }
}
kill_runner() {
  kill -KILL "$runner" 2> /dev/null
}
kill_worker() {
  victims=
  read -r victims < "/proc/$runner/task/$runner/children" 2> /dev/null || true
  [ -n "$victims" ] && kill -KILL "${victims%% *}" 2> /dev/null
}

kills=0
while [ "$kills" -lt 20 ] && read -r cells files victim; do
  # A sweep that is complete has nothing left to be killed.
  if [ -f out/results.csv ]; then
    same_sweep whole out || fail "a sweep that was killed differs"
    rm -rf out
  fi
  "$program" bench tiny.ini -o out -q --resume -j 2 > /dev/null 2> errors.txt &
  runner=$!
  while kill -0 "$runner" 2> /dev/null && [ ! -f out/results.csv ]; do
    are_there "$cells" out/cells/* && are_there "$files" out/partial/*/*/* out/partial/*/*/run/* || continue
    "kill_$victim" && kills=$((kills + 1))
    break
  done || true
  wait $runner 2> /dev/null || [ $? -eq 137 ] || fail "the sweep ended otherwise than by the kill: $(cat errors.txt)"
done < plan.txt
[ "$kills" -eq 20 ] || fail "only $kills kills met a running process"
"$program" bench tiny.ini -o out -q --resume > /dev/null
same_sweep whole out || fail "the sweep differs after $kills kills"
[ ! -e out/partial ] || fail "leftovers: $(find out/partial)"
echo "$kills kills, the same bytes"
