#!/usr/bin/env python3
"""What a robot costs that drives on and on where it has been: time a scan over the drive, memory, key frames, error.

  benchmarks/scaling/long_drives.py [-p PROGRAM] [-w WORK] [-c CASES] [--hours H] [--visits N] [--threads N] [--set KEY=VALUE]

CASES: some of flat and office, or some of million and large.
flat, office: a flat and a generated office for so many hours, `graph` as it is and with every keyframe kept (graph.known_views=0). Then
visits of 15 minutes to an office whose furniture moves, each going on in the map of the one before. Nothing was tuned on the
offices; the flat was looked at. Prints benchmarks/results/scaling.txt and writes scaling.csv beside it.

million: 1,000,000 scans in an office of 100 x 100 m (56 hours, 89 km). large: 25,000 s (11 km) in an office of 500 x 500 m. `graph`
alone, as it is; together a quarter of an hour, 3 GB of disk. Prints benchmarks/results/scaling_large.txt, writes scaling_large.csv, and
draws the cost over the scans, scaling_large.png.

--set: of the method `graph`; then nothing is written, but the table is printed, as for scaling_refined.txt.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
RESULTS = ROOT / "benchmarks" / "results"
COLUMNS = ["case", "known_views", "scans", "second_tenth_ms", "last_tenth_ms", "p99_ms", "worst_ms", "key_frames", "memory_mb",
           "ate_final_m", "wall_f1"]
LARGE_COLUMNS = ["case", "scans", "path_m", "mean_ms", *COLUMNS[3:-2], "ate_online_m", *COLUMNS[-2:]]
LARGE = {"million": ("office, 100 x 100 m", "100x100", 200000), "large": ("office, 500 x 500 m", "500x500", 25000)}


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-p", "--program", default=ROOT / "build/release/apps/rasterslam")
    parser.add_argument("-w", "--work", help="folder for logs and runs that are kept, and not made again")
    parser.add_argument("-c", "--cases", default="flat,office", help="which of the long drives")
    parser.add_argument("--hours", type=float, default=3)
    parser.add_argument("--visits", type=int, default=10)
    parser.add_argument("--threads", type=int, default=1, help="of `run`; times are then of the one that takes the scans in")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as `run` takes it; repeat for more")
    arguments = parser.parse_args()
    arguments.program = str(pathlib.Path(arguments.program).resolve())
    cases = set(arguments.cases.split(","))
    if not (cases <= {"flat", "office"} or cases <= set(LARGE)):
        parser.error(f"--cases: found '{arguments.cases}', expected some of flat and office, or some of million and large")
    return arguments


def call(program, *words):
    return subprocess.run([program, *map(str, words)], check=True, capture_output=True, text=True).stdout


def start_of(truth):
    line = next(line for line in truth.read_text().splitlines() if not line.startswith("#"))
    x, y, qz, qw = (float(line.split()[i]) for i in (1, 2, 6, 7))
    return x, y, 2 * math.atan2(qz, qw)


def place_in(first, truth):
    """Where a log begins in the frame of the map that the first one made, as --start takes it."""
    (x0, y0, phi0), (x, y, phi) = start_of(first), start_of(truth)
    c, s = math.cos(phi0), math.sin(phi0)
    return f"{c * (x - x0) + s * (y - y0):.4f},{c * (y - y0) - s * (x - x0):.4f},{math.degrees(phi - phi0):.4f}"


def measure(program, run, truth, plan, case, known_views):
    times = sorted(float(row["cpu_ms"]) for row in csv.DictReader((run / "timing.csv").open()))
    in_order = [float(row["cpu_ms"]) for row in csv.DictReader((run / "timing.csv").open())]
    tenth = max(len(in_order) // 10, 1)
    score = json.loads(call(program, "eval", run, "--truth", truth, "--plan", plan, "--json"))
    accuracy, cost = (score[table]["rows"][0] for table in ("scores", "cost"))
    keyframes = sum(line.startswith("VERTEX_SE2") for line in (run / "graph.g2o").open())
    return {"case": case, "known_views": known_views, "scans": len(times), "path_m": accuracy["path_length_m"],
            "mean_ms": sum(times) / len(times), "second_tenth_ms": sum(in_order[tenth:2 * tenth]) / tenth,
            "last_tenth_ms": sum(in_order[-tenth:]) / tenth, "p99_ms": times[int(0.99 * len(times))], "worst_ms": times[-1],
            "key_frames": keyframes, "memory_mb": cost["peak_memory_mb"], "ate_online_m": accuracy["ate_rmse_m"],
            "ate_final_m": accuracy["ate_final_m"], "wall_f1": accuracy.get("wall_f1")}


def run_folder(arguments, folder, name):
    threads = [] if arguments.threads == 1 else [str(arguments.threads)]
    return folder / "-".join([name, *threads, *arguments.set])


def map_log(arguments, folder, log, name, known_views, *more):
    run = run_folder(arguments, folder, name)
    if not run.exists():
        keep = [] if known_views == "default" else ["--set", f"graph.known_views={known_views}"]
        changed = [word for setting in arguments.set for word in ("--set", setting)]
        call(arguments.program, "run", "graph", log, "-o", run, "-q", "--threads", arguments.threads, *more, *keep, *changed)
    return run


def long_drives(arguments, folder):
    program = arguments.program
    if not (folder / "office.yaml").exists():
        call(program, "world", "make", "office", "-o", folder / "office.yaml", "--size", "24x18", "--seed", 8, "-q")
    for case, plan in (("flat", "flat"), ("office", folder / "office.yaml")):
        if case not in arguments.cases.split(","):
            continue
        log = folder / f"{case}.rawlog"
        if not log.exists():
            call(program, "simulate", plan, "-o", log, "--seed", 11, "--duration", round(3600 * arguments.hours), "-q")
        for known_views in ("default", 0):
            run = map_log(arguments, folder, log, f"{case}-{known_views}", known_views)
            yield measure(program, run, log.with_suffix(".gt.tum"), plan, f"{case}, {arguments.hours:g} h", known_views)


def large_drives(arguments, folder):
    program = arguments.program
    for name, (case, size, duration_s) in LARGE.items():
        if name not in arguments.cases.split(","):
            continue
        plan, log = folder / f"{name}.yaml", folder / f"{name}.rawlog"
        if not log.exists():
            call(program, "world", "make", "office", "-o", plan, "--size", size, "--seed", 21, "-q")
            call(program, "simulate", plan, "-o", log, "--seed", 1, "--duration", duration_s, "-q")
        run = map_log(arguments, folder, log, f"{name}-graph", "default")
        yield measure(program, run, log.with_suffix(".gt.tum"), plan, case, "default")
        if name == "million" and not arguments.set:
            call(program, "plot", "cost", run, "-o", RESULTS / "scaling_large.png", "--width", "85mm", "--linear", "--overwrite", "-q")


def visits(arguments, folder):
    program = arguments.program
    for visit in range(1, arguments.visits + 1):
        log = folder / f"visit{visit}.rawlog"
        if not log.exists():
            call(program, "simulate", folder / "office.yaml", "-o", log, "--seed", visit, "--duration", 900, "-q", "--set",
                 f"living.visit={visit}", "--set", "living.furniture_share=0.33")
        truth = log.with_suffix(".gt.tum")
        as_it_was = log.with_suffix(".plan.yaml")  # where furniture was moved
        plan = as_it_was if as_it_was.exists() else folder / "office.yaml"
        for known_views in ("default", 0):
            before = ["--continue", run_folder(arguments, folder, f"visit{visit - 1}-{known_views}"), "--start",
                      place_in(folder / "visit1.gt.tum", truth)] if visit > 1 else []
            run = map_log(arguments, folder, log, f"visit{visit}-{known_views}", known_views, *before)
            yield measure(program, run, truth, plan, f"visit {visit}", known_views)


def shown(value):
    return "-" if value is None else f"{value:.3f}" if isinstance(value, float) else str(value)


def main():
    arguments = parse_arguments()
    is_large = arguments.cases.split(",")[0] in LARGE
    kinds, columns, name = ((large_drives,), LARGE_COLUMNS, "scaling_large") if is_large else (
        (long_drives, visits), COLUMNS, "scaling")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(arguments.work or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        cases = "" if arguments.cases == "flat,office" else f" -c {arguments.cases}"
        print(f"Made by: benchmarks/scaling/long_drives.py{cases}" + "".join(
            f" --{key} {getattr(arguments, key):g}" for key, usual in (("hours", 3), ("visits", 10), ("threads", 1))
            if getattr(arguments, key) != usual) + "".join(f" --set {setting}" for setting in arguments.set))
        print("\nCPU time a scan; MB of the whole program while it maps." + (
            "" if is_large else " known_views 0: every keyframe is kept.") + "\n")
        width = 19 if is_large else 15
        print("  ".join(f"{column:>{width}}" for column in columns))
        with open(os.devnull if arguments.set else RESULTS / f"{name}.csv", "w", newline="") as file:
            table = csv.DictWriter(file, columns, lineterminator="\n", extrasaction="ignore")
            table.writeheader()
            for kind in kinds:
                for row in kind(arguments, folder):
                    table.writerow({key: shown(value) for key, value in row.items()})
                    print("  ".join(f"{shown(row[column]):>{width}}" for column in columns))
                    sys.stdout.flush()


if __name__ == "__main__":
    main()
