#!/usr/bin/env python3
"""What a second thread is worth: `run` with --threads 1 and 2 on real logs, by turns; what comes out must be the same, to the byte.

  benchmarks/threads/threads.py PROGRAM DATA [-r ROUNDS] > benchmarks/results/threads.txt

DATA: folder with logs/ and logs_keyframes/ as docs/real-logs.md names them. Of each figure the least of the rounds: of the command the
time by the clock; of a scan the CPU time of the thread that takes it in (timing.csv): mean, 99 of 100, the longest; of all threads
together the mean; and the memory.
"""
import argparse
import csv
import hashlib
import json
import pathlib
import subprocess
import tempfile
import time

LOGS = ["logs/intel/intel.clf.bz2", "logs/fr079/fr079.clf.bz2", "logs/mit-killian/mit-killian.reconstructed.clf.xz",
        *(f"logs_keyframes/{name}.clf.xz" for name in ("fhw", "acapulco", "freiburg-campus"))]
RUNS = [("graph", log) for log in LOGS] + [("particles", LOGS[0])]
VARIES = {"timing.csv", "manifest.json"}  # times stand in them


def measure(program, method, log, threads, folder):
    begin_s = time.monotonic()
    subprocess.run([program, "run", method, log, "-o", folder, "--threads", str(threads), "-q"], check=True, capture_output=True)
    seconds = time.monotonic() - begin_s
    times = sorted(float(row["cpu_ms"]) for row in csv.DictReader((folder / "timing.csv").open()))
    manifest = json.loads((folder / "manifest.json").read_text())
    return {"clock s": seconds, "mean ms": sum(times) / len(times), "p99 ms": times[int(0.99 * len(times))], "worst ms": times[-1],
            "all threads ms": manifest["times_s"]["mean_ms_per_scan"], "MB": float(manifest["results"]["peak_memory_mb"])}


def bytes_of(folder):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir() if path.name not in VARIES}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("-r", "--rounds", type=int, default=3)
    arguments = parser.parse_args()
    version = subprocess.run([arguments.program, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    print(f"Made by benchmarks/threads/threads.py -r {arguments.rounds}, {version}.\n")
    header = None
    for method, log in RUNS:
        best, first = {}, None
        for turn in range(arguments.rounds):
            for threads in (1, 2) if turn % 2 == 0 else (2, 1):
                with tempfile.TemporaryDirectory() as temporary:
                    folder = pathlib.Path(temporary) / "run"
                    figures = measure(arguments.program, method, arguments.data / log, threads, folder)
                    first = first or bytes_of(folder)
                    if bytes_of(folder) != first:
                        raise SystemExit(f"{method} on {log}: {threads} threads give other bytes")
                known = best.setdefault(threads, figures)
                best[threads] = {key: min(known[key], value) for key, value in figures.items()}
        if header is None:
            header = ["method", "log", "threads", *best[1]]
            print("  ".join(f"{name:>{max(len(name), 15 if name == 'log' else 9)}}" for name in header))
        for threads, figures in sorted(best.items()):
            row = [method, pathlib.Path(log).name.split(".")[0], threads, *(f"{value:.3g}" for value in figures.values())]
            print("  ".join(f"{value:>{max(len(name), 15 if name == 'log' else 9)}}" for name, value in zip(header, row)), flush=True)


if __name__ == "__main__":
    main()
