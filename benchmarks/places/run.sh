#!/bin/sh
# graph, with its defaults, on real logs of other places than offices, against reference paths of another SLAM:
#   benchmarks/places/run.sh PROGRAM FOLDER_WITH_LOGS > benchmarks/results/places.txt
# FOLDER_WITH_LOGS has NAME.clf.xz and NAME.reference.tum of each. The wheels' path stands beside it.
set -eu
program=$1
logs=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo "Made by benchmarks/places/run.sh, $("$program" --version)."
for name in fhw acapulco freiburg-campus; do
  echo
  echo "## $name"
  "$program" compare "$logs/$name.clf.xz" --truth "$logs/$name.reference.tum" --methods naive_wheel,graph -o "$work/$name" |
    sed "s|$work/||"
  echo "lost and recovered (journal): $(cut -d, -f3 "$work/$name/graph/journal.csv" | grep -c -E '^(lost|recovered|apart)$' || true)"
done
