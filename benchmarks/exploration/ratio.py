#!/usr/bin/env python3
"""Strategies against somebody who knows the plan: competitive ratios, their intervals, and paired tests.

    benchmarks/exploration/ratio.py [-p PROGRAM] [-n SEEDS] [-w WORLDS] [-S STRATEGIES] [-j THREADS] [-o FOLDER]
                                    [-t NAME] [-k CSV] [-z]

Explores every world with every strategy and seed by the true pose (rasterslam explore --slam truth --oracle, 181 beams) and
writes FOLDER/NAME.csv (every run; with -z packed: NAME.csv.xz) and NAME.txt (medians with 95 % intervals of the bootstrap; paired
sign tests of each strategy against nearest_frontier over worlds and seeds). A run that never gets there is endlessly late.

A world is a committed one, or KIND-SEED-SIZE for a building made for it, such as flat-21-16x12 (rasterslam world make).
With -k the rows of CSV for strategies that are not among STRATEGIES are taken over: runs are the same every time, so what has
not changed since need not be driven again.
"""
import argparse
import csv
import lzma
import math
import os
import random
import statistics
import subprocess
import tempfile

WORLDS = "corridor,flat,maze,office_loop,pillar_hall"
NAME = "exploration_ratio"
GOALS = {"90": 1.15, "99": 1.25}
STRATEGIES = "nearest_frontier,information_gain,next_best_view"


def number(text):
    """The figure of a cell; infinity where that share was never reached."""
    try:
        value = float(text)
    except ValueError:
        return math.inf
    return math.inf if math.isnan(value) else value


def opened(path, mode):
    """A table of runs, packed or not."""
    return (lzma.open if path.endswith(".xz") else open)(path, mode, newline="", encoding="utf-8")


def interval(values, draws=2000):
    """95 % of the bootstrap of the median; the same every time."""
    chance = random.Random(1)
    medians = sorted(statistics.median(chance.choices(values, k=len(values))) for _ in range(draws))
    return medians[int(0.025 * draws)], medians[int(0.975 * draws) - 1]


def sign_test(wins, losses):
    """Two-sided: how likely so uneven a split is by chance."""
    n = wins + losses
    if n == 0:
        return 1.0
    tail = sum(math.comb(n, k) for k in range(max(wins, losses), n + 1)) / 2**n
    return min(1.0, 2 * tail)


def planOf(args, world, folder):
    """The plan's name, or the file of a building made for it."""
    if "-" not in world:
        return world
    kind, seed, size = world.split("-")
    path = os.path.join(folder, world + ".yaml")
    subprocess.run([args.p, "world", "make", kind, "--seed", seed, "--size", size, "-q", "-o", path], check=True)
    return path


def explore(args, world, folder):
    output = os.path.join(folder, world)
    subprocess.run(
        [args.p, "explore", planOf(args, world, folder), "--strategy", args.S, "--slam", "truth", "--oracle", "--tables-only", "--seeds", str(args.n),
         "--duration", "1500", "--set", "lidar.beams=181", "--set", "exploration.give_up_s=600", "--threads", str(args.j),
         "-q", "-o", output],
        check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(output, "runs.csv"), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def text(value, decimals=2):
    return "never" if math.isinf(value) else f"{value:.{decimals}f}"


def report(rows, strategies, out):
    for share in ("90", "99"):
        print(f"\nPath to {share} % over that of the tour with the plan in hand: median [95 %] (least, most)\n", file=out)
        worlds = sorted({row["plan"] for row in rows})
        for world in worlds:
            of_world = [row for row in rows if row["plan"] == world]
            tour, least = number(of_world[0][f"oracle{share}_m"]), number(of_world[0][f"below{share}_m"])
            print(f"{world}: tour {text(tour, 1)} m, no path below {text(least, 1)} m", file=out)
            for strategy in strategies:
                values = [number(row[f"ratio{share}"]) for row in of_world if row["strategy"] == strategy]
                low, high = interval(values)
                print(f"  {strategy:18} {text(statistics.median(values)):>6} [{text(low)}, {text(high)}] "
                      f"({text(min(values))}, {text(max(values))})", file=out)
        first = {(row["plan"], row["seed"]): number(row[f"ratio{share}"]) for row in rows if row["strategy"] == strategies[0]}
        print(f"\nShorter than {strategies[0]} to {share} %, pairs of the same world and seed:", file=out)
        for strategy in strategies[1:]:
            pairs = [(number(row[f"ratio{share}"]), first[row["plan"], row["seed"]]) for row in rows
                     if row["strategy"] == strategy]
            wins, losses = sum(a < b for a, b in pairs), sum(a > b for a, b in pairs)
            print(f"  {strategy:18} {wins} of {wins + losses}, p = {sign_test(wins, losses):.3g} (sign test)", file=out)
        print(f"\nOf all runs, to {share} %: median (quartiles), nine of ten, largest; at most {GOALS[share]}, never\n", file=out)
        for strategy in strategies:
            values = sorted(number(row[f"ratio{share}"]) for row in rows if row["strategy"] == strategy)
            quarter, half, rest, most = (values[math.ceil(q * len(values)) - 1] for q in (0.25, 0.5, 0.75, 0.9))
            print(f"  {strategy:18} {text(half):>6} ({text(quarter)}, {text(rest)}) {text(most):>6} {text(values[-1]):>6}  "
                  f"{100 * sum(v <= GOALS[share] for v in values) / len(values):3.0f} % "
                  f"{100 * sum(math.isinf(v) for v in values) / len(values):3.0f} %", file=out)
    collisions = sum(number(row["collisions"]) for row in rows)
    print(f"\n{len(rows)} runs, {collisions:.0f} collisions", file=out)


def parser_of(description, seeds, worlds, strategies):
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-p", default=os.path.join(root, "build/release/apps/rasterslam"))
    parser.add_argument("-n", type=int, default=seeds)
    parser.add_argument("-w", default=worlds)
    parser.add_argument("-S", default=strategies)
    parser.add_argument("-j", type=int, default=2)
    parser.add_argument("-o", default=os.path.join(root, "benchmarks/results"))
    return parser


def main():
    parser = parser_of(__doc__, 10, WORLDS, STRATEGIES)
    parser.add_argument("-t", default=NAME)
    parser.add_argument("-k")
    parser.add_argument("-z", action="store_true")
    args = parser.parse_args()
    rows, strategies = [], args.S.split(",")
    if args.k:
        with opened(args.k, "rt") as file:
            rows = [row for row in csv.DictReader(file)
                    if row["strategy"] not in strategies and row["plan"] in args.w.split(",")]
        strategies = list(dict.fromkeys(row["strategy"] for row in rows)) + strategies
    with tempfile.TemporaryDirectory() as folder:
        for world in args.w.split(","):
            rows += explore(args, world, folder)
    keys = ["plan", "strategy", "seed", "path90_m", "path99_m", "oracle90_m", "oracle99_m", "below90_m", "below99_m", "ratio90",
            "ratio99", "t90_s", "t99_s", "coverage_percent", "path_m", "redundant_percent", "collisions", "end"]
    os.makedirs(args.o, exist_ok=True)
    with opened(os.path.join(args.o, args.t + (".csv.xz" if args.z else ".csv")), "wt") as file:
        table = csv.DictWriter(file, keys, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    with open(os.path.join(args.o, args.t + ".txt"), "w", encoding="utf-8") as file:
        packed, name = " -z" if args.z else "", "" if args.t == NAME else f" -t {args.t}"
        print(f"benchmarks/exploration/ratio.py -n {args.n} -w {args.w} -S {','.join(strategies)}{name}{packed}", file=file)
        report(rows, strategies, file)


if __name__ == "__main__":
    main()
