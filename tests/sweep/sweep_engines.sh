#!/bin/sh
# A sweep by GNU parallel, or by Slurm on one node on the loopback with one task killed while it works: the same bytes as
# the local sweep.
#
#   sweep_engines.sh PROGRAM parallel|slurm
#
# Exit code 77: the engine is not installed.
set -eu

program=$1
engine=$2
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
. "$here/sweep_common.sh"
work=$(mktemp -d)
mkdir "$work/slurm"
trap '"$here/slurm_node.sh" stop "$work/slurm"; rm -rf "$work"' EXIT
cd "$work"
write_tiny_suite tiny.ini
if [ "$engine" = parallel ]; then
  if ! command -v parallel > /dev/null; then
    echo "parallel is not installed" >&2
    exit 77
  fi
  "$program" bench tiny.ini -o whole -q > /dev/null
  "$program" bench submit tiny.ini -o out --engine parallel --tasks 2 --go > /dev/null
  same_sweep whole out || fail "GNU parallel's sweep differs"
  exit 0
fi

SLURM_CONF=$("$here/slurm_node.sh" start "$work/slurm")
export SLURM_CONF
"$program" bench tiny.ini -o whole -q > /dev/null
"$program" bench submit tiny.ini -o out --engine slurm --tasks 2 --go
# The first task's process, as soon as it works on a cell.
victim=
while [ -z "$victim" ] && [ ! -f out/results.csv ]; do
  # Its cells are copies of it, with the same command line: it is the one that a folder is named after.
  for process in $(pgrep -f "bench exec $work/out/suite.ini .* 1/2"); do
    if ls out/partial/*."$process"/*/cell.json > /dev/null 2>&1; then victim=$process; fi
  done
done
[ -n "$victim" ] || fail "no task to kill"
kill -KILL "$victim"
tries=0
while [ -n "$(squeue -h)" ]; do
  tries=$((tries + 1))
  [ "$tries" -lt 600 ] || fail "jobs are left: $(squeue)"
  sleep 0.1
done
cat out/submit/task_1.log
grep -q 'attempt 1 ended with exit code 137' out/submit/task_1.log || fail "the kill did not show"
[ -f out/results.csv ] || fail "not merged: $(cat out/submit/*.log)"
# What the killed one left goes with the next sweep in the folder.
"$program" bench tiny.ini -o out -q --resume > /dev/null
same_sweep whole out || fail "Slurm's sweep differs"
