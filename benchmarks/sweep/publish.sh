#!/bin/sh
# Puts a finished sweep's results beside the committed ones.
#
#   benchmarks/sweep/publish.sh SWEEP NAME COMMIT
#
# SWEEP is what `rasterslam bench` wrote, COMMIT what its program was built from. Writes benchmarks/results/NAME.txt (the
# command, the commit, the machine, the statistics, the cost), NAME.csv.xz (a row per run) and NAME_cost.csv.xz
# (its time and memory). Then `benchmarks/readme_tables.py` brings the README up to date.
set -eu

[ $# -eq 3 ] || { sed -n '4s/^# *//p' "$0" >&2; exit 2; }
sweep=$1 name=$2 commit=$3
results=$(CDPATH='' cd -- "$(dirname -- "$0")/../results" && pwd)
field() { grep -m1 "$1" /proc/cpuinfo | cut -d: -f2- | sed 's/^ *//'; }
{
  echo "Made by: rasterslam bench configs/suites/$name.ini -o $name -j 2; results.csv is $name.csv.xz, cost.csv ${name}_cost.csv.xz"
  echo "Seeds:   $(sed -n 's/^seeds *= *//p' "$sweep/suite.ini")"
  echo "Version: $(sed -n 's/^  "version": "\(.*\)",/\1/p' "$sweep/manifest.json"), commit $commit; $(sed -n 's/^  "build": "\(.*\)",/\1/p' "$sweep/manifest.json")"
  echo "Machine: $(field 'model name'), $(nproc) cores, $(awk '/MemTotal/ { printf "%.0f GB", $2 / 1048576 }' /proc/meminfo); Debian $(cat /etc/debian_version)"
  for part in summary consistency cost_summary; do
    echo
    cat "$sweep/$part.txt"
  done
} > "$results/$name.txt.tmp"
xz -9 -c "$sweep/results.csv" > "$results/$name.csv.xz.tmp"
xz -9 -c "$sweep/cost.csv" > "$results/${name}_cost.csv.xz.tmp"
for file in "$name.txt" "$name.csv.xz" "${name}_cost.csv.xz"; do mv "$results/$file.tmp" "$results/$file"; done
