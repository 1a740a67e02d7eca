#!/usr/bin/env python3
"""Several robots against one: times to 90 and 99 % over one robot's, with the true pose and with SLAM.

    benchmarks/exploration/robots.py [-p PROGRAM] [-n SEEDS] [-w WORLDS] [-S STRATEGY] [-m METHODS] [-R ROBOTS] [-j RUNS] [-a] [-o FOLDER]

Explores every world with every number of robots, method and seed (rasterslam explore --robots, 181 beams, all start beside each
other), and writes FOLDER/exploration_robots.csv (every run) and exploration_robots.txt (medians of the ratios of pairs of one world,
method and seed, with 95 % intervals of the bootstrap where there are enough of them). A world KIND:SEED is a generated
building. A run that never gets there is endlessly late. -a adds to the runs that FOLDER's table has.
"""
import argparse
import concurrent.futures
import csv
import json
import math
import os
import statistics
import subprocess
import tempfile

import ratio

WORLDS = "flat,pillar_hall,maze,office_loop,flat:11,office:12"
FEW = 5  # pairs, of which an interval would say nothing
KEYS = ["plan", "slam", "seed", "robots", "t90_s", "t99_s", "time_s", "coverage", "path_sum_m", "path_longest_m", "overlap",
        "wall_collisions", "robot_collisions", "gave_way", "map_wall_f1", "end"]


def plan_of(world, args, folder):
    """The name of a committed world, or the file of a building."""
    if ":" not in world:
        return world
    kind, seed = world.split(":")
    path = os.path.join(folder, f"{kind}_{seed}.yaml")
    subprocess.run([args.p, "world", "make", kind, "--seed", seed, "-q", "-o", path], check=True, stdout=subprocess.DEVNULL)
    return path


def explore(args, plan, slam, seed, robots, folder):
    output = os.path.join(folder, f"{os.path.basename(plan)}_{slam}_{seed}_{robots}")
    command = [args.p, "explore", plan, "--strategy", args.S, "--slam", slam, "--seed", str(seed), "--tables-only", "--duration", "1500",
               "--set", "lidar.beams=181", "--set", "exploration.give_up_s=600", "-q", "-o", output]
    subprocess.run(command + (["--robots", str(robots)] if robots > 1 else []), check=True, stdout=subprocess.DEVNULL)
    if robots == 1:
        with open(os.path.join(output, "runs.csv"), newline="", encoding="utf-8") as file:
            row = next(csv.DictReader(file))
        return {"plan": row["plan"], "slam": slam, "seed": seed, "robots": 1, "t90_s": row["t90_s"], "t99_s": row["t99_s"],
                "time_s": row["time_s"], "coverage": ratio.number(row["coverage_percent"]) / 100, "path_sum_m": row["path_m"],
                "path_longest_m": row["path_m"], "overlap": 0, "wall_collisions": row["collisions"], "robot_collisions": 0,
                "gave_way": 0, "map_wall_f1": row["wall_f1"], "end": row["end"]}
    with open(os.path.join(output, "exploration.json"), encoding="utf-8") as file:
        team = json.load(file)
    return dict(team, slam=slam)


def figure(row, key):
    value = row[key]
    return math.inf if value is None else ratio.number(str(value))


def over_one(rows, plan, slam, robots, key):
    """Of every seed the team's time over that of one robot."""
    single = {row["seed"]: figure(row, key) for row in rows
              if row["plan"] == plan and row["slam"] == slam and row["robots"] == 1}
    return [figure(row, key) / single[row["seed"]] for row in rows
            if row["plan"] == plan and row["slam"] == slam and row["robots"] == robots and math.isfinite(single[row["seed"]])]


def shown(values):
    if not values:
        return "one robot never got there"
    if len(values) < FEW:
        return f"{ratio.text(statistics.median(values))} ({len(values)} of {ratio.text(min(values))} to {ratio.text(max(values))})"
    low, high = ratio.interval(values)
    return f"{ratio.text(statistics.median(values))} [{ratio.text(low)}, {ratio.text(high)}]"


def report(rows, out):
    plans = list(dict.fromkeys(row["plan"] for row in rows))
    slams = list(dict.fromkeys(row["slam"] for row in rows))
    teams = sorted({row["robots"] for row in rows} - {1})
    for slam in slams:
        for robots in teams:
            print(f"\n{robots} robots with {slam}: time over that of one robot, median [95 %], of few pairs (how many of least to most); "
                  "medians of what it took", file=out)
            for plan in plans:
                some = [row for row in rows if row["plan"] == plan and row["slam"] == slam and row["robots"] == robots]
                if not some:
                    continue
                medians = [statistics.median(figure(row, key) for row in some)
                           for key in ("t99_s", "path_sum_m", "path_longest_m", "overlap")]
                print(f"  {plan:14} T90 {shown(over_one(rows, plan, slam, robots, 't90_s')):27} "
                      f"T99 {shown(over_one(rows, plan, slam, robots, 't99_s')):27} "
                      f"({ratio.text(medians[0], 0)} s, paths {medians[1]:.0f} m in all, {medians[2]:.0f} m the longest, "
                      f"seen twice {100 * medians[3]:.0f} %)", file=out)
            ratios = [value for plan in plans for value in over_one(rows, plan, slam, robots, "t99_s")]
            print(f"  all            T99 {shown(ratios)}", file=out)
    walls, between = (sum(figure(row, key) for row in rows) for key in ("wall_collisions", "robot_collisions"))
    print(f"\n{len(rows)} runs, {walls:.0f} collisions with walls, {between:.0f} between robots", file=out)


def main():
    parser = ratio.parser_of(__doc__, 5, WORLDS, "next_best_view")
    parser.add_argument("-m", default="truth,graph")
    parser.add_argument("-R", default="1,2,3")
    parser.add_argument("-a", action="store_true")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        plans = [plan_of(world, args, folder) for world in args.w.split(",")]
        cells = [(plan, slam, seed, int(robots)) for slam in args.m.split(",") for plan in plans for seed in range(1, args.n + 1)
                 for robots in args.R.split(",")]
        with concurrent.futures.ThreadPoolExecutor(args.j) as pool:
            rows = list(pool.map(lambda cell: explore(args, *cell, folder), cells))
    os.makedirs(args.o, exist_ok=True)
    path = os.path.join(args.o, "exploration_robots.csv")
    if args.a and os.path.exists(path):
        with open(path, newline="", encoding="utf-8") as file:
            rows = [dict(row, seed=int(row["seed"]), robots=int(row["robots"])) for row in csv.DictReader(file)] + rows
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, KEYS, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    with open(os.path.join(args.o, "exploration_robots.txt"), "w", encoding="utf-8") as file:
        added = " -a, rows of several calls" if args.a else f" -n {args.n} -w {args.w} -m {args.m} -R {args.R}"
        print(f"benchmarks/exploration/robots.py{added}; {args.S}, all robots start beside each other", file=file)
        report(rows, file)


if __name__ == "__main__":
    main()
