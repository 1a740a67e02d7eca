#!/usr/bin/env python3
"""Does a method keep its map in other logs than those it was made with? Real logs are altered, and the map has to be kept.

  benchmarks/places/altered.py [-d DATA] [-l LOGS] [-a ALTERATIONS] [-m METHOD] [-s SET] [-j JOBS] [-p PROGRAM] [-o FILE]

DATA is the folder of logs (logs/ and logs_keyframes/); LOGS and ALTERATIONS are names with commas between (intel-thin:
a scan per metre or half radian of intel, as logs of other places often are distributed); SET is
section.key=value, more of them with commas between. Each alteration is something that happens elsewhere: few scans, gaps,
wheels that slip, a lidar that sees 8 m, glass, stamps that leap. What each does stands beside its name below.

What the final path is held against: the reference beside a log of logs_keyframes (another SLAM's, good to decimetres), and
for the annotated logs the method's own path in the log as it is, which their relations judge. So this tells a map that was kept
from one that was lost, and no more. The error is the root mean square over the scans, aligned; a map is lost beyond LOST_M.
Prints a table (and writes it to FILE): a row per alteration, a column per log, '!' at a lost map, and how often the robot was
lost, found again, and never found (journal), where it was.
"""
import argparse
import concurrent.futures
import csv
import math
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from carmen import read_log, write_log  # noqa: E402
from poses import between, compose, read_tum  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
ANNOTATED = {"intel": "logs/intel/intel.clf.bz2", "fr079": "logs/fr079/fr079.clf.bz2",
             "mit-killian": "logs/mit-killian/mit-killian.reconstructed.clf.xz"}
KEYFRAMES = ["fhw", "acapulco", "freiburg-campus"]
THIN = "-thin"  # behind the name of an annotated log: a scan per metre or half radian of it
THIN_M, THIN_RAD = 1.0, 0.5
LOST_M = {"freiburg-campus": 1.0}
USUALLY_LOST_M = 0.5
NO_RETURN_M = 81.91


def with_odometry(scans, change):
    """The same scans, with every increment of the wheels changed; `change` gets it and its length."""
    pose, before = scans[0].pose, scans[0].pose
    for scan in scans:
        increment = between(before, scan.pose)
        before = scan.pose
        pose = compose(pose, change(increment, math.hypot(increment[0], increment[1])))
        scan.pose = pose
    return scans


def is_return(reading):
    return 0 < reading < 50


# --- The alterations. Each gets scans, a source of chance, and changes or drops them. ------------------------------


def as_it_is(scans, _):
    """the log as it is"""
    return scans


def thinned(scans, way_m, turn_rad):
    """A scan per so much of way or turn, by the wheels."""
    kept = scans[:1]
    for scan in scans[1:]:
        moved = between(kept[-1].pose, scan.pose)
        if math.hypot(moved[0], moved[1]) > way_m or abs(moved[2]) > turn_rad:
            kept.append(scan)
    return kept


def few_scans(scans, _):
    """two scans of three are missing, one by one"""
    return scans[::3]


def wide_scans(scans, _):
    """a scan per 1.5 m or radian"""
    return thinned(scans, 1.5, 1.0)


def gaps(scans, _):
    """3 m of scans missing after every 40 m"""
    kept, way = [], 0.0
    for before, scan in zip(scans[:1] + scans, scans):
        moved = between(before.pose, scan.pose)
        way += math.hypot(moved[0], moved[1])
        if way % 43 < 40:
            kept.append(scan)
    return kept


def paused(scans, _):
    """an hour's pause after every 100 m"""
    way = 0.0
    for before, scan in zip(scans[:1] + scans[:], scans[:]):
        moved = between(before.pose, scan.pose)
        way += math.hypot(moved[0], moved[1])
        scan.later = 3600 * int(way / 100)
    for scan in scans:
        scan.stamp += scan.later
    return scans


def scaled(scans, _):
    """wheels: metres 5 % too long, turns 5 % too small"""
    return with_odometry(scans, lambda d, _: (1.05 * d[0], 1.05 * d[1], 0.95 * d[2]))


def biased(scans, _):
    """wheels: 2 degrees per metre to the left"""
    return with_odometry(scans, lambda d, way: (d[0], d[1], d[2] + math.radians(2) * way))


def noisy(scans, chance):
    """wheels: noise of 10 % and 2 degrees per root of a metre"""
    return with_odometry(scans, lambda d, way: (
        d[0] * chance.gauss(1, 0.1), d[1], d[2] + chance.gauss(0, math.radians(2)) * math.sqrt(way) + 0.1 * d[2] * chance.gauss(0, 1)))


def slipping(scans, chance):
    """wheels: five times 0.5 m or 0.4 rad that were not driven"""
    at = set(chance.sample(range(20, len(scans)), 5))
    order = iter(range(10**9))

    def slip(d, _):
        i = next(order)
        if i not in at:
            return d
        return (d[0] + 0.5, d[1], d[2]) if i % 2 else (d[0], d[1], d[2] + 0.4)
    return with_odometry(scans, slip)


def standing(scans, _):
    """wheels: zero all the time"""
    return with_odometry(scans, lambda *_: (0, 0, 0))


def leaping(scans, chance):
    """wheels: the counter begins anew, far away, three times"""
    at = set(chance.sample(range(20, len(scans)), 3))
    order = iter(range(10**9))
    return with_odometry(scans, lambda d, _: (30.0, -20.0, 2.0) if next(order) in at else d)


def near_sighted(scans, _):
    """8 m of range, beyond which the lidar says 8.19"""
    for scan in scans:
        scan.ranges = [min(r, 8.19) for r in scan.ranges]
    return scans


def half_round(scans, _):
    """of the field of view the middle 120 degrees"""
    for scan in scans:
        n = len(scan.ranges)
        scan.ranges = [r if n / 6 <= i < 5 * n / 6 else NO_RETURN_M for i, r in enumerate(scan.ranges)]
    return scans


def few_beams(scans, _):
    """every third beam alone"""
    for scan in scans:
        scan.ranges = [r if i % 3 == 0 else NO_RETURN_M for i, r in enumerate(scan.ranges)]
    return scans


def odd_beams(scans, _):
    """180 and 181 (360 and 361) beams by turns"""
    for i, scan in enumerate(scans):
        even = len(scan.ranges) // 2 * 2
        scan.ranges = scan.ranges[:even] + (scan.ranges[even - 1:even] if i % 2 else [])
    return scans


def glass(scans, chance):
    """a sixth of each scan, in one piece, sees nothing; one reading of fifty is anything"""
    for scan in scans:
        n = len(scan.ranges)
        first = chance.randrange(n)
        gone = {(first + i) % n for i in range(n // 6)}
        scan.ranges = [NO_RETURN_M if i in gone else chance.uniform(0.3, 15) if chance.random() < 0.02 else r
                       for i, r in enumerate(scan.ranges)]
    return scans


def coarse(scans, chance):
    """readings with 5 cm of noise"""
    for scan in scans:
        scan.ranges = [max(r + chance.gauss(0, 0.05), 0.02) if is_return(r) else r for r in scan.ranges]
    return scans


def crowded(scans, chance):
    """five legs that walk about, 0.5 to 4 m away"""
    people = [[chance.uniform(0, 1), chance.uniform(0.5, 4)] for _ in range(5)]
    for scan in scans:
        n = len(scan.ranges)
        for person in people:
            person[0] = (person[0] + chance.gauss(0, 0.02)) % 1
            person[1] = min(max(person[1] + chance.gauss(0, 0.1), 0.5), 4)
            half = max(1, round(n * 0.15 / person[1] / math.pi / 2))
            for i in range(max(0, int(person[0] * n) - half), min(n, int(person[0] * n) + half + 1)):
                scan.ranges[i] = min(scan.ranges[i], person[1])
    return scans


def lifted(scans, chance):
    """five times some scans of nothing that is there (lifted, tilted)"""
    for first in chance.sample(range(30, len(scans) - 10), 5):
        for scan in scans[first:first + (3 if len(scans) < 3000 else 10)]:
            scan.ranges = [chance.uniform(0.5, 3) for _ in scan.ranges]
    return scans


def stamps_back(scans, _):
    """every twentieth stamp two seconds early"""
    for i, scan in enumerate(scans):
        scan.stamp -= 2 * (i % 20 == 19)
    return scans


def one_stamp(scans, _):
    """one stamp for all"""
    for scan in scans:
        scan.stamp = scans[0].stamp
    return scans


def mirrored(scans, _):
    """left is right"""
    for scan in scans:
        scan.ranges.reverse()
        scan.pose = scan.pose[0], -scan.pose[1], -scan.pose[2]
    return scans


def backwards(scans, _):
    """driven from the end to the beginning, backwards"""
    stamps = [scan.stamp for scan in scans]
    scans.reverse()
    for scan, stamp in zip(scans, sorted(stamps)):
        scan.stamp = stamp
    return scans


ALTERATIONS = {f.__name__: f for f in (
    as_it_is, few_scans, wide_scans, gaps, paused, scaled, biased, noisy, slipping, standing, leaping,
    near_sighted, half_round, few_beams, odd_beams, glass, coarse, crowded, lifted, stamps_back, one_stamp, mirrored,
    backwards)}


# --- Judging -------------------------------------------------------------------------------------------------------


def error_m(estimate, reference):
    """Root mean square distance of two lists of poses after the best turn and shift."""
    n = len(estimate)
    mean = [sum(p[i] for p in poses) / n for poses in (estimate, reference) for i in (0, 1)]
    dot = cross = 0.0
    for a, b in zip(estimate, reference):
        ax, ay, bx, by = a[0] - mean[0], a[1] - mean[1], b[0] - mean[2], b[1] - mean[3]
        dot += ax * bx + ay * by
        cross += ax * by - ay * bx
    turn = math.atan2(cross, dot)
    c, s = math.cos(turn), math.sin(turn)
    total = 0.0
    for a, b in zip(estimate, reference):
        ax, ay, bx, by = a[0] - mean[0], a[1] - mean[1], b[0] - mean[2], b[1] - mean[3]
        total += (c * ax - s * ay - bx) ** 2 + (s * ax + c * ay - by) ** 2
    return math.sqrt(total / n)


def run(arguments, log, folder):
    words = [arguments.program, "run", arguments.method, str(log), "-o", str(folder), "--overwrite", "-q"]
    for setting in filter(None, arguments.settings.split(",")):
        words += ["--set", setting]
    return subprocess.run(words, capture_output=True, text=True)


def reference_of(arguments, name, scratch):
    """One pose per scan of the log."""
    if name in KEYFRAMES:
        return [pose for _, pose in read_tum(arguments.data / f"logs_keyframes/{name}.reference.tum")]
    known = arguments.references / f"{name}.tum" if arguments.references else None
    if known and known.exists():
        return [pose for _, pose in read_tum(known)]
    log = scratch / f"{name}.reference.clf"
    write_log(log, *read_log(arguments.data / ANNOTATED[name]))
    done = run(arguments, log, scratch / f"{name}.reference")
    if done.returncode:
        sys.exit(f"{name}: {done.stderr}")
    path = scratch / f"{name}.reference/trajectory_final.tum"
    if known:
        known.parent.mkdir(parents=True, exist_ok=True)
        known.write_bytes(path.read_bytes())
    return [pose for _, pose in read_tum(path)]


def cell(arguments, name, alteration, reference, scratch):
    """What becomes of one log in one alteration, in some ten characters."""
    whole = name.removesuffix(THIN)
    settings, scans = read_log(arguments.data / ANNOTATED.get(whole, f"logs_keyframes/{name}.clf.xz"))
    if whole != name:
        scans = thinned(scans, THIN_M, THIN_RAD)
    scans = ALTERATIONS[alteration](scans, random.Random(f"{alteration} {name}"))
    log, folder = scratch / f"{name}.{alteration}.clf", scratch / f"{name}.{alteration}"
    write_log(log, settings, scans)
    done = run(arguments, log, folder)
    log.unlink()
    if done.returncode not in (0, 4):
        return f"exit {done.returncode} !"
    poses = [pose for _, pose in read_tum(folder / "trajectory_final.tum")]
    if len(poses) != len(scans):
        return f"{len(poses)} poses of {len(scans)} !"
    wanted = [reference[scan.index] for scan in scans]
    if alteration == "mirrored":
        wanted = [(x, -y, -phi) for x, y, phi in wanted]
    error = error_m(poses, wanted)
    events = [row["event"] for row in csv.DictReader((folder / "journal.csv").open())]
    text = f"{error:.3f}" if error < 10 else f"{error:.1f}"
    if error > LOST_M.get(name, USUALLY_LOST_M):
        text += "!"
    counts = [events.count(event) for event in ("lost", "recovered", "apart")]
    if any(counts):
        text += " " + "/".join(map(str, counts))
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-d", dest="data", type=pathlib.Path, default=ROOT / "../shared/data")
    parser.add_argument("-l", dest="logs", default=",".join([*(name + THIN for name in ANNOTATED), *KEYFRAMES]))
    parser.add_argument("-a", dest="alterations", default=",".join(ALTERATIONS))
    parser.add_argument("-m", dest="method", default="graph")
    parser.add_argument("-s", dest="settings", default="")
    parser.add_argument("-r", dest="references", type=pathlib.Path, help="keep the annotated logs' own paths in this folder")
    parser.add_argument("-j", dest="jobs", type=int, default=2)
    parser.add_argument("-p", dest="program", default=str(ROOT / "build/release/apps/rasterslam"))
    parser.add_argument("-o", dest="file", type=pathlib.Path)
    arguments = parser.parse_args()
    logs, alterations = arguments.logs.split(","), arguments.alterations.split(",")
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        scratch = pathlib.Path(folder)
        references = {name: reference_of(arguments, name, scratch) for name in {log.removesuffix(THIN) for log in logs}}
        cells = {(a, name): pool.submit(cell, arguments, name, a, references[name.removesuffix(THIN)], scratch)
                 for a in alterations for name in logs}
        rows = [["", *logs, ""]]
        for a in alterations:
            rows.append([a, *(cells[a, name].result() for name in logs), ALTERATIONS[a].__doc__])
            print("  ".join(rows[-1]), file=sys.stderr, flush=True)
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    table = "\n".join("  ".join(text.ljust(w) for text, w in zip(row, widths)).rstrip() for row in rows)
    lost = sum("!" in text for row in rows[1:] for text in row[1:-1])
    version = subprocess.run([arguments.program, "--version"], capture_output=True, text=True).stdout.strip()
    table = (f"Made by benchmarks/places/altered.py ({version}), method {arguments.method}. Final path, root mean square error (m); "
             f"! is a lost map\n(beyond {USUALLY_LOST_M} m; freiburg-campus 1 m); then lost/found again/never found.\n\n{table}\n\n"
             f"lost maps: {lost} of {len(logs) * len(alterations)}\n")
    print(table, end="")
    if arguments.file:
        arguments.file.write_text(table)


if __name__ == "__main__":
    main()
