#!/bin/sh
# icp-slam.sh CONFIG LOG SCANS OUTPUT: runs MRPT's icp-slam in this folder; its path as a TUM trajectory.
set -eu
config=$1 log=$2 scans=$3 output=$4
icp-slam "$config" "$log"
# It writes `step x y yaw` at every frame and no stamps. A frame of comments may follow the last scan.
awk '
  FNR == NR { stamp[FNR] = $1; scans = FNR; next }
  FNR <= scans { printf "%s %.9f %.9f 0 0 0 %.9f %.9f\n", stamp[FNR], $2, $3, sin($4 / 2), cos($4 / 2) }
  END {
    if (FNR != scans && FNR != scans + 1) {
      print "icp-slam wrote " FNR " poses for " scans " scans" > "/dev/stderr"
      exit 1
    }
  }' "$scans" LOG_rasterslam_icp-slam/log_estimated_path.txt > "$output"
