#!/bin/sh
# What each odometry of ours does to the error of MRPT's own icp-slam and rbpf-slam, beside the log's own wheels.
#
#   benchmarks/odometry/stock_programs.sh [-d DATA] [-w WORK] [-p PROGRAM] [-o FOLDER] [-r "ODOMETRY ..."]
#
# Logs: the first 150 s of three simulated worlds (seed 7, built-in lidar and wheels; truth as relations) and the first 400 s
# of Intel (DATA/logs/intel, its annotated relations). Each log gets odometry by 'rasterslam filter --odometry'; the stock programs run
# with configs/mrpt/*.ini; their paths are scored by 'rasterslam eval --relations'. Writes FOLDER/stock_programs.csv (a row per log, odometry and program) and .txt
# (the same for people, command, version, machine). Needs Debian's mrpt-apps. About 6 minutes of one core. With -r only the rows of
# these odometries are made; the others stay as FOLDER/stock_programs.csv has them.
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
command_line=benchmarks/odometry/stock_programs.sh
data=$root/../shared/data
program=$root/build/release/apps/rasterslam
work=
folder=$root/benchmarks/results
rows=
. "$root/benchmarks/shared.sh"
read_options "d=data w=work p=program o=folder r=rows" "$@"
if [ -n "$rows" ]; then command_line="$command_line -r '$rows'"; fi
make_folders
csv=$work/stock_programs.csv
echo 'log,odometry,program,scored,translation_mean_m,translation_max_m,rotation_mean_deg,rotation_max_deg,seconds' > "$csv"

# score LOG ODOMETRY PROGRAM PATH SECONDS: one row; the key of a column, then its value
score() {
  "$program" eval "$4" --relations "$work/$1.relations" --json > "$work/score.json"
  python3 - "$work/score.json" "$1,$2,$3" "$5" >> "$csv" <<'PYTHON'
import json, sys
row = json.load(open(sys.argv[1]))["relations"]["rows"][0]
print(sys.argv[2], "%d" % row["scored"], *("%.4f" % row[key] for key in (
    "translation_mean_m", "translation_max_m", "rotation_mean_deg", "rotation_max_deg")), sys.argv[3], sep=",")
PYTHON
}

# stock LOG ODOMETRY PROGRAM YAW_FIELD: runs it in a folder of its own
stock() {
  run=$work/$1_$2_$3
  rm -rf "$run" && mkdir "$run"
  started=$(date +%s.%N)
  (cd "$run" && env -u DISPLAY "$3" "$root/configs/mrpt/$3.ini" "$work/$1_$2.rawlog" > out.txt 2>&1 < /dev/null) || {
    echo "$1,$2,$3,0,failed,,,," >> "$csv"
    return 0
  }
  seconds=$(echo "$(date +%s.%N) $started" | awk '{ printf "%.1f", $1 - $2 }')
  awk -v program="$3" -v x=2 -v y=3 -v yaw="$4" -f "$root/configs/plugins/frames_to_tum.awk" \
    "$work/$1.scans.tum" "$run/LOG_rasterslam_$3/log_estimated_path.txt" > "$run/path.tum"
  score "$1" "$2" "$3" "$run/path.tum" "$seconds"
}

# all LOG: every odometry of ours and the log's own, alone and under both programs
all() {
  "$program" convert "$work/$1_wheels.rawlog" "$work/$1.scans.tum" --overwrite -q > /dev/null
  for odometry in ${rows:-wheels argmax correlation range_flow plicp}; do
    [ "$odometry" = wheels ] ||
      "$program" filter "$work/$1_wheels.rawlog" --odometry "$odometry" -o "$work/$1_$odometry.rawlog" --overwrite -q > /dev/null
    "$program" convert "$work/$1_$odometry.rawlog" "$work/alone.tum" --overwrite -q > /dev/null
    score "$1" "$odometry" alone "$work/alone.tum" ''
    stock "$1" "$odometry" icp-slam 4
    stock "$1" "$odometry" rbpf-slam 5
  done
}

for world in flat office_loop pillar_hall; do
  "$program" simulate "$world" -o "$work/${world}_wheels.rawlog" --duration 150 --seed 7 --overwrite -q > /dev/null
  "$program" relations "$work/${world}_wheels.gt.tum" -o "$work/$world.relations" --overwrite -q > /dev/null
  all "$world"
done
if [ -f "$data/logs/intel/intel.clf.bz2" ]; then
  cp "$data/logs/intel/intel.relations" "$work/intel.relations"
  "$program" cut "$data/logs/intel/intel.clf.bz2" --to 400 -o "$work/intel.cut.rawlog" --overwrite -q > /dev/null
  "$program" convert "$work/intel.cut.rawlog" "$work/intel_wheels.rawlog" --form action --overwrite -q > /dev/null
  all intel
fi

if [ -n "$rows" ]; then
  python3 - "$csv" "$folder/stock_programs.csv" <<'PYTHON'
import csv, sys
made, before = ([*csv.reader(open(path))] for path in sys.argv[1:])
new = {tuple(row[:3]): row for row in made}
merged = [new.get(tuple(row[:3]), row) for row in before]
csv.writer(open(sys.argv[1], "w", newline=""), lineterminator="\n").writerows(merged)
PYTHON
fi

{
  echo "Made by: $command_line"
  echo "Version: $("$program" --version)"
  echo "Machine: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) cores, beside other work"
  echo "Error against relations: mean m / mean deg (max m). 'alone' composes the odometry; the programs run configs/mrpt/*.ini."
  echo
  awk -F, '
    NR == 1 { next }
    { cell[$1, $2, $3] = $5 == "failed" ? "failed" : sprintf("%.3f / %.2f (%.2f)", $5, $7, $6) }
    !(($1, $2) in seen) { seen[$1, $2] = 1; row[++rows] = $1 SUBSEP $2 }
    END {
      printf "%-12s %-12s %-24s %-24s %s\n", "log", "odometry", "alone", "icp-slam", "rbpf-slam"
      for (i = 1; i <= rows; ++i) {
        split(row[i], name, SUBSEP)
        printf "%-12s %-12s %-24s %-24s %s\n", name[1], name[2], cell[row[i], "alone"], cell[row[i], "icp-slam"], cell[row[i], "rbpf-slam"]
      }
    }' "$csv"
} > "$folder/stock_programs.txt"
cp "$csv" "$folder/stock_programs.csv"
