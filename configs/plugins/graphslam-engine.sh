#!/bin/sh
# graphslam-engine.sh CONFIG LOG SCANS OUTPUT: runs MRPT's graphslam-engine in this folder; its nodes as a TUM trajectory.
set -eu
config=$1 log=$2 scans=$3 output=$4
graphslam-engine --2d --disable-visuals -n CFixedIntervalsNRD -e CICPCriteriaERD -r "$log" -i "$config"
value() { sed -n "s/^$1 *= *\([0-9.]*\).*/\1/p" "$config"; }
# The graph has no stamps. A node is made where the odometry since the last one exceeds the interval, so the same rule
# over the scans finds them again; the first is where the robot starts.
awk -v far="$(value registration_max_distance)" -v turned_deg="$(value registration_max_angle)" '
  function wrapped(a) { return atan2(sin(a), cos(a)) }
  function noted() { node_stamp[nodes++] = $1; x = $2; y = $3; yaw = $4 }
  FNR == NR {
    if (FNR == 1) noted()
    turn = wrapped($4 - yaw); if (turn < 0) turn = -turn
    if (sqrt(($2 - x) ^ 2 + ($3 - y) ^ 2) > far || turn > turned_deg * atan2(0, -1) / 180) noted()
    next
  }
  $1 == "VERTEX_SE2" {
    printf "%s %.9f %.9f 0 0 0 %.9f %.9f\n", node_stamp[written++], $3, $4, sin($5 / 2), cos($5 / 2)
  }
  END {
    if (written != nodes) {
      print "graphslam-engine made " written + 0 " nodes, the odometry says " nodes > "/dev/stderr"
      exit 1
    }
  }' "$scans" graphslam_results/output_graph.graph > "$output"
