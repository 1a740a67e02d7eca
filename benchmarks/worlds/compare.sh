#!/bin/sh
# MRPT's tuned methods and ours in the five committed worlds, on logs that none of them was tuned on.
#
#   benchmarks/worlds/compare.sh [-s SEEDS] [-t SECONDS] [-m METHODS] [-w WORK] [-o FOLDER]
#
# Writes FOLDER/worlds.csv (one row per world, seed and method: every score, ms per scan, memory) and worlds.txt (medians
# over worlds and seeds). WORK keeps the runs; an interrupted sweep goes on where it was.
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
command_line="benchmarks/worlds/compare.sh $*"
program=$root/build/release/apps/rasterslam
worlds="flat office_loop corridor maze pillar_hall"
seeds="11 12 13"
seconds=300
methods=icp_exact,rbpf_exact,particles,graph
work=
folder=$root/benchmarks/results
while getopts s:t:m:w:o: option; do
  case $option in
    s) seeds=$OPTARG ;;
    t) seconds=$OPTARG ;;
    m) methods=$OPTARG ;;
    w) work=$OPTARG ;;
    o) folder=$OPTARG ;;
    *) sed -n '4s/^# *//p' "$0" >&2; exit 2 ;;
  esac
done
if [ -z "$work" ]; then
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work" "$folder"
rm -f "$work/worlds.csv"
for world in $worlds; do
  for seed in $seeds; do
    out=$work/${world}_$seed
    # Exit code 4: a method failed; its row says so.
    status=0
    "$program" compare "$world" --seed "$seed" --duration "$seconds" --methods "$methods" -o "$out" --resume -q \
      > /dev/null || status=$?
    if [ "$status" -ne 0 ] && [ "$status" -ne 4 ]; then exit "$status"; fi
    tr -d '\r' < "$out/cost.csv" > "$work/cost.csv"
    tr -d '\r' < "$out/scores.csv" | awk -F, -v OFS=, -v world="$world" -v seed="$seed" '
      NR == FNR { cost[$1] = $2 OFS $5; next }
      FNR == 1 { if (first) print "world", "seed", $0, "ms_per_scan", "peak_memory_mb"; next }
      { print world, seed, $0, cost[$1] }
    ' first="$([ -f "$work/worlds.csv" ] || echo 1)" "$work/cost.csv" - >> "$work/worlds.csv"
  done
done
cp "$work/worlds.csv" "$folder/worlds.csv"
{
  echo "Made by: $command_line"
  echo "Version: $("$program" --version)"
  echo "Medians over the worlds ($worlds) and seeds ($seeds), $seconds s of driving each; worst in brackets"
  echo
  awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    {
      if (!($3 in count)) order[++methods] = $3
      n = ++count[$3]
      for (k = 1; k <= split("ate_rmse_m ate_final_m wall_f1 free_iou ms_per_scan", keys, " "); ++k)
        value[$3, keys[k], n] = $(column[keys[k]]) + 0
    }
    function sorted(method, key, n,   i, j, x) {
      for (i = 1; i <= n; ++i) list[i] = value[method, key, i]
      for (i = 2; i <= n; ++i) { x = list[i]; for (j = i - 1; j > 0 && list[j] > x; --j) list[j + 1] = list[j]; list[j + 1] = x }
    }
    function median(n) { return n % 2 ? list[(n + 1) / 2] : (list[n / 2] + list[n / 2 + 1]) / 2 }
    END {
      printf "%-12s %18s %18s %8s %9s %8s\n", "method", "ATE online m", "ATE final m", "wall F1", "free IoU", "ms/scan"
      for (m = 1; m <= methods; ++m) {
        name = order[m]; n = count[name]
        sorted(name, "ate_rmse_m", n); a = sprintf("%.4f (%.4f)", median(n), list[n])
        sorted(name, "ate_final_m", n); f = sprintf("%.4f (%.4f)", median(n), list[n])
        sorted(name, "wall_f1", n); w = median(n)
        sorted(name, "free_iou", n); i = median(n)
        sorted(name, "ms_per_scan", n)
        printf "%-12s %18s %18s %8.3f %9.3f %8.2f\n", name, a, f, w, i, median(n)
      }
    }' "$folder/worlds.csv"
} > "$folder/worlds.txt"
