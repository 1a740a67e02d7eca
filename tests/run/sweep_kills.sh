#!/bin/sh
# kill -9 of the process that runs a sweep, or of one that does a cell, 20 times at random (seeded) moments: --resume then
# gives the same bytes as a sweep that nobody disturbed.
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
begin=$(date +%s.%N)
"$program" bench tiny.ini -o whole -q -j 2 > /dev/null
# Moments within the time that a sweep takes, and victims, one a line; a moment may come too early or too late for a kill.
awk -v seed="$seed" -v begin="$begin" -v end="$(date +%s.%N)" 'BEGIN {
  srand(seed)
  for (i = 0; i < 60; ++i) print rand() * 0.7 * (end - begin), rand() < 0.5 ? "runner" : "worker"
}' > plan.txt
kills=0
while [ "$kills" -lt 20 ] && read -r moment victim; do
  # A sweep that is complete has nothing left to be killed.
  if [ -f out/results.csv ]; then
    same_sweep whole out || fail "a sweep that was killed differs"
    rm -rf out
  fi
  "$program" bench tiny.ini -o out -q --resume -j 2 > /dev/null 2> errors.txt &
  runner=$!
  sleep "$moment"
  if [ "$victim" = runner ]; then
    kill -KILL $runner 2> /dev/null && kills=$((kills + 1))
  else
    for child in $(cat /proc/$runner/task/$runner/children 2> /dev/null); do
      kill -KILL "$child" 2> /dev/null && kills=$((kills + 1))
      break
    done
  fi || true
  wait $runner 2> /dev/null || [ $? -eq 137 ] || fail "the sweep ended otherwise than by the kill: $(cat errors.txt)"
done < plan.txt
[ "$kills" -eq 20 ] || fail "only $kills kills met a running process"
"$program" bench tiny.ini -o out -q --resume > /dev/null
same_sweep whole out || fail "the sweep differs after $kills kills"
[ ! -e out/partial ] || fail "leftovers: $(find out/partial)"
echo "$kills kills, the same bytes"
