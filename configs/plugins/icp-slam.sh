#!/bin/sh
# icp-slam.sh CONFIG LOG SCANS OUTPUT: runs MRPT's icp-slam in this folder; its path as a TUM trajectory.
set -eu
config=$1 log=$2 scans=$3 output=$4
icp-slam "$config" "$log"
# `step x y yaw` at every frame.
awk -v program=icp-slam -v x=2 -v y=3 -v yaw=4 -f "$(dirname "$0")/frames_to_tum.awk" \
  "$scans" LOG_rasterslam_icp-slam/log_estimated_path.txt > "$output"
