#!/bin/sh
# rbpf-slam.sh CONFIG LOG SCANS SEED OUTPUT: runs MRPT's rbpf-slam in this folder; its path as a TUM trajectory.
set -eu
config=$1 log=$2 scans=$3 seed=$4 output=$5
sed "s/^RANDOM_SEED *=.*/RANDOM_SEED = $seed/" "$config" > rbpf-slam.ini
rbpf-slam rbpf-slam.ini "$log"
# `step x y z yaw pitch roll stamp` at every frame, the stamp being any that the frame or its action has.
awk -v program=rbpf-slam -v x=2 -v y=3 -v yaw=5 -f "$(dirname "$0")/frames_to_tum.awk" \
  "$scans" LOG_rasterslam_rbpf-slam/log_estimated_path.txt > "$output"
