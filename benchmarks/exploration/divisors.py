#!/usr/bin/env python3
"""Where the divisor u of the longest ray and the quadrants pay: a study with the true pose, without SLAM.

  benchmarks/exploration/divisors.py [-n SEEDS] [-d SECONDS] [-j THREADS] [-w WORLDS] [-p PROGRAM] [-o FOLDER]
                                        [-k SCRATCH]

longest_ray and quadrant, the drive (longest ray / u) with u fixed and with u uniform in ranges (the founding one is
0.1 to 2), in the committed worlds and in generated ones. Writes FOLDER/divisors.csv (a row per world, strategy and
u: medians over the seeds) and FOLDER/divisors.txt (for people). A scan has 181 beams, a run without new area for
ten minutes ends, as in sweep.sh. With SCRATCH the single tables stay there, and those that are there are not made again.
"""
import argparse
import csv
import math
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
COMMITTED = ["corridor", "flat", "maze", "office_loop", "pillar_hall"]
# kind, size, seed: the name in the tables is the kind's with the seed.
GENERATED = [("flat", "14x10", 3), ("office", "18x12", 4), ("hospital", "24x16", 5), ("cave", "16x12", 6)]
STRATEGIES = ["longest_ray", "quadrant"]
DIVISORS = [(0.1, 2), (0.5, 2), (1, 4), (0.5, 0.5), (1, 1), (2, 2), (4, 4)]
FOUNDING = DIVISORS[0]
FIGURES = ["t90_s", "path90_m", "t99_s", "path99_m", "coverage_percent", "redundant_percent", "path_m", "near_misses"]


def label(divisor):
    low, high = divisor
    return f"{low:g}" if low == high else f"{low:g}..{high:g}"


def middle(values, missing=math.inf):
    """Median of values of which None ranks as worse than any; None where that is the middle."""
    found = statistics.median([missing if value is None else value for value in values])
    return None if math.isinf(found) else found


def number(text):
    return float(text) if text else None


def make_worlds(program, wanted, folder):
    worlds = [(name, name) for name in COMMITTED]
    for kind, size, seed in GENERATED:
        plan = folder / f"{kind}_{seed}.yaml"
        subprocess.run([program, "world", "make", kind, "--size", size, "--seed", str(seed), "-q", "--overwrite", "-o",
                        plan], check=True, stdout=subprocess.DEVNULL)
        worlds.append((f"{kind}_{seed}", str(plan)))
    return [world for world in worlds if not wanted or world[0] in wanted.split(",")]


def explore(program, plan, divisor, options, output):
    """Every run of both strategies; a method cannot fail, there is none."""
    if not (output / "runs.csv").exists():
        run_explore(program, plan, divisor, options, output)
    with open(output / "runs.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def run_explore(program, plan, divisor, options, output):
    command = [program, "explore", plan, "--strategy", ",".join(STRATEGIES), "--slam", "truth",
               "--seeds", str(options.seeds), "--duration", f"{options.duration:g}", "--threads", str(options.threads),
               "--set", "lidar.beams=181", "--set", "exploration.give_up_s=600",
               "--set", f"strategy.divisor_min={divisor[0]}", "--set", f"strategy.divisor_max={divisor[1]}",
               "--tables-only", "-q", "--overwrite", "-o", str(output)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def summary(world, strategy, divisor, runs):
    mine = [run for run in runs if run["strategy"] == strategy]
    row = {"world": world, "strategy": strategy, "u": label(divisor), "runs": len(mine),
           "reached90": sum(run["t90_s"] != "" for run in mine),
           "reached99": sum(run["t99_s"] != "" for run in mine),
           "collisions": sum(int(float(run["collisions"])) for run in mine)}
    row.update({key: middle([number(run[key]) for run in mine]) for key in FIGURES})
    return row


def text_table(head, lines):
    cells = [head, *lines]
    widths = [max(len(line[i]) for line in cells) for i in range(len(head))]
    return "\n".join("  ".join(cell.ljust(width) if i == 0 else cell.rjust(width)
                               for i, (cell, width) in enumerate(zip(line, widths))).rstrip() for line in cells)


def pair_table(found, worlds, key):
    """A cell: longest_ray / quadrant."""
    def cell(world, divisor):
        values = [found[world, strategy, label(divisor)][key] for strategy in STRATEGIES]
        return " / ".join("-" if value is None else f"{value:.0f}" for value in values)
    return text_table(["world", *("u " + label(divisor) for divisor in DIVISORS)],
                      [[world, *(cell(world, divisor) for divisor in DIVISORS)] for world in worlds])


def ratio_line(pairs):
    """How often `one` is the smaller, and the geometric mean of one / other where both arrived."""
    both = [(one, other) for one, other in pairs if one is not None and other is not None]
    only_one = sum(one is not None and other is None for one, other in pairs)
    only_other = sum(one is None and other is not None for one, other in pairs)
    won = sum(one < other for one, other in both) + only_one
    ratio = math.exp(statistics.mean(math.log(one / other) for one, other in both)) if both else math.nan
    return f"{won} of {len(both) + only_one + only_other}", f"{ratio:.2f}"


def verdicts(found, worlds):
    def values(strategy, divisor, key):
        return [found[world, strategy, label(divisor)][key] for world in worlds]

    lines = []
    for divisor in DIVISORS:
        line = [label(divisor)]
        for key in ("path90_m", "t90_s"):
            line += ratio_line(zip(values("quadrant", divisor, key), values("longest_ray", divisor, key)))
        for strategy in STRATEGIES:
            line += ratio_line(zip(values(strategy, divisor, "path90_m"), values(strategy, FOUNDING, "path90_m")))
        lines.append(line)
    return text_table(["u", "quadrant shorter", "path ratio", "quadrant sooner", "time ratio",
                       "longest_ray: better", "ratio", "quadrant: better", "ratio"], lines)


def totals(found, worlds):
    lines = []
    for divisor in DIVISORS:
        for strategy in STRATEGIES:
            cells = [found[world, strategy, label(divisor)] for world in worlds]
            runs = sum(cell["runs"] for cell in cells)
            lines.append([f"u {label(divisor)} {strategy}", str(runs),
                          f"{100 * sum(cell['reached90'] for cell in cells) / runs:.0f}",
                          f"{100 * sum(cell['reached99'] for cell in cells) / runs:.0f}",
                          f"{statistics.mean(cell['coverage_percent'] for cell in cells):.1f}",
                          f"{statistics.mean(cell['redundant_percent'] for cell in cells):.1f}",
                          f"{sum(cell['near_misses'] for cell in cells):.0f}",
                          str(sum(cell["collisions"] for cell in cells))])
    return text_table(["", "runs", "% reach 90", "% reach 99", "coverage %", "redundant %", "near misses", "collisions"],
                      lines)


def cpu_minutes():
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (spent.ru_utime + spent.ru_stime) / 60


def write(options, rows, worlds):
    found = {(row["world"], row["strategy"], row["u"]): row for row in rows}
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True,
                            check=False).stdout.strip()
    parts = [
        f"Made by: benchmarks/exploration/divisors.py -n {options.seeds} -d {options.duration:g}"
        f"{' -w ' + options.worlds if options.worlds else ''}\nCommit: {commit}\n"
        + ("" if options.scratch else f"CPU: {cpu_minutes():.1f} minutes\n") + "\n"
        f"The drive is (longest ray / u). Medians of {options.seeds} seeds, true pose, {options.duration:g} s at most; a dash "
        "where fewer than half\nof the runs got there. Generated worlds: "
        + (", ".join(f"{kind}_{seed} ({size} m)" for kind, size, seed in GENERATED if f"{kind}_{seed}" in worlds) or "none")
        + ".",
        "== Path to 90 % explored (m), longest_ray / quadrant\n\n" + pair_table(found, worlds, "path90_m"),
        "== Time to 90 % explored (s), longest_ray / quadrant\n\n" + pair_table(found, worlds, "t90_s"),
        "== Path to 99 % explored (m), longest_ray / quadrant\n\n" + pair_table(found, worlds, "path99_m"),
        "== Time to 99 % explored (s), longest_ray / quadrant\n\n" + pair_table(found, worlds, "t99_s"),
        "== Explored in the end (%), longest_ray / quadrant\n\n" + pair_table(found, worlds, "coverage_percent"),
        "== Redundant travel (% of the path), longest_ray / quadrant\n\n" + pair_table(found, worlds, "redundant_percent"),
        "== All worlds\n\n" + totals(found, worlds),
        "== What pays, by the medians to 90 %\n\nquadrant against longest_ray at the same u (worlds in which its path is "
        "shorter, geometric mean of the ratio of the\npaths where both arrive; the same for the time), then each strategy "
        "against itself at the founding u of "
        f"{label(FOUNDING)}:\nworlds in which its path is shorter, and the ratio.\n\n" + verdicts(found, worlds)]
    with open(options.folder / "divisors.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: "" if value is None else f"{value:.6g}" if isinstance(value, float) else value
                          for key, value in row.items()} for row in rows)
    (options.folder / "divisors.txt").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", dest="seeds", type=int, default=5)
    parser.add_argument("-d", dest="duration", type=float, default=1200)
    parser.add_argument("-j", dest="threads", type=int, default=2)
    parser.add_argument("-p", dest="program", default=str(ROOT / "build/release/apps/rasterslam"))
    parser.add_argument("-o", dest="folder", type=pathlib.Path, default=ROOT / "benchmarks/results")
    parser.add_argument("-w", dest="worlds", default="", help="separated by commas; all")
    parser.add_argument("-k", dest="scratch", type=pathlib.Path)
    options = parser.parse_args()
    os.nice(10)
    options.folder.mkdir(parents=True, exist_ok=True)
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        scratch = options.scratch or pathlib.Path(temporary)
        scratch.mkdir(parents=True, exist_ok=True)
        worlds = make_worlds(options.program, options.worlds, scratch)
        for world, plan in worlds:
            for divisor in DIVISORS:
                runs = explore(options.program, plan, divisor, options, scratch / f"{world}_{label(divisor)}")
                rows += [summary(world, strategy, divisor, runs) for strategy in STRATEGIES]
    write(options, rows, [world for world, _ in worlds])
    print(options.folder / "divisors.txt")


if __name__ == "__main__":
    main()
