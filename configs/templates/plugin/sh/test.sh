#!/bin/sh
# test.sh: exit code 0 when start.sh makes a trajectory of two scans.
set -eu
folder=$(cd "$(dirname "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
printf '# a log\n' > log.clf
printf '1.5 0 0 0\n1.75 0.1 0 0.02\n' > scans.txt
sh "$folder/start.sh" log.clf scans.txt path.tum
test "$(wc -l < path.tum)" -eq 2
echo "@name@: ok"
