#!/usr/bin/env python3
"""Going back for loops (active SLAM), on and off: the map's error, the pose's error and the way, paired.

    benchmarks/exploration/revisit.py [-p PROGRAM] [-n SEEDS] [-w WORLDS] [-S STRATEGIES] [-m METHODS] [-d SECONDS] [-r PRICE]
                                      [-x KEY=VALUE,...] [-j THREADS] [-o FOLDER] [-t NAME]

Explores every world with every strategy, method and seed twice (rasterslam explore --set strategy.revisit=true and =false, 181
beams) and writes FOLDER/NAME.csv (every run) and NAME.txt: medians with SLAM in the loop (a ranking of the strategies
with each method), and the effect of revisit over pairs of the same world, strategy, method and seed with a sign test. Pairs in
which the robot never went back are equal by construction and counted apart. -x sets more for all runs, such as a worse lidar.

A world is a committed one, or KIND-SEED-SIZE for a building made for it, such as office-21-30x20 (rasterslam world make).
"""
import csv
import math
import os
import statistics
import subprocess
import tempfile

from ratio import interval, number, parser_of, planOf, sign_test

WORLDS = "flat,office_loop,office-31-40x30"
KEYS = ["plan", "strategy", "slam", "revisit", "seed", "path_m", "path90_m", "path99_m", "t90_s", "t99_s", "coverage_percent", "ate_rmse_m",
        "wall_f1", "wall_to_truth_p95_m", "revisits", "decisions", "redundant_percent", "collisions", "end"]
# Key, name, whether more is better.
FIGURES = [("ate_rmse_m", "ATE m", False), ("ate_per_m", "ATE per 100 m driven", False), ("wall_f1", "wall F1", True),
           ("wall_to_truth_p95_m", "95 % of walls within m", False), ("path_m", "path m", False)]


def explore(args, world, method, revisit, folder):
    output = os.path.join(folder, f"{world}_{method}_{revisit}")
    more = [word for setting in args.x.split(",") if setting for word in ("--set", setting)]
    subprocess.run(
        [args.p, "explore", planOf(args, world, folder), "--strategy", args.S, "--slam", method, "--tables-only", "--seeds",
         str(args.n), "--duration", str(args.d), "--set", "lidar.beams=181", "--set", f"strategy.revisit={revisit}",
         "--set", f"strategy.revisit_price={args.r}", "--threads", str(args.j), "-q", "-o", output] + more,
        check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(output, "runs.csv"), newline="", encoding="utf-8") as file:
        return [dict(row, plan=world, slam=method, revisit=revisit) for row in csv.DictReader(file)]


def figure(row, key):
    if key == "ate_per_m":
        return 100 * number(row["ate_rmse_m"]) / max(number(row["path_m"]), 1e-9)
    return number(row[key])


def shown(values):
    return "never" if math.isinf(statistics.median(values)) else f"{statistics.median(values):.3f}"


def rank(rows, args, out):
    print("\nStrategies with SLAM in the loop (without going back), medians over the seeds:\n", file=out)
    print(f"{'world':16} {'method':8} {'strategy':18} {'99 % m':>8} {'explored %':>10} {'path m':>8} {'ATE m':>7} {'wall F1':>7}", file=out)
    for world in args.w.split(","):
        for method in args.m.split(","):
            for strategy in args.S.split(","):
                of = [r for r in rows if (r["plan"], r["slam"], r["strategy"], r["revisit"]) == (world, method, strategy, "false")]
                if of:
                    cells = [shown([number(r[key]) for r in of]) for key in ("path99_m", "coverage_percent", "path_m", "ate_rmse_m", "wall_f1")]
                    print(f"{world:16} {method:8} {strategy:18} {cells[0]:>8} {cells[1]:>10} {cells[2]:>8} {cells[3]:>7} {cells[4]:>7}", file=out)


def effect(rows, method, world, out):
    off = {(r["plan"], r["strategy"], r["seed"]): r for r in rows if r["slam"] == method and r["revisit"] == "false"}
    pairs = [(r, off[r["plan"], r["strategy"], r["seed"]]) for r in rows
             if r["slam"] == method and r["revisit"] == "true" and world in (None, r["plan"])]
    went = [(on, without) for on, without in pairs if number(on["revisits"]) > 0]
    back = sum(number(on["revisits"]) for on, _ in went)
    print(f"\n{method}, {world or 'all worlds'}: went back in {len(went)} of {len(pairs)} runs, {back:.0f} times", file=out)
    if not went:
        return
    for key, name, more in FIGURES:
        both = [(figure(on, key), figure(without, key)) for on, without in went]
        better = sum(a > b if more else a < b for a, b in both)
        worse = sum(a < b if more else a > b for a, b in both)
        low, high = interval([a - b for a, b in both])
        print(f"  {name:24} with {shown([a for a, _ in both]):>8}, without {shown([b for _, b in both]):>8}; median difference "
              f"{statistics.median([a - b for a, b in both]):+.4f} [{low:+.4f}, {high:+.4f}]; better in {better} of {better + worse}, "
              f"p = {sign_test(better, worse):.3g}", file=out)


def main():
    parser = parser_of(__doc__, 5, WORLDS, "nearest_frontier,next_best_view")
    parser.add_argument("-m", default="graph,icp")
    parser.add_argument("-d", type=float, default=1500)
    parser.add_argument("-r", type=float, default=100)
    parser.add_argument("-x", default="")
    parser.add_argument("-t", default="exploration_revisit")
    args = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for world in args.w.split(","):
            for method in args.m.split(","):
                for revisit in ("true", "false"):
                    rows += explore(args, world, method, revisit, folder)
    os.makedirs(args.o, exist_ok=True)
    with open(os.path.join(args.o, args.t + ".csv"), "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, KEYS, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    with open(os.path.join(args.o, args.t + ".txt"), "w", encoding="utf-8") as file:
        print(f"Made by: benchmarks/exploration/revisit.py -n {args.n} -w {args.w} -S {args.S} -m {args.m} -d {args.d:g} -r {args.r:g}" + (f" -x {args.x}" if args.x else ""), file=file)
        rank(rows, args, file)
        for method in args.m.split(","):
            for world in args.w.split(",") + [None]:
                effect(rows, method, world, file)
        print(f"\n{len(rows)} runs, {sum(number(r['collisions']) for r in rows):.0f} collisions", file=file)


if __name__ == "__main__":
    main()
