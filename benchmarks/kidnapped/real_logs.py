#!/usr/bin/env python3
"""Is a robot that was kidnapped in a real building noticed, and is what it maps then joined rightly?

  benchmarks/kidnapped/real_logs.py [-d DATA] [-l LOGS] [-n CUTS] [-u CUTS] [-m METHOD] [-s SEED] [-j JOBS] [-p PROGRAM] [-o FILE]

Nobody was carried in the logs that there are, so each cut of a log leaves a piece out: the robot drives to a place drawn by
chance, and GAP_S later, as its wheels have it, it drives on where it was at another time. Of every log n cuts lead to where
it had been before (at least VISITED of the next AFTER_M metres within BACK_M of the way before, headed within BACK_DEG of it),
and u to where it never comes. What each log's path is held against is the method's own in the whole log, which relations judge.
What counts, of the method's journal and its final path:
- noticed: `lost` after the carrying;
- joined: `recovered` after it, and the last pose, as seen from the nearest of those before the carrying, right to WRONG_M and
  WRONG_DEG;
- wrong: `recovered`, but not so.
Prints a table (and writes it to FILE): a row per log, the cuts to known ground first.
"""
import argparse
import bisect
import concurrent.futures
import csv
import math
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from carmen import Scan, read_log, write_log  # noqa: E402
from poses import between, compose, read_tum, wrapped  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LOGS = {"intel": "logs/intel/intel.clf.bz2", "fr079": "logs/fr079/fr079.clf.bz2",
        "mit-killian": "logs/mit-killian/mit-killian.reconstructed.clf.xz", "fhw": "logs_keyframes/fhw.clf.xz"}
GAP_S, AFTER_M, CARRIED_M, BEFORE_M = 3, 25, 4, 15
VISITED, BACK_M, BACK_DEG = 0.8, 1.5, 60
WRONG_M, WRONG_DEG = 1, 10
MOST_TRIES = 5000


def near(a, b, degrees):
    return math.hypot(a[0] - b[0], a[1] - b[1]) < BACK_M and abs(wrapped(a[2] - b[2])) < math.radians(degrees)


class Log:
    """The scans of a log and where the method has them in the whole of it."""

    def __init__(self, path, arguments):
        self.settings, scans = read_log(path)
        with tempfile.TemporaryDirectory() as scratch:
            out = pathlib.Path(scratch) / "out"
            done = run(arguments, path, out)
            if done.returncode:
                sys.exit(f"{path}: {done.stderr}")
            poses = read_tum(out / "trajectory_final.tum")
        stamps = [t for t, _ in poses]
        self.scans, self.poses, self.way_m = [], [], []
        for scan in sorted(scans, key=lambda s: s.stamp):
            at = bisect.bisect(stamps, scan.stamp + 1e-5) - 1
            if at < 0 or abs(stamps[at] - scan.stamp) > 1e-3:
                continue
            pose = poses[at][1]
            moved = math.hypot(pose[0] - self.poses[-1][0], pose[1] - self.poses[-1][1]) if self.poses else 0
            self.way_m.append((self.way_m[-1] if self.way_m else 0) + moved)
            self.scans.append(scan)
            self.poses.append(pose)

    def cuts(self, count, leads_back, chance):
        """Of so many cuts: the last scan before, the first and the last after it."""
        cuts = []
        for _ in range(MOST_TRIES):
            if len(cuts) == count:
                break
            last = chance.randrange(len(self.scans) // 10, len(self.scans) * 7 // 10)
            first = chance.randrange(last + 5, len(self.scans) - 5)
            end = bisect.bisect(self.way_m, self.way_m[first] + AFTER_M)
            a, b = self.poses[last], self.poses[first]
            if end == len(self.scans) or self.way_m[last] < BEFORE_M or math.hypot(a[0] - b[0], a[1] - b[1]) < CARRIED_M:
                continue
            after = self.poses[first:end:3]
            known = sum(any(near(p, q, BACK_DEG) for q in self.poses[:last:3]) for p in after) / len(after)
            if known >= VISITED if leads_back else known < 0.02:
                cuts.append((last, first, end - 1))
        return cuts

    def cut(self, last, first, end):
        """The scans of a cut; the wheels go on where they stood."""
        shift_s = self.scans[last].stamp + GAP_S - self.scans[first].stamp
        stood, stand = self.scans[last].pose, self.scans[first].pose
        after = [Scan(s.ranges, compose(stood, between(stand, s.pose)), s.stamp + shift_s, s.index)
                 for s in self.scans[first:end + 1]]
        return self.scans[:last + 1] + after


def run(arguments, log, out):
    return subprocess.run([arguments.program, "run", arguments.method, str(log), "-o", str(out), "-q"], capture_output=True,
                          text=True)


def score(job):
    """Whether a cut was noticed, joined rightly, joined wrongly."""
    log, (last, first, end), arguments = job
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        write_log(folder / "cut.clf", log.settings, log.cut(last, first, end))
        done = run(arguments, folder / "cut.clf", folder / "out")
        if done.returncode not in (0, 4):
            sys.exit(f"a cut at scan {last}, on at {first}: {done.stderr}")
        path = read_tum(folder / "out/trajectory_final.tum")
        events = [(float(row["time_s"]), row["event"]) for row in csv.DictReader((folder / "out/journal.csv").open())]
    carried_s = log.scans[last].stamp - path[0][0]
    noticed = any(event == "lost" and t > carried_s for t, event in events)
    recovered = any(event == "recovered" and t > carried_s for t, event in events)
    stamps = [t for t, _ in path]
    estimate = [path[min(bisect.bisect_left(stamps, s.stamp - 1e-5), len(path) - 1)][1] for s in log.scans[:last + 1]]
    here = log.poses[end]
    old = min(range(last), key=lambda k: math.hypot(log.poses[k][0] - here[0], log.poses[k][1] - here[1]))
    true, own = between(log.poses[old], here), between(estimate[old], path[-1][1])
    is_right = (math.hypot(true[0] - own[0], true[1] - own[1]) < WRONG_M and
                abs(wrapped(true[2] - own[2])) < math.radians(WRONG_DEG))
    return noticed, recovered and is_right, recovered and not is_right


def table(rows):
    lines = [["log", "to known ground", "noticed", "joined", "wrong", "to new ground", "noticed", "wrong"]] + rows
    widths = [max(len(row[i]) for row in lines) for i in range(len(lines[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-d", dest="data", type=pathlib.Path, default=ROOT.parent / "shared/data")
    parser.add_argument("-l", dest="logs", default=",".join(LOGS))
    parser.add_argument("-n", dest="back", type=int, default=12, help="cuts of each log that lead to known ground")
    parser.add_argument("-u", dest="new", type=int, default=6, help="cuts of each log that lead to new ground")
    parser.add_argument("-m", dest="method", default="graph")
    parser.add_argument("-s", dest="seed", type=int, default=1)
    parser.add_argument("-j", dest="jobs", type=int, default=2)
    parser.add_argument("-p", dest="program", default=str(ROOT / "build/release/apps/rasterslam"))
    parser.add_argument("-o", dest="file", type=pathlib.Path)
    arguments = parser.parse_args()
    unknown = [name for name in arguments.logs.split(",") if name not in LOGS]
    if unknown:
        parser.error(f"-l: no log {unknown[0]}; there are {', '.join(LOGS)}")
    rows = []
    for name in arguments.logs.split(","):
        log, chance, row = Log(arguments.data / LOGS[name], arguments), random.Random(arguments.seed), [name]
        for leads_back, count in ((True, arguments.back), (False, arguments.new)):
            cuts = log.cuts(count, leads_back, chance)
            with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
                noticed, joined, wrong = zip(*pool.map(score, [(log, cut, arguments) for cut in cuts])) if cuts else ((),) * 3
            row += [str(len(cuts)), str(sum(noticed))] + ([str(sum(joined))] if leads_back else []) + [str(sum(wrong))]
        rows.append(row)
        print("  ".join(row), file=sys.stderr)
    text = (f"Kidnapped in real buildings, method {arguments.method}.\nbenchmarks/kidnapped/real_logs.py -l {arguments.logs} "
            f"-n {arguments.back} -u {arguments.new} -m {arguments.method} -s {arguments.seed}\n\n{table(rows)}\n"
            "What each column means stands at the head of the script.\n")
    print(text, end="")
    if arguments.file:
        arguments.file.write_text(text)


if __name__ == "__main__":
    main()
