#!/bin/sh
# Strategies x worlds x seeds in the closed loop, scored on the truth.
#
#   benchmarks/exploration/sweep.sh [-s SLAM] [-n SEEDS] [-d SECONDS] [-w WORLDS] [-S STRATEGIES] [-j THREADS]
#                                   [-p PROGRAM] [-o FOLDER]
#
# Writes FOLDER/exploration_SLAM_runs.csv (every run), _medians.csv (median and quartiles per world and strategy),
# _cost.csv (CPU time per decision, the only file that depends on the machine), _tables.md (for people) and
# _made_by.txt (command, version, machine). A scan has 181 beams: coverage and strategies hardly notice, and it is
# three times as fast. A run without new area for ten minutes ends, so that strategies that never know when they are
# done do not take the time of the others.
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
command_line="benchmarks/exploration/sweep.sh $*"
slam=truth
seeds=10
duration=1500
worlds=corridor,flat,maze,office_loop,pillar_hall
strategies=longest_ray,quadrant,random_heading,wall_follow,nearest_frontier,information_gain,next_best_view
threads=2
program=$root/build/release/apps/rasterslam
folder=$root/benchmarks/results
while getopts s:n:d:w:S:j:p:o: option; do
  case $option in
    s) slam=$OPTARG ;;
    n) seeds=$OPTARG ;;
    d) duration=$OPTARG ;;
    w) worlds=$OPTARG ;;
    S) strategies=$OPTARG ;;
    j) threads=$OPTARG ;;
    p) program=$OPTARG ;;
    o) folder=$OPTARG ;;
    *) sed -n '4,5s/^# *//p' "$0" >&2; exit 2 ;;
  esac
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$folder"

# append FROM TO: a table of CSV to one that has the same columns; its own header only once.
append() {
  if [ -f "$2" ]; then tail -n +2 "$1" >> "$2"; else cp "$1" "$2"; fi
}

for world in $(echo "$worlds" | tr , ' '); do
  # Exit code 4: the SLAM method failed in some run; the tables say in which.
  status=0
  "$program" explore "$world" --strategy "$strategies" --slam "$slam" --seeds "$seeds" --duration "$duration" \
    --set lidar.beams=181 --set exploration.give_up_s=600 --threads "$threads" --tables-only -o "$work/$world" > "$work/$world.txt" || status=$?
  if [ "$status" -ne 0 ] && [ "$status" -ne 4 ]; then exit "$status"; fi
  if [ ! -f "$work/$world/runs.csv" ]; then exit "$status"; fi
  append "$work/$world/runs.csv" "$work/runs.csv"
  append "$work/$world/scores.csv" "$work/medians.csv"
  sed "1s/^/plan,/; 2,\$s/^/$world,/" "$work/$world/cost.csv" > "$work/$world/cost_of_plan.csv"
  append "$work/$world/cost_of_plan.csv" "$work/cost.csv"
  { cat "$work/$world/scores.md"; echo; } >> "$work/tables.md"
done
{
  echo "$command_line"
  "$program" --version
  sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | sort | uniq -c | sed 's/^ *\([0-9]*\) /\1 x /'
} > "$work/made_by.txt"

name=exploration_$(basename "$slam" .ini)
for table in runs.csv medians.csv cost.csv tables.md made_by.txt; do
  mv "$work/$table" "$folder/${name}_$table"
done
echo "$folder/${name}_medians.csv"
