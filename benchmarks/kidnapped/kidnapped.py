#!/usr/bin/env python3
"""Is a kidnapped robot noticed, and is what it maps then joined rightly?

  benchmarks/kidnapped/kidnapped.py [-n DRIVES] [-w DRIVES] [-l DRIVES] [-m METHOD] [-j JOBS] [-p PROGRAM] [-o FOLDER] [-s SEED]

Short drives in generated buildings of every kind, with three lidars and at 2 to 40 scans a second: n in which somebody
carries the robot, w in which nobody does, and l beside rooms that look all the same (a hospital without furniture), where
somebody does. Two of three are put down where they have been before, the third anywhere. What counts, of the method's
journal and the true path:
- noticed: `lost` within 5 s of the carrying;
- comes back: at least 10 s, after the carrying, within 1.5 m of the way before it (with a lidar that looks half round: headed
  within 60 degrees of it);
- joined: `recovered` after the carrying;
- wrong join: one after which the pose relative to the last before the carrying is wrong by more than 0.5 m or 10 degrees;
- false alarm: `lost` before anybody carried the robot, or once more after it was joined.
Writes FOLDER/kidnapped.csv (a row per drive) and FOLDER/kidnapped.txt (for people).
"""
import argparse
import concurrent.futures
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from poses import between, read_tum, wrapped  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILDINGS = {"flat": "13x10", "office": "24x16", "hall": "24x18", "hospital": "26x18", "cave": "24x18",
             "campus": "40x30"}
LIDARS = ["tim571", "lms291", "rplidar_a2"]
HALF_ROUND = {"lms291"}
RATES_HZ = [2, 5, 10, 20, 40]
DURATION_S, CARRIED_S = 80, 40
NOTICED_S, BACK_S, BACK_M, BACK_DEG = 5, 10, 1.5, 60
WRONG_M, WRONG_DEG = 0.5, 10
COLUMNS = ["group", "building", "lidar", "rate_hz", "seed", "carried", "noticed_after_s", "comes_back", "joined",
           "joins", "wrong_joins", "worst_join_m", "false_alarms", "exit_code"]


def at(poses, time_s):
    return min(poses, key=lambda p: abs(p[0] - time_s))[1]


def drives_of(arguments):
    """Every drive: group, building, lidar, rate, seed, what is done to the robot."""
    drives = []

    def add(group, count, buildings, is_carried):
        for i in range(count):
            carried = ("random" if i % 3 == 2 else "visited") if is_carried else "none"
            # Lidar and rate change at other paces, so that all pairs come.
            lidar, rate = LIDARS[(i // len(buildings)) % 3], RATES_HZ[(i + i // len(RATES_HZ)) % len(RATES_HZ)]
            drives.append((group, buildings[i % len(buildings)], lidar, rate, arguments.seed + i, carried))

    add("carried", arguments.carried, list(BUILDINGS), True)
    add("left alone", arguments.alone, list(BUILDINGS), False)
    add("look-alike", arguments.alike, ["hospital"], True)
    return drives


def comes_back(truth, carried_s, is_half_round):
    """Whether the true path after the carrying leads along that before it."""
    before = [pose for t, pose in truth if t < carried_s][::2]
    after = [(t, pose) for t, pose in truth if t >= carried_s]
    back_s, last = 0, None
    for t, pose in after:
        is_near = any(math.hypot(p[0] - pose[0], p[1] - pose[1]) < BACK_M and
                      (not is_half_round or abs(wrapped(p[2] - pose[2])) < math.radians(BACK_DEG)) for p in before)
        if is_near and last is not None:
            back_s += t - last
        last = t
    return back_s >= BACK_S


def score(folder, truth_path, carried, is_half_round):
    truth, estimate = read_tum(truth_path), read_tum(folder / "trajectory_final.tum")
    begin_s = truth[0][0]
    carried_s = CARRIED_S if carried != "none" else math.inf
    events = [(float(row["time_s"]), row["event"]) for row in csv.DictReader((folder / "journal.csv").open())]
    lost = [t for t, event in events if event == "lost"]
    joins = [t for t, event in events if event == "recovered"]
    reference_s = begin_s + (carried_s - 0.6 if carried != "none" else 0)
    wrong, worst_m = 0, 0.0
    for t in joins:
        true = between(at(truth, reference_s), at(truth, begin_s + t))
        own = between(at(estimate, reference_s), at(estimate, begin_s + t))
        off_m = math.hypot(true[0] - own[0], true[1] - own[1])
        off_deg = math.degrees(abs(wrapped(true[2] - own[2])))
        worst_m = max(worst_m, off_m)
        wrong += off_m > WRONG_M or off_deg > WRONG_DEG
    noticed = [t - carried_s for t in lost if t >= carried_s]
    after_join = [t for t in lost if any(carried_s < j <= t for j in joins)]
    return {"noticed_after_s": f"{noticed[0]:.1f}" if noticed else "",
            "comes_back": int(carried != "none" and comes_back(truth, begin_s + carried_s, is_half_round)),
            "joined": int(any(t > carried_s for t in joins)), "joins": len(joins), "wrong_joins": wrong,
            "worst_join_m": f"{worst_m:.3f}",
            "false_alarms": sum(t < carried_s for t in lost) + len(after_join)}


def drive(job):
    (group, building, lidar, rate, seed, carried), arguments = job
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)

        def run(*words):
            return subprocess.run([arguments.program, *map(str, words)], cwd=folder, capture_output=True, text=True)

        bare = ["--set", "building.clutter=0"] if group == "look-alike" else []
        steps = [("world", "make", building, "-o", "plan.yaml", "--size", BUILDINGS[building], "--seed", seed,
                  *bare),
                 ("simulate", "plan.yaml", "-o", "run.rawlog", "--lidar", lidar, "--set", f"lidar.rate_hz={rate}",
                  "--duration", DURATION_S, "--seed", seed, "-q",
                  *(["--carry", f"{CARRIED_S}:{carried}"] if carried != "none" else []))]
        for step in steps:
            done = run(*step)
            if done.returncode:
                sys.exit(f"{' '.join(map(str, step))}: {done.stderr}")
        done = run("run", arguments.method, "run.rawlog", "-o", "out", "--seed", seed, "-q")
        if done.returncode not in (0, 4):
            sys.exit(f"run, {building}, {lidar}, {rate} Hz, seed {seed}: {done.stderr}")
        return dict(zip(COLUMNS, (group, building, lidar, rate, seed, carried)),
                    **score(folder / "out", folder / "run.gt.tum", carried, lidar in HALF_ROUND),
                    exit_code=done.returncode)


def share(part, whole):
    return f"{part} of {whole}" + (f" ({100 * part / whole:.0f} %)" if whole else "")


def line(name, rows):
    carried = [r for r in rows if r["carried"] != "none"]
    noticed = [r for r in carried if r["noticed_after_s"] and float(r["noticed_after_s"]) <= NOTICED_S]
    back = [r for r in carried if r["comes_back"]]
    return [name, str(len(rows)), share(len(noticed), len(carried)) if carried else "-",
            share(sum(r["joined"] for r in back), len(back)) if carried else "-",
            f"{sum(r['wrong_joins'] for r in rows)} of {sum(r['joins'] for r in rows)}",
            f"{sum(r['false_alarms'] for r in rows)} in {sum(r['false_alarms'] > 0 for r in rows)}"]


def table(rows, arguments):
    lines = [["", "drives", f"noticed in {NOTICED_S} s", "joined of those back", "wrong joins", "false alarms"]]
    groups = list(dict.fromkeys(r["group"] for r in rows))
    for group in groups:
        lines.append(line(group, [r for r in rows if r["group"] == group]))
    for key in ("building", "lidar", "rate_hz"):
        for value in dict.fromkeys(sorted(r[key] for r in rows)):
            lines.append(line(f"  {value}" + (" Hz" if key == "rate_hz" else ""), [r for r in rows if r[key] == value]))
    widths = [max(len(row[i]) for row in lines) for i in range(len(lines[0]))]
    text = "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in lines)
    return (f"Kidnapped robot, method {arguments.method}: drives of {DURATION_S} s, carried after {CARRIED_S} s.\n"
            f"benchmarks/kidnapped/kidnapped.py -n {arguments.carried} -w {arguments.alone} -l {arguments.alike} "
            f"-m {arguments.method} -s {arguments.seed}\n\n{text}\n\nWhat each column means stands at the head of the script.\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", dest="carried", type=int, default=200)
    parser.add_argument("-w", dest="alone", type=int, default=200)
    parser.add_argument("-l", dest="alike", type=int, default=50)
    parser.add_argument("-s", dest="seed", type=int, default=1000, help="of the first drive; the next ones count on")
    parser.add_argument("-m", dest="method", default="graph")
    parser.add_argument("-j", dest="jobs", type=int, default=2)
    parser.add_argument("-p", dest="program", default=str(ROOT / "build/release/apps/rasterslam"))
    parser.add_argument("-o", dest="folder", type=pathlib.Path, default=ROOT / "benchmarks/results")
    arguments = parser.parse_args()
    arguments.program = str(pathlib.Path(arguments.program).resolve())
    jobs = [(d, arguments) for d in drives_of(arguments)]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        rows = list(pool.map(drive, jobs))
    arguments.folder.mkdir(parents=True, exist_ok=True)
    with (arguments.folder / "kidnapped.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    text = table(rows, arguments)
    (arguments.folder / "kidnapped.txt").write_text(text)
    print(text, end="")


if __name__ == "__main__":
    main()
