#!/usr/bin/env python3
"""What graph makes of a spinning lidar and nothing else: no odometry, and every sweep takes the whole time between two scans.

  benchmarks/spinning/without_odometry.py [-p PROGRAM] [-n SEEDS] [-s FIRST]

Drives of 90 s through committed worlds with rplidar_a1 and rplidar_a2, their odometry dropped; as the scans are (method.deskew=false),
and with the motion found with the pose. Prints benchmarks/results/without_odometry.txt. Three minutes.
"""
import argparse
import json
import math
import pathlib
import statistics
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
WORLDS = ["flat", "pillar_hall", "maze", "office_loop"]
LIDARS = ["rplidar_a1", "rplidar_a2"]
VARIANTS = {"as they are": ["--set", "method.deskew=false"], "set right": []}


def call(program, *words):
    return subprocess.run([program, *map(str, words)], check=True, capture_output=True, text=True).stdout


def scores_of(program, world, lidar, seed, work):
    """Final position (m) and heading (degrees) error and the share of poses in the 95 % ellipsoids, by variant."""
    log, stream, scans = (work / f"{name}.rawlog" for name in ("log", "stream", "scans"))
    call(program, "simulate", world, "--lidar", lidar, "--duration", 90, "--seed", seed, "-o", log, "--overwrite", "-q")
    call(program, "convert", log, stream, "--form", "observation", "--overwrite", "-q")
    call(program, "filter", stream, "--drop-label", "ODOMETRY", "-o", scans, "--overwrite", "-q")
    scores = {}
    for variant, settings in VARIANTS.items():
        call(program, "run", "graph", scans, "-o", work / "run", "--overwrite", "-q", *settings)
        row = json.loads(call(program, "eval", work / "run", "--truth", work / "log.gt.tum", "--json"))["scores"]["rows"][-1]
        scores[variant] = (row["ate_final_m"], row["heading_rmse_deg"], row["within_95_share_final"])
    return scores


def geometric_mean(values):
    return math.exp(statistics.fmean(math.log(value) for value in values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-p", "--program", default=ROOT / "build/release/apps/rasterslam")
    parser.add_argument("-n", "--seeds", type=int, default=3)
    parser.add_argument("-s", "--first", type=int, default=11)
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    print(f"Made by: benchmarks/spinning/without_odometry.py -n {arguments.seeds} -s {arguments.first}\n")
    print("lidar       scans        drives  final m  largest  heading deg  in 95 % final")
    with tempfile.TemporaryDirectory() as folder:
        for lidar in LIDARS:
            drives = [scores_of(program, world, lidar, seed, pathlib.Path(folder)) for world in WORLDS
                      for seed in range(arguments.first, arguments.first + arguments.seeds)]
            for variant in VARIANTS:
                final, heading, inside = zip(*(drive[variant] for drive in drives))
                print(f"{lidar:10}  {variant:11}  {len(drives):6}  {geometric_mean(final):7.4f}  {max(final):7.3f}  "
                      f"{geometric_mean(heading):11.3f}  {statistics.fmean(inside):13.2f}", flush=True)
    print("\nGeometric means over the drives; the share of poses in their ellipsoids is the mean.")


if __name__ == "__main__":
    main()
