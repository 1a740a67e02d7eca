#!/usr/bin/env bash
# Makes the README's pictures and the results that it quotes: ./.github/pictures/make.sh (after ./bootstrap.sh build)
set -euo pipefail
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
build/release/apps/rasterslam demo --quiet -o "$out/demo"
cp "$out/demo/simulated/maps.png" .github/pictures/maps.png
build/release/apps/rasterslam plot errors "$out/demo/simulated" --methods graph,particles,icp,rbpf_exact -o .github/pictures/errors.png --width 170mm --overwrite
build/release/apps/rasterslam view explore office_loop --strategy next_best_view --screenshot .github/pictures/view.png --at 120 --overwrite
# The player, where Chromium and the page's tools are at hand: ./bootstrap.sh page
chromium=$(command -v chromium || true)
if [ -n "$chromium" ] && [ -d libslam/report/page/node_modules ]; then
  node .github/pictures/player.mjs "$out/demo/simulated/report.html" .github/pictures/player.png 300 "$chromium"
fi
for kind in flat office hall hospital cave; do
  build/release/apps/rasterslam world make "$kind" --size 60x42 --seed 3 -o "$out/$kind.yaml" >"$out/made.txt"
done
build/release/apps/rasterslam plot plans "$out"/{flat,office,hall,hospital,cave}.yaml -o .github/pictures/buildings.png --overwrite
# What has changed in the flat from May to June.
drive=(simulate flat --duration 150 --strategy wall_follow -q)
build/release/apps/rasterslam "${drive[@]}" -o "$out/may.rawlog" --seed 2
build/release/apps/rasterslam "${drive[@]}" -o "$out/june.rawlog" --seed 7 --start 9.5,8,180 --set living.visit=2
for month in may june; do build/release/apps/rasterslam run graph "$out/$month.rawlog" -o "$out/$month" -q >"$out/made.txt"; done
build/release/apps/rasterslam diff "$out/may" "$out/june" -o "$out/changes" -q >"$out/made.txt"
cp "$out/changes/changes.png" .github/pictures/changes.png
# Killian Court, where KILLIAN names the log: rasterslam data mit-killian
killian=${KILLIAN:-mit-killian.clf}
if [ -f "$killian" ]; then
  build/release/apps/rasterslam compare "$killian" --methods graph,particles -o "$out/killian" -q
  cp "$out/killian/maps.png" .github/pictures/killian.png
fi
for part in simulated original real; do
  mkdir -p "benchmarks/results/demo/$part"
  cp "$out/demo/$part"/{scores.csv,scores.txt,cost.csv} "benchmarks/results/demo/$part/"
done
{
  echo "Made by: .github/pictures/make.sh (rasterslam demo, seed 1)"
  echo "Machine: $(grep -m1 'model name' /proc/cpuinfo | cut -d: -f2- | sed 's/^ //'), $(nproc) cores; Debian $(cat /etc/debian_version); $(g++ --version | head -1)"
} >benchmarks/results/demo/README.txt
