#!/bin/sh
# What the runner of a sweep costs beside the cells, and what a second job gains:
#
#   benchmarks/sweep/overhead.sh PROGRAM [SUITE.ini]      # default: configs/suites/smoke.ini
#
# "by CPU": user and system time of the runner and of all cells, less what the cells say that they computed (cost.json,
# which begins with the cell's process), over that. It holds on a busy machine too. "by the clock": jobs x the runner's time,
# less the same: on a machine that does nothing else.
set -eu

program=$1
suite=${2:-$(dirname "$0")/../../configs/suites/smoke.ini}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# User and system time of this shell's children so far: the second line of `times`, "0m1.5s 0m0.2s".
cpu_of_children() {
  times > "$work/times"
  cpu=$(awk 'NR == 2 { for (i = 1; i <= 2; ++i) { split($i, t, "m"); total += 60 * t[1] + t[2] } print total }' "$work/times")
}

cpu_of_children
before=$cpu
"$program" --version > /dev/null
cpu_of_children
echo "$before $cpu" | awk '{ printf "one start of the program: %.2f s of CPU, in each of these once\n", $2 - $1 }'
for jobs in 1 2; do
  cpu_of_children
  before=$cpu
  begin=$(date +%s.%N)
  "$program" bench exec "$suite" -o "$work/$jobs" -j $jobs -q > /dev/null
  end=$(date +%s.%N)
  cpu_of_children
  after=$cpu
  cat "$work/$jobs"/cells/*/cost.json | awk -v jobs=$jobs -v wall="$begin $end" -v cpu="$before $after" '
    /"cpu_s"/ { gsub(/[,]/, ""); cells += $2; ++count }
    END {
      split(wall, w); split(cpu, c)
      printf "%d job%s: %d cells computed %.2f s; took %.2f s of CPU (%+.1f %%), %.2f s by the clock (%+.1f %%)\n",
             jobs, (jobs > 1 ? "s" : ""), count, cells, c[2] - c[1], 100 * ((c[2] - c[1]) / cells - 1),
             w[2] - w[1], 100 * (jobs * (w[2] - w[1]) / cells - 1)
    }'
done
