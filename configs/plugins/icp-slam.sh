#!/bin/sh
# icp-slam.sh CONFIG LOG SCANS OUTPUT: runs MRPT's icp-slam in this folder; its path as a TUM trajectory.
set -eu
config=$1 log=$2 scans=$3 output=$4
icp-slam "$config" "$log"
# It writes `step x y yaw` at every frame and no stamps. It passes over a first frame that no action stands before; a
# frame of comments may follow the last scan.
awk '
  FNR == NR { stamp[FNR] = $1; scans = FNR; next }
  { x[FNR] = $2; y[FNR] = $3; yaw[FNR] = $4; poses = FNR }
  END {
    if (poses < scans - 1 || poses > scans + 1) {
      print "icp-slam wrote " poses + 0 " poses for " scans " scans" > "/dev/stderr"
      exit 1
    }
    skipped = poses < scans
    for (i = 1; i <= poses && i + skipped <= scans; ++i)
      printf "%s %.9f %.9f 0 0 0 %.9f %.9f\n", stamp[i + skipped], x[i], y[i], sin(yaw[i] / 2), cos(yaw[i] / 2)
  }' "$scans" LOG_rasterslam_icp-slam/log_estimated_path.txt > "$output"
