#!/bin/sh
# MRPT's own methods and odometry alone, or any others, on the annotated logs of the Freiburg benchmark, scored by their
# relations.
#
#   benchmarks/relations/run.sh [-d DATA] [-l LOGS] [-m METHODS] [-n NAME] [-p PROGRAM] [-w WORK] [-o FOLDER]
#
# DATA/logs/LOG/ holds LOG.*clf* and LOG.relations ('rasterslam data intel' says where they are from); METHODS are .ini
# files of this folder or of configs/methods, one setting for all logs. Writes FOLDER/NAME.csv (one row per log and path: error,
# ms per scan, peak memory) and .txt (the same for people, the settings, command, version, machine). WORK keeps the runs,
# and an interrupted sweep goes on where it was.
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
command_line="benchmarks/relations/run.sh $*"
data=$root/../shared/data
logs=intel,fr079,mit-killian
methods=odometry,icp,rbpf,rbpf_exact
name=relations_baselines
program=$root/build/release/apps/rasterslam
work=
folder=$root/benchmarks/results
. "$root/benchmarks/shared.sh"
read_options "d=data l=logs m=methods n=name p=program w=work o=folder" "$@"
make_folders

files=
for method in $(echo "$methods" | tr , ' '); do
  file=$root/benchmarks/relations/$method.ini
  [ -f "$file" ] || file=$root/configs/methods/$method.ini
  files=$files${files:+,}$file
done

rm -f "$work/baselines.csv" "$work/baselines.txt"
for log in $(echo "$logs" | tr , ' '); do
  file=$(find "$data/logs/$log" -name "$log*.clf*" | head -n 1)
  # Exit code 4: a method failed on this log; the table says which.
  status=0
  "$program" compare "$file" --relations "$data/logs/$log/$log.relations" --methods "$files" -o "$work/$log" --resume \
    > "$work/$log.txt" || status=$?
  if [ "$status" -ne 0 ] && [ "$status" -ne 4 ]; then exit "$status"; fi
  # One row per path: its method's cost, named by the first word of the path, behind its error.
  tr -d '\r' < "$work/$log/cost.csv" > "$work/cost.csv"
  tr -d '\r' < "$work/$log/relations.csv" | awk -F, -v OFS=, -v log_name="$log" '
    NR == FNR { cost[$1] = $2 OFS $5; next }
    FNR == 1 { if (first) print "log", $0, "ms_per_scan", "peak_memory_mb"; next }
    { split($1, words, " "); print log_name, $0, cost[words[1]] }
  ' first="$([ -f "$work/baselines.csv" ] || echo 1)" "$work/cost.csv" - >> "$work/baselines.csv"
  { echo "== $log"; echo; cat "$work/$log.txt"; echo; } | sed "/^maps, paths, pictures:/d; /^worst relations:/d" >> "$work/baselines.txt"
done
{
  echo "Made by: $command_line"
  echo "Version: $("$program" --version)"
  echo "Machine: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) cores; one core per method, CPU time"
  echo "Settings: METHOD.ini in benchmarks/relations or configs/methods, which also say how they were found"
  echo
  cat "$work/baselines.txt"
} > "$folder/$name.txt"
cp "$work/baselines.csv" "$folder/$name.csv"
