#!/usr/bin/env python3
"""Is a map kept in places that nobody looked at? Drives through new buildings, logged as real ones often are distributed.

  benchmarks/places/simulated.py [-n DRIVES] [-s SEED] [-m METHODS] [-j JOBS] [-p PROGRAM] [-o FOLDER]

DRIVES generated buildings (office, hospital, hall, campus; 36 to 154 m long), seeds from SEED on, and with each what its seed
draws: a lidar of 91 to 361 beams over 180 to 270 degrees that sees 8 to 81 m and loses up to a tenth of its readings; wheels that are
up to 5 % too long or short, turn by up to 1.5 degrees a metre where the robot does not, scatter, and slip in one drive of three;
people in two of five. 25 minutes at 0.5 or 0.8 m/s; of the log a scan per 0.3, 0.5 or 1 m, or 0.3 or 0.5 rad, is kept.
Writes FOLDER/places_simulated.csv (a row per drive) and FOLDER/places_simulated.txt: of every method the root mean square error
of the final path, aligned; a map is lost beyond LOST_M.
"""
import argparse
import concurrent.futures
import csv
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from poses import between  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SIZES_M = {"office": (45, 30), "hospital": (70, 35), "hall": (45, 35), "campus": (110, 80)}
BUILDINGS = ["office", "office", "office", "hospital", "hospital", "hospital", "hall", "campus"]
LIDARS = [(180, 181), (180, 181), (180, 361), (180, 91), (240, 241), (270, 271)]  # degrees, beams
STRATEGIES = ["wall_follow", "longest_ray", "random_heading", "quadrant"]
DURATION_S = 1500
LOST_M = 0.5


def drawn(seed):
    """What a seed draws: what the drive is, and what is set for the simulation."""
    chance = random.Random(seed)
    building = chance.choice(BUILDINGS)
    times = chance.uniform(0.8, 1.4)
    fov, beams = chance.choice(LIDARS)
    reach = chance.choice([30, 81] if building == "campus" else [8, 15, 30, 81])
    speed = chance.choice([0.5, 0.8])
    settings = {"lidar.fov_deg": fov, "lidar.beams": beams, "lidar.max_range_m": reach, "lidar.sigma_m": 0.015,
                "lidar.rate_hz": 5, "lidar.drop_out": chance.choice([0.0, 0.02, 0.1]),
                "lidar.mount_x_m": f"{chance.uniform(-0.15, 0.25):.2f}",
                "odometry.scale": f"{chance.uniform(0.95, 1.05):.3f}",
                "odometry.heading_bias_degpm": f"{chance.uniform(-1.5, 1.5):.2f}",
                "odometry.alpha1": chance.choice([0.01, 0.03]), "odometry.alpha3": 0.02,
                "robot.max_speed_mps": speed, "robot.max_turn_rate_degps": 45}
    if chance.random() < 1 / 3:
        settings.update({"odometry.slips_per_m": 0.05, "odometry.slip_m": chance.choice([0.05, 0.1])})
    if chance.random() < 0.4:
        settings["living.people"] = chance.choice([4, 10])
    return {"seed": seed, "building": building, "size_m": "x".join(f"{times * side:.0f}" for side in SIZES_M[building]),
            "lidar": f"{beams} beams {fov} deg {reach} m", "speed_mps": speed, "strategy": chance.choice(STRATEGIES),
            "scan_per_m": chance.choice([0.3, 0.5, 0.5, 1.0]), "scan_per_rad": chance.choice([0.3, 0.5])}, settings


def thin(log, per_m, per_rad):
    """Keeps a scan of a CARMEN log per so much of way or turn."""
    kept, lines = None, []
    for line in log.read_text().splitlines(keepends=True):
        words = line.split()
        if words and words[0] == "PARAM":
            lines.append(line)
        if not words or words[0] != "ROBOTLASER1":
            continue
        behind = 9 + int(words[8])  # the readings; then remissions, and the poses of lidar and robot
        robot = behind + 1 + int(words[behind]) + 3
        pose = tuple(map(float, words[robot:robot + 3]))
        moved = between(kept, pose) if kept else (math.inf, 0, 0)
        if math.hypot(*moved[:2]) > per_m or abs(moved[2]) > per_rad:
            kept = pose
            lines.append(line)
    log.write_text("".join(lines))


def drive(seed, arguments):
    row, settings = drawn(seed)
    with tempfile.TemporaryDirectory() as folder:
        def run(*words, may_fail=False):
            done = subprocess.run([arguments.program, *map(str, words)], cwd=folder, capture_output=True, text=True)
            if done.returncode and not may_fail:
                sys.exit(f"{seed}: {' '.join(map(str, words))}: {done.stderr}")
            return done.stdout

        run("world", "make", row["building"], "-o", "plan.yaml", "--size", row["size_m"], "--seed", seed)
        run("simulate", "plan.yaml", "-o", "whole.rawlog", "-q", "--seed", seed, "--strategy", row["strategy"],
            "--duration", DURATION_S, *[word for key in settings for word in ("--set", f"{key}={settings[key]}")])
        run("convert", "whole.rawlog", "log.clf", "-q")
        thin(pathlib.Path(folder) / "log.clf", row["scan_per_m"], row["scan_per_rad"])
        for method in arguments.methods.split(","):
            result = json.loads(run("run", method, "log.clf", "-o", method, "--seed", seed, "-q", "--json", may_fail=True))
            row.update(scans=result["scans"], way_m=round(result["path_length_m"]))
            scores = json.loads(run("eval", method, "--truth", "whole.gt.tum", "--json"))["scores"]
            error_m = scores["rows"][0]["ate_final_m"]
            row[f"{method}_m"] = round(error_m["value"] if isinstance(error_m, dict) else error_m, 4)
    return row


def table(rows, arguments):
    version = subprocess.run([arguments.program, "--version"], capture_output=True, text=True).stdout.strip()
    text = (f"{version}: benchmarks/places/simulated.py -n {arguments.drives} -s {arguments.seed} -m {arguments.methods}\n"
            f"Error of the final path (root mean square, aligned, m) in {len(rows)} drives; lost: beyond {LOST_M} m.\n\n"
            f"{'method':14}{'median':>8}{'mean':>8}{'90 %':>8}{'largest':>9}{'lost':>6}\n")
    for method in arguments.methods.split(","):
        errors = sorted(row[f"{method}_m"] for row in rows)
        text += (f"{method:14}{statistics.median(errors):8.3f}{statistics.mean(errors):8.3f}"
                 f"{errors[math.ceil(0.9 * len(errors)) - 1]:8.3f}{errors[-1]:9.3f}{sum(e > LOST_M for e in errors):6}\n")
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", dest="drives", type=int, default=40)
    parser.add_argument("-s", dest="seed", type=int, default=1001, help="of the first drive; the next ones count on")
    parser.add_argument("-m", dest="methods", default="graph,particles,icp,naive_wheel")
    parser.add_argument("-j", dest="jobs", type=int, default=2)
    parser.add_argument("-p", dest="program", default=str(ROOT / "build/release/apps/rasterslam"))
    parser.add_argument("-o", dest="folder", type=pathlib.Path, default=ROOT / "benchmarks/results")
    arguments = parser.parse_args()
    arguments.program = str(pathlib.Path(arguments.program).resolve())
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        rows = list(pool.map(lambda seed: drive(seed, arguments), range(arguments.seed, arguments.seed + arguments.drives)))
    arguments.folder.mkdir(parents=True, exist_ok=True)
    with (arguments.folder / "places_simulated.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    text = table(rows, arguments)
    (arguments.folder / "places_simulated.txt").write_text(text)
    print(text, end="")


if __name__ == "__main__":
    main()
