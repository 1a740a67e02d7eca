#!/usr/bin/env python3
"""Are maps of one building made one, and maps of different buildings kept apart?

  benchmarks/merging/merging.py [-n PAIRS] [-u PAIRS] [-t SECONDS] [-j JOBS] [-p PROGRAM] [-o FOLDER] [-s SEED]

Two robots explore a generated building, from different places and by different strategies; `rasterslam run graph` maps each
log, `rasterslam merge` looks for the maps in one another. n pairs are of one building, half of them with a third of the
furniture moved before the second drive, every fifth by two lidars; u pairs are of two buildings of the same kind, the second a
sixth larger (hospitals and halls of one size differ in their furniture alone).
What counts, against the true paths:
- merged: exit code 0; wrong: merged, and the two paths then lie by more than 0.5 m or 10 degrees wrong to one another, or they
  are of different buildings;
- joint ATE: RMSE of both paths together, one rigid alignment for both, beside the larger of the two alone.
Writes FOLDER/merging.csv (a row per pair) and FOLDER/merging.txt (for people).
"""
import argparse
import concurrent.futures
import csv
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from poses import between, compose, read_tum, wrapped  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILDINGS = {"flat": "13x10", "office": "30x20", "hall": "24x18", "hospital": "36x24", "cave": "24x18", "campus": "60x40"}
LIDARS = ["tim571", "lms291", "rplidar_a2"]
WRONG_M, WRONG_DEG = 0.5, 10
COLUMNS = ["group", "building", "lidar", "other_lidar", "seed", "furniture", "exit_code", "merged", "wrong", "off_m", "off_deg",
           "ate_a_m", "ate_b_m", "joint_ate_m", "fitting", "extent_m", "ahead_nats", "shared", "contradicted", "said"]


def aligned_rmse(pairs):
    """RMSE of (estimated, true) positions after the best rigid alignment."""
    n = len(pairs)
    ex, ey = (sum(e[i] for e, _ in pairs) / n for i in (0, 1))
    tx, ty = (sum(t[i] for _, t in pairs) / n for i in (0, 1))
    cross = sum((e[0] - ex) * (t[1] - ty) - (e[1] - ey) * (t[0] - tx) for e, t in pairs)
    dot = sum((e[0] - ex) * (t[0] - tx) + (e[1] - ey) * (t[1] - ty) for e, t in pairs)
    turn = math.atan2(cross, dot)
    c, s = math.cos(turn), math.sin(turn)
    squares = sum((c * (e[0] - ex) - s * (e[1] - ey) - t[0] + tx) ** 2 + (s * (e[0] - ex) + c * (e[1] - ey) - t[1] + ty) ** 2
                  for e, t in pairs)
    return math.sqrt(squares / n)


def paired(estimate, truth):
    """Estimated and true poses of the same stamps."""
    known = {round(t, 4): pose for t, pose in truth}
    return [(pose, known[round(t, 4)]) for t, pose in estimate if round(t, 4) in known]


def offset(a, b):
    """How far the second path lies from where the first has it: metres and degrees."""
    # The frame of the world as each path has it at its middle pose.
    world_by_a, world_by_b = (compose(estimate, between(true, (0, 0, 0))) for estimate, true in (a[len(a) // 2], b[len(b) // 2]))
    # Compared at the place of the second path, so that a small error of heading is no large one of place.
    at = b[len(b) // 2][1]
    off = between(compose(world_by_a, at), compose(world_by_b, at))
    return math.hypot(off[0], off[1]), math.degrees(abs(wrapped(off[2])))


def pairs_of(arguments):
    pairs = []
    kinds = list(BUILDINGS)
    for group, count in (("one building", arguments.same), ("two buildings", arguments.different)):
        for i in range(count):
            # Each kind of building with every lidar, and with its furniture moved and not.
            is_moved = group == "one building" and (i // len(kinds)) % 2 == 1
            pairs.append((group, kinds[i % len(kinds)], LIDARS[(i // len(kinds)) % 3], arguments.seed + i, is_moved))
    return pairs


def merge(job):
    (group, building, lidar, seed, is_moved), arguments = job
    is_same = group == "one building"
    # Every fifth pair of one building is of two lidars.
    other_lidar = LIDARS[(LIDARS.index(lidar) + 1) % 3] if is_same and seed % 5 == 4 else lidar
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)

        def run(*words, fails=()):
            done = subprocess.run([arguments.program, *map(str, words)], cwd=folder, capture_output=True, text=True)
            if done.returncode and done.returncode not in fails:
                sys.exit(f"{' '.join(map(str, words))}: {done.stderr}")
            return done

        run("world", "make", building, "-o", "a.yaml", "--size", BUILDINGS[building], "--seed", seed)
        drive = ["--duration", arguments.duration_s, "--slam", "truth", "-q"]
        run("explore", "a.yaml", "-o", "drive_a", "--strategy", "nearest_frontier", "--lidar", lidar, "--seed", seed, *drive)
        plan, begins = "b.yaml", [[]]
        if is_same:
            plan, path = "a.yaml", read_tum(folder / "drive_a/run.gt.tum")
            # About the middle of the other's way, wherever no furniture stands now.
            middles = [path[len(path) * share // 100][1] for share in (50, 45, 55, 40, 60, 35, 65, 30, 70)]
            begins = [["--start", f"{x},{y},{math.degrees(heading) + 130}"] for x, y, heading in middles]
        else:
            larger = "x".join(str(round(int(side) * 7 / 6)) for side in BUILDINGS[building].split("x"))
            run("world", "make", building, "-o", plan, "--size", larger, "--seed", seed + 500)
        moved = ["--set", "living.visit=2", "--set", "living.furniture_share=0.33"] if is_moved else []
        for begin in begins:
            done = run("explore", plan, "-o", "drive_b", "--strategy", "next_best_view", "--lidar", other_lidar, "--seed",
                       seed + 500, *drive, *begin, *moved, fails=(3,))
            if done.returncode == 0:
                break
        for name in "ab":
            run("run", "graph", f"drive_{name}/run.rawlog", "-o", name, "-q", fails=(4,))
        done = run("merge", "a", "b", "-o", "both", "-q", "--json", fails=(4,))
        row = dict(zip(COLUMNS, (group, building, lidar, other_lidar, seed, "moved" if is_moved else "as it was",
                                 done.returncode, int(done.returncode == 0))))
        truths = [read_tum(folder / f"drive_{name}/run.gt.tum") for name in "ab"]
        alone = [paired(read_tum(folder / name / "trajectory_final.tum"), truth) for name, truth in zip("ab", truths)]
        row["ate_a_m"], row["ate_b_m"] = (f"{aligned_rmse(pairs):.4f}" for pairs in alone)
        row["wrong"] = int(done.returncode == 0 and not is_same)
        row["said"] = done.stderr.strip().splitlines()[-1] if done.returncode else ""
        if done.returncode == 0:
            place = json.loads(done.stdout)["sessions"][1]
            row.update(fitting=place["fitting_key_frames"], extent_m=f"{place['extent_m']:.1f}",
                       ahead_nats=f"{place['ahead_nats']:.0f}", shared=f"{place['shared']:.3f}",
                       contradicted=f"{place['contradicted']:.4f}")
            if is_same:
                joint = [paired(read_tum(folder / "both" / f"{name}.tum"), truth) for name, truth in zip("ab", truths)]
                off_m, off_deg = offset(*joint)
                row.update(off_m=f"{off_m:.3f}", off_deg=f"{off_deg:.2f}", joint_ate_m=f"{aligned_rmse(joint[0] + joint[1]):.4f}")
                row["wrong"] = int(off_m > WRONG_M or off_deg > WRONG_DEG)
        print(f"{group}, {building}, {lidar}, seed {seed}: {'merged' if row['merged'] else row['said']}"
              f"{', WRONG' if row['wrong'] else ''}", file=sys.stderr, flush=True)
        return row


def text_of(rows, arguments):
    lines = [["", "pairs", "merged", "wrong", "joint ATE (m)", "worse one alone", "ratio, median and most", "contradicted"]]
    groups = [(group, [r for r in rows if r["group"] == group]) for group in dict.fromkeys(r["group"] for r in rows)]
    for group, mine in list(groups):
        for key in ("furniture", "building"):
            groups += [(f"  {group}, {value}", [r for r in mine if r[key] == value])
                       for value in dict.fromkeys(r[key] for r in mine)]
        groups += [(f"  {group}, two lidars", two)] if (two := [r for r in mine if r["lidar"] != r["other_lidar"]]) else []
    for name, mine in groups:
        good = [r for r in mine if r["merged"] and not r["wrong"]]
        alone = [max(float(r["ate_a_m"]), float(r["ate_b_m"])) for r in good]
        joint = [float(r["joint_ate_m"]) for r in good]
        ratios = [j / a for j, a in zip(joint, alone)]
        against = [float(r["contradicted"]) for r in mine if r["merged"]]
        lines.append([name, str(len(mine)), str(sum(r["merged"] for r in mine)), str(sum(r["wrong"] for r in mine)),
                      *([f"{statistics.median(joint):.4f}", f"{statistics.median(alone):.4f}",
                         f"{statistics.median(ratios):.2f}, {max(ratios):.2f}"] if good else ["-"] * 3),
                      f"{min(against):.3f} to {max(against):.3f}" if against else "-"])
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    table = "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)
    return (f"Maps of two drives of {arguments.duration_s} s, merged.\nbenchmarks/merging/merging.py -n {arguments.same} "
            f"-u {arguments.different} -t {arguments.duration_s} -s {arguments.seed}\n\n{table}\n\n"
            "What each column means stands at the head of the script.\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", dest="same", type=int, default=48)
    parser.add_argument("-u", dest="different", type=int, default=48)
    parser.add_argument("-t", dest="duration_s", type=int, default=150)
    parser.add_argument("-s", dest="seed", type=int, default=7000, help="of the first building; the next ones count on")
    parser.add_argument("-j", dest="jobs", type=int, default=2)
    parser.add_argument("-p", dest="program", default=str(ROOT / "build/release/apps/rasterslam"))
    parser.add_argument("-o", dest="folder", type=pathlib.Path, default=ROOT / "benchmarks/results")
    arguments = parser.parse_args()
    arguments.program = str(pathlib.Path(arguments.program).resolve())
    jobs = [(pair, arguments) for pair in pairs_of(arguments)]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        rows = list(pool.map(merge, jobs))
    arguments.folder.mkdir(parents=True, exist_ok=True)
    with (arguments.folder / "merging.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    text = text_of(rows, arguments)
    (arguments.folder / "merging.txt").write_text(text)
    print(text, end="")


if __name__ == "__main__":
    main()
