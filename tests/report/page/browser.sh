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
"$1" compare flat -o "$folder/out" --methods naive_wheel,naive_flow,graph,particles,icp --set simulation.duration_s=20 \
  --quiet >"$folder/table.txt"
"$1" report "$folder/out" -o "$folder/report.html" --quiet
node "$here/browser.mjs" "$folder/report.html" "$folder/out" "$chromium"
