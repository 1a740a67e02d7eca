#!/bin/sh
# rbpf-slam.sh CONFIG LOG SEED OUTPUT: runs MRPT's rbpf-slam in this folder; its path as a TUM trajectory.
set -eu
config=$1 log=$2 seed=$3 output=$4
sed "s/^RANDOM_SEED *=.*/RANDOM_SEED = $seed/" "$config" > rbpf-slam.ini
rbpf-slam rbpf-slam.ini "$log"
# `step x y z yaw pitch roll stamp` at every frame.
awk '{ printf "%s %.9f %.9f 0 0 0 %.9f %.9f\n", $8, $2, $3, sin($5 / 2), cos($5 / 2) }' \
  LOG_rasterslam_rbpf-slam/log_estimated_path.txt > "$output"
