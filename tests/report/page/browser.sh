#!/bin/sh
# The page in headless Chromium: browser.sh RASTERSLAM. Exit code 77: node_modules or Chromium are not here.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
modules=$here/../../../libslam/report/page/node_modules
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if ! command -v node >/dev/null || [ ! -d "$modules" ]; then
  echo "skipped: run 'npm ci --ignore-scripts' in libslam/report/page first"
  exit 77
fi
if [ -z "$chromium" ]; then
  echo "skipped: Chromium is not installed (apt-get install chromium)"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"$1" compare flat -o comparison --methods naive_wheel,naive_flow,graph,particles,icp --set simulation.duration_s=20 --quiet
"$1" explore flat -o explorations --strategy nearest_frontier,wall_follow --slam truth --duration 15 --set lidar.beams=181 --quiet
"$1" explore flat -o exploration --strategy nearest_frontier --slam graph --duration 15 --quiet
"$1" stress flat -o stress --vary lidar.fov_deg=60..360:3 --methods naive_wheel,naive_flow --seeds 2 --duration 10 --quiet
"$1" navigate flat -o drives --goal "7 2" --method bug2,tangent --quiet || [ $? = 4 ]
for name in comparison explorations exploration stress drives; do
  "$1" report "$name" -o "$name.html" --quiet
done
node "$here/browser.mjs" "$folder" "$chromium"
