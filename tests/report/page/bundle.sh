#!/bin/sh
# The checked-in bundle is what the sources give. Exit code 77: `npm ci` was not run in libslam/report/page.
set -eu
cd "$(dirname "$0")/../../../libslam/report/page"
if ! command -v npm >/dev/null || [ ! -d node_modules ]; then
  echo "skipped: run 'npm ci --ignore-scripts' in libslam/report/page first"
  exit 77
fi
npm run --silent check
