#!/bin/sh
# start.sh LOG SCANS OUTPUT: runs a program on LOG (a CARMEN log; `log = action` in the .ini gives an MRPT rawlog) in an empty folder,
# and leaves OUTPUT: `time x y z qx qy qz qw` per line. SCANS has a line `stamp x y yaw` per scan: the wheels' dead reckoning.
set -eu
log=$1 scans=$2 output=$3

# Edit here: start your program, and let it write its poses to poses.txt, `stamp x y yaw` per line. This one believes the wheels.
test -s "$log"
cp "$scans" poses.txt

# Its path as a trajectory. Scans that it gives no pose are left out, and filled in from the odometry.
awk '{ printf "%s %s %s 0 0 0 %.9f %.9f\n", $1, $2, $3, sin($4 / 2), cos($4 / 2) }' poses.txt > "$output"
