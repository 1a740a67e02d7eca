#!/bin/bash
# Real logs, each cut into two halves: their maps merged, beside the map of the log as a whole.
#
#   benchmarks/merging/halves.sh [-p PROGRAM] LOGS
#
# LOGS holds intel, fr079 and mit-killian, each a folder with the log and its relations (rasterslam data). The second half
# begins at the robot, with no word of where that is in the first one's map. Error against relations of the Freiburg benchmark,
# across both halves: mean m / mean deg (max m). Then maps of different logs, which are to be refused.
# Prints benchmarks/results/merging_halves.txt.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
program=$root/build/release/apps/rasterslam
if [ "${1:-}" = -p ]; then program=$(realpath "$2"); shift 2; fi
[ $# -eq 1 ] || { sed -n '4s/^# *//p' "$0" >&2; exit 2; }
logs=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

error() {
  "$program" eval "$1" --relations "$2" --json |
    python3 -c 'import json, sys
row = json.load(sys.stdin)["relations"]["rows"][0]
print("%.4f / %.3f (%.2f)" % tuple(row[key] for key in ("translation_mean_m", "rotation_mean_deg", "translation_max_m")))'
}

echo "Made by: benchmarks/merging/halves.sh LOGS"
echo
printf '%-12s  %-24s  %-24s  %s\n' log 'halves, merged' 'whole' 'how the second half was found'
for log in intel:1345 fr079:530 mit-killian:3838; do
  name=${log%:*} middle_s=${log#*:}
  file=$(echo "$logs/$name"/*.clf*)
  "$program" cut "$file" --to "$middle_s" -o "$name-a.rawlog" -q
  "$program" cut "$file" --from "$middle_s" -o "$name-b.rawlog" -q
  for half in a b; do "$program" run graph "$name-$half.rawlog" -o "$name-$half" -q; done
  "$program" run graph "$file" -o "$name" -q
  "$program" merge "$name-a" "$name-b" -o "$name-both" -q
  cat "$name-both/$name-a.tum" "$name-both/$name-b.tum" | grep -v '^#' | sort -n -s -k1,1 > "$name-path.tum"
  found=$(python3 -c 'import json, sys
one = json.load(open(sys.argv[1]))["sessions"][1]
print("%d key frames over %.0f m fit, %.1f %% of what is shared contradicts" % (one["fitting_key_frames"], one["extent_m"], 100 * one["contradicted"]))' "$name-both/merge.json")
  printf '%-12s  %-24s  %-24s  %s\n' "$name" "$(error "$name-path.tum" "$logs/$name/$name.relations")" \
    "$(error "$name/trajectory_final.tum" "$logs/$name/$name.relations")" "$found"
done
echo
for pair in 'intel fr079' 'fr079 intel' 'mit-killian intel' 'fr079 mit-killian'; do
  read -r first second <<< "$pair"
  said=$("$program" merge "$first" "$second-a" -o wrong -q 2>&1) && said="WRONG: merged"
  printf '%s and %s: %s\n' "$first" "$second" "${said##*: }"
done
