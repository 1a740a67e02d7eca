#!/usr/bin/env python3
"""Driving by the local obstacle map, by the navigators' own short memory, and by the newest scan alone.

  benchmarks/obstacles/memory.py [-n SEEDS] [-j JOBS] [-p PROGRAM] [-o FOLDER] [-k SCRATCH]

Worlds with eight people. Explorations (strategies in STRATEGIES, true pose) and drives to goals (methods in METHODS,
pose from wheels without error), with the default lidar (270 degrees) and with one that sees as little as a camera does (60
degrees, nothing nearer than 0.3 m). The local map with zones of several sizes: its length is its memory; and with
unseen = looked_at. Intervals are those of 95 %: Wilson's of a share, by the bootstrap over runs of a rate.
Writes FOLDER/obstacle_memory.csv (a row per task, sensor and memory) and FOLDER/obstacle_memory.txt (for people).
With SCRATCH the single tables stay there, and those that are there are not made again.
"""
import argparse
import concurrent.futures
import csv
import math
import os
import pathlib
import random
import resource
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
WORLDS = ["flat", "office_loop", "pillar_hall"]
STRATEGIES = ["quadrant"]
METHODS = ["bug2", "tangent"]
EXPLORE_S, NAVIGATE_S = 150, 200
EXACT_WHEELS = [f"odometry.{key}" for key in ("alpha1=0", "alpha2=0", "alpha3=0", "alpha4=0", "scale=1",
                                              "heading_bias_degpm=0")]
GOALS = {  # start and goal, across the world
    "flat": [("1.6 1.6 0", "11 7"), ("11 7 180", "1.6 1.6")],
    "office_loop": [("2 2 0", "22 14"), ("22 14 180", "2 2")],
    "pillar_hall": [("3 3 0", "17 13"), ("17 13 180", "3 3")],
}
SENSORS = {
    "270 deg": ["lidar.beams=181"],
    "60 deg": ["lidar.fov_deg=60", "lidar.beams=121", "lidar.min_range_m=0.3", "lidar.max_range_m=6"],
}
ZONES = [(1.5, 1, 0.5), (5, 4, 2), (10, 8, 8)]  # width, front, rear; the second is the default
MEMORIES = ([("none", None, "free"), ("short", None, "free")] + [("local_map", zone, "free") for zone in ZONES]
            + [("local_map", ZONES[1], "looked_at")])


def label(memory):
    kind, zone, unseen = memory
    name = kind if zone is None else "map {:g} x {:g}+{:g} m".format(*zone)
    return name if unseen == "free" else name + ", looks"


def settings(section, memory, sensor):
    kind, zone, unseen = memory
    values = [*SENSORS[sensor], "living.people=8", f"{section}.memory={kind}", f"{section}.unseen={unseen}"]
    if zone:
        values += [f"obstacles.{key}_m={value}" for key, value in zip(("width", "front", "rear"), zone)]
    if section == "navigate":
        values += EXACT_WHEELS
    return [word for value in values for word in ("--set", value)]


def run_command(command, codes, made):
    if made.exists():
        return
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode not in codes:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")


def explore(program, world, memory, sensor, seeds, output):
    run_command([program, "explore", world, "--strategy", ",".join(STRATEGIES), "--slam", "truth", "--seeds", str(seeds),
                 "--duration", str(EXPLORE_S), *settings("strategy", memory, sensor), "--tables-only", "-q", "--overwrite",
                 "-o", output], (0,), output / "runs.csv")
    with open(output / "runs.csv", newline="", encoding="utf-8") as file:
        return [{"task": "explore " + row["strategy"], "world": world, "sensor": sensor, "memory": label(memory),
                 "arrived": row["t90_s"] != "", "path_m": float(row["path_m"]), "time_s": float(row["time_s"]),
                 "path90_m": float(row["path90_m"]) if row["path90_m"] else None,
                 "coverage_percent": float(row["coverage_percent"]), "ratio": None,
                 "collisions": float(row["collisions"]), "near_misses": float(row["near_misses"])}
                for row in csv.DictReader(file)]


def navigate(program, world, memory, sensor, seeds, output):
    rows = []
    for i, (start, goal) in enumerate(GOALS[world]):
        for seed in range(1, seeds + 1):
            folder = output / f"{i}_{seed}"
            folder.parent.mkdir(exist_ok=True)
            run_command([program, "navigate", world, "--start", start, "--goal", goal, "--method", ",".join(METHODS),
                         "--slam", "odometry", "--seed", str(seed), *settings("navigate", memory, sensor),
                         "--set", f"navigate.time_limit_s={NAVIGATE_S}", "-q", "--overwrite", "-o", folder],
                        (0, 4), folder / "scores.csv")
            with open(folder / "scores.csv", newline="", encoding="utf-8") as file:
                rows += [{"task": "navigate " + row["method"], "world": world, "sensor": sensor, "memory": label(memory),
                          "arrived": row["result"] == "reached", "path_m": float(row["path_m"]),
                          "time_s": float(row["time_s"]), "path90_m": None, "coverage_percent": None,
                          "ratio": float(row["ratio"]) if row["ratio"] else None,
                          "collisions": float(row["collisions"]), "near_misses": None}
                         for row in csv.DictReader(file)]
    return rows


def mean(values, digits):
    known = [value for value in values if value is not None]
    return f"{statistics.mean(known):.{digits}f}" if known else ""


def wilson(count, runs):
    """Interval of 95 % of a share, as text in percent."""
    z, share = 1.96, count / runs
    middle = (share + z * z / (2 * runs)) / (1 + z * z / runs)
    half = z * math.sqrt(share * (1 - share) / runs + z * z / (4 * runs * runs)) / (1 + z * z / runs)
    return f"{100 * max(0, middle - half):.0f}..{100 * min(1, middle + half):.0f}"


def rate_interval(mine, draws=1000):
    """Interval of 95 % of collisions per 100 m: the runs drawn anew."""
    chance = random.Random(1)
    rates = []
    for _ in range(draws):
        drawn = chance.choices(mine, k=len(mine))
        path = sum(row["path_m"] for row in drawn)
        rates.append(100 * sum(row["collisions"] for row in drawn) / path if path > 0 else 0)
    rates.sort()
    return f"{rates[draws // 40]:.2f}..{rates[-1 - draws // 40]:.2f}"


def summaries(rows):
    keys = dict.fromkeys((row["task"], row["sensor"], row["memory"]) for row in rows)
    lines = []
    for task, sensor, memory in keys:
        mine = [row for row in rows if (row["task"], row["sensor"], row["memory"]) == (task, sensor, memory)]
        collided = sum(row["collisions"] > 0 for row in mine)
        arrived = sum(row["arrived"] for row in mine)
        path = sum(row["path_m"] for row in mine)
        lines.append({"task": task, "sensor": sensor, "memory": memory, "runs": len(mine),
                      "arrived": arrived, "arrived_95": wilson(arrived, len(mine)), "runs_with_collisions": collided,
                      "collisions_per_100m": f"{100 * sum(row['collisions'] for row in mine) / path:.2f}",
                      "collisions_95": rate_interval(mine),
                      "near_misses": mean([row["near_misses"] for row in mine], 1),
                      "path_m": mean([row["path_m"] for row in mine], 1),
                      "time_s": mean([row["time_s"] for row in mine], 0),
                      "path90_m": mean([row["path90_m"] for row in mine], 1),
                      "coverage_percent": mean([row["coverage_percent"] for row in mine], 1),
                      "ratio": mean([row["ratio"] for row in mine], 2)})
    return lines


def pooled(rows, word):
    """Over the tasks of one kind and all worlds."""
    return summaries([dict(row, task=word) for row in rows if row["task"].startswith(word)])


HEADS = {"task": "task", "sensor": "sensor", "memory": "memory", "runs": "runs", "arrived": "arrived",
         "arrived_95": "95 %", "runs_with_collisions": "collided", "collisions_per_100m": "collisions/100 m",
         "collisions_95": "95 % ", "near_misses": "near misses",
         "path_m": "path (m)", "time_s": "time (s)", "path90_m": "path to 90 % (m)", "coverage_percent": "explored %",
         "ratio": "path/shortest"}


def text_table(lines):
    columns = [key for key in HEADS if any(str(line[key]) for line in lines)]
    cells = [[HEADS[key] for key in columns]] + [[str(line[key]) or "-" for key in columns] for line in lines]
    widths = [max(len(line[i]) for line in cells) for i in range(len(columns))]
    return "\n".join("  ".join(cell.ljust(width) if i < 3 else cell.rjust(width)
                               for i, (cell, width) in enumerate(zip(line, widths))).rstrip() for line in cells)


def write(options, rows):
    lines = summaries(rows)
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True,
                            check=False).stdout.strip()
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(options.folder / "obstacle_memory.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, HEADS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(lines)
    parts = [
        f"Made by: benchmarks/obstacles/memory.py -n {options.seeds}\nCommit: {commit}\n"
        + ("" if options.scratch else f"CPU: {(spent.ru_utime + spent.ru_stime) / 60:.1f} minutes\n") + "\n"
        f"Worlds {', '.join(WORLDS)} with eight people; {options.seeds} seeds each; at most {EXPLORE_S} s (explore) and "
        f"{NAVIGATE_S} s (navigate).\nMemory: none, the newest scan alone; short, within 1.5 m outside of the angle of view; "
        "map W x F+R, the local obstacle map\nwith a zone W wide, F ahead and R behind; looks: floor that was not seen is looked at before it is driven on. Arrived: 90 % explored, or the goal "
        "reached. A collision may also be a person\nwho walks into the robot. Figures are means over the runs; path to 90 % "
        "and path/shortest (the detour) over those\nthat arrived.",
        "== All explorations\n\n" + text_table(pooled(rows, "explore")),
        "== All drives to a goal\n\n" + text_table(pooled(rows, "navigate")),
        "== By strategy and method\n\n" + text_table(lines)]
    (options.folder / "obstacle_memory.txt").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", dest="seeds", type=int, default=5)
    parser.add_argument("-j", dest="jobs", type=int, default=2)
    parser.add_argument("-p", dest="program", default=str(ROOT / "build/release/apps/rasterslam"))
    parser.add_argument("-o", dest="folder", type=pathlib.Path, default=ROOT / "benchmarks/results")
    parser.add_argument("-k", dest="scratch", type=pathlib.Path)
    options = parser.parse_args()
    os.nice(10)
    options.folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        scratch = options.scratch or pathlib.Path(temporary)
        scratch.mkdir(parents=True, exist_ok=True)
        tasks = [pool.submit(task, options.program, world, memory, sensor, options.seeds,
                             scratch / f"{task.__name__}_{world}_{i}_{sensor[:2]}")
                 for task in (explore, navigate) for sensor in SENSORS for i, memory in enumerate(MEMORIES)
                 for world in WORLDS]
        rows = [row for task in tasks for row in task.result()]
    write(options, rows)
    print(options.folder / "obstacle_memory.txt")


if __name__ == "__main__":
    main()
