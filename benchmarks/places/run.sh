#!/bin/sh
# graph and particles, with their defaults, on real logs of other places than offices, against reference paths of another SLAM:
#   benchmarks/places/run.sh PROGRAM FOLDER_WITH_LOGS > benchmarks/results/places.txt
# FOLDER_WITH_LOGS has NAME.clf.xz and NAME.reference.tum of each. The wheels' path stands beside them. Below each table: what becomes
# of the final error of graph when a parameter is changed by a few per cent, which tells a map that was kept from one that was lucky.
set -eu
program=$1
logs=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo "Made by benchmarks/places/run.sh, $("$program" --version)."
for name in fhw acapulco freiburg-campus; do
  echo
  echo "## $name"
  "$program" compare "$logs/$name.clf.xz" --truth "$logs/$name.reference.tum" --methods naive_wheel,particles,graph -o "$work/$name" |
    sed "s|$work/||"
  echo "lost and recovered (journal of graph): $(cut -d, -f3 "$work/$name/graph/journal.csv" | grep -c -E '^(lost|recovered|apart)$' || true)"
  echo
  echo "final ATE m and events of graph with a parameter changed by a few per cent:"
  for setting in point_spacing_m=0.051 point_spacing_m=0.049 blur_m=0.0205 blur_m=0.0195 odometry_xy_m=0.0205 cell_m=0.101; do
    "$program" run graph "$logs/$name.clf.xz" --set "graph.$setting" -o "$work/changed" --overwrite -q 2>/dev/null || true
    "$program" eval "$work/changed" --truth "$logs/$name.reference.tum" --json >"$work/changed.json" 2>/dev/null
    python3 - "$setting" "$work/changed.json" "$work/changed/journal.csv" <<'PYTHON'
import csv, json, sys
error = json.load(open(sys.argv[2]))["scores"]["rows"][0]["ate_final_m"]
events = [row["event"] for row in csv.DictReader(open(sys.argv[3]))]
print("  %-22s %.3f  lost %d, recovered %d, apart %d" % (
    sys.argv[1], error, *map(events.count, ("lost", "recovered", "apart"))))
PYTHON
  done
done
