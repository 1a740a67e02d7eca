#!/usr/bin/env python3
"""Fails the n-th write, open, rename, fork or allocation of a command, for every n until the command has no more.

    tests/faults/faults.py PROGRAM SHIM [--short] [--only COMMAND] [--kind KIND]

SHIM is the library of shim.cpp. Each time the command has to end with exit code 1 (3 where an input could not be opened, 4 where
a method's process had no memory; 0 where it can do without), to say why in one line, to leave nothing half-written and
nothing of its own beside, and to leave what was there before as it was. n is 1 to 60, then 1.3 times more each time; --short: few.
Exit code 1 when something broke that.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "fuzz"))
import campaign  # noqa: E402  (the samples)

KINDS = ["write", "open", "rename", "fork", "memory"]
# What differs from run to run.
TIMES = {"manifest.json", "timing.csv", "cost.csv", "cost.json", "run.manifest.json", "cost_summary.txt", "cost_summary.csv",
         "stderr.txt", "report.html"}
# Of a stage that was done before the fault.
PROGRESS = re.compile(rb": (\d+ %|done in .*)$")
S = "../samples"
# Name, words, what it writes (a file or folder), and whether it goes on with --resume.
COMMANDS = [
    ("simulate", ["simulate", f"{S}/room.yaml", "--config", f"{S}/config.ini", "-o", "out.rawlog"], "out.rawlog", False),
    ("run", ["run", "graph", f"{S}/run.rawlog", "-o", "out"], "out", False),
    ("run-particles", ["run", "particles", f"{S}/run.rawlog", "-o", "out"], "out", False),
    ("plugin", ["run", f"{S}/plugin.ini", f"{S}/run.rawlog", "-o", "out"], "out", False),
    ("eval", ["eval", f"{S}/graph", "--truth", f"{S}/run.gt.tum"], "", False),
    ("compare", ["compare", f"{S}/run.rawlog", "--methods", "naive,graph", "-o", "out"], "out", True),
    ("bench", ["bench", f"{S}/suite.ini", "-o", "out"], "out", True),
    ("convert", ["convert", f"{S}/run.rawlog", "out.clf"], "out.clf", False),
    ("convert-bag", ["convert", f"{S}/run.clf", "out.bag"], "out.bag", False),
    ("convert-mcap", ["convert", f"{S}/run.clf", "out.mcap"], "out.mcap", False),
    ("convert-db3", ["convert", f"{S}/run.clf", "out.db3"], "out.db3", False),
    ("info", ["info", f"{S}/run.rawlog"], "", False),
    ("info-bag", ["info", f"{S}/run.bag"], "", False),
    ("check", ["check", f"{S}/run.rawlog"], "", False),
    ("cut", ["cut", f"{S}/run.rawlog", "--from", "0.5", "--to", "2", "-o", "out.rawlog"], "out.rawlog", False),
    ("filter", ["filter", f"{S}/run.rawlog", "--every", "2", "-o", "out.rawlog"], "out.rawlog", False),
    ("plot", ["plot", "map", f"{S}/graph", "-o", "out.png"], "out.png", False),
    ("relations", ["relations", f"{S}/run.gt.tum", "--step", "0.1", "-o", "out.relations"], "out.relations", False),
    ("report", ["report", f"{S}/compared", "-o", "report.html"], "report.html", False),
    ("graph", ["graph", "optimise", f"{S}/graph/graph.g2o", "-o", "out.g2o"], "out.g2o", False),
    ("explore", ["explore", f"{S}/room.yaml", "--config", f"{S}/config.ini", "-o", "out"], "out", False),
    ("world-make", ["world", "make", "flat", "-o", "out.yaml"], "out.yaml", False),
    ("world-check", ["world", "check", f"{S}/room.yaml"], "", False),
    ("list", ["list", "methods"], "", False),
]
SHORT = {"simulate": ["write", "rename", "open"], "run": ["write", "rename"], "relations": ["open"],
         "plugin": ["fork"]}


def contents(path):
    """Every file below a path that is the same in every run, with its bytes."""
    if os.path.isfile(path):
        return {os.path.basename(path): b"" if os.path.basename(path) in TIMES else open(path, "rb").read()}
    files = {}
    for folder, _, names in os.walk(path):
        for name in names:
            file = os.path.join(folder, name)
            files[os.path.relpath(file, path)] = b"" if name in TIMES else open(file, "rb").read()
    return files


def state(folder):
    return {(os.path.join(at, name), os.stat(os.path.join(at, name)).st_mtime_ns)
            for at, _, names in os.walk(folder) for name in names}


class Faults:
    def __init__(self, program, shim, scratch):
        self.program, self.shim, self.scratch = os.path.abspath(program), os.path.abspath(shim), scratch
        self.work = f"{scratch}/work"
        self.mark = f"{scratch}/mark"
        self.tried = self.broken = 0

    def run(self, words, fault=""):
        environment = dict(os.environ)
        if fault:
            environment.update(LD_PRELOAD=self.shim, RASTERSLAM_FAULT=f"{fault}:{self.mark}")
        try:
            done = subprocess.run([self.program, *words], cwd=self.work, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, env=environment, timeout=120)
            return done.returncode, done.stderr, done.stdout
        except subprocess.TimeoutExpired:
            return -99, b"", b""

    def fresh(self):
        shutil.rmtree(self.work, ignore_errors=True)
        os.mkdir(self.work)
        if os.path.exists(self.mark):
            os.remove(self.mark)

    def judge(self, name, words, output, resumes, fault, whole, printed):
        """What this fault broke; None where the command has no such call."""
        self.fresh()
        before = state(f"{self.scratch}/samples")
        code, said, out = self.run(words, fault)
        if not os.path.exists(self.mark):
            return None
        wrong = []
        kind = fault.split(":")[0].rstrip("+")
        has_method = name in ("compare", "bench", "plugin") or (name.startswith("run") and kind == "memory")
        allowed = {0, 1} | ({3} if kind == "open" else set()) | ({4, 6} if has_method else set())
        if code not in allowed:
            wrong.append(f"exit code {code}")
        lines = [line for line in said.split(b"\n") if line and not PROGRESS.search(line)]
        if code in (1, 3) and (len(lines) != 1 or not lines[0].startswith(b"rasterslam: ") or len(lines[0]) > campaign.LONGEST_LINE):
            wrong.append(f"said {said[:300]!r}")
        left = [file for file in os.listdir(self.work) if ".rasterslam-" in file or file.endswith(".lock")]
        if left:
            wrong.append(f"left {left}")
        made = contents(f"{self.work}/{output}") if output else {}
        if code == 0 and output and made != whole:
            wrong.append("exit code 0 with another result: " +
                         str([file for file in set(made) | set(whole) if made.get(file) != whole.get(file)][:3]))
        if code == 0 and not output and out != printed:
            wrong.append("exit code 0 and printed something else")
        if code not in (0, 4, 6) and made and made != whole and not resumes:
            wrong.append("half-written: " + str([file for file in whole if made.get(file) != whole[file]][:3]))
        if state(f"{self.scratch}/samples") != before:
            wrong.append("its input is not as it was")
        if resumes and code != 0:
            again, said_again, _ = self.run(words + ["--resume"] + ["--retry"] * (name == "bench"))
            if again != 0 or contents(f"{self.work}/{output}") != whole:
                wrong.append(f"--resume: exit code {again}, {said_again[:200]!r}")
        if wrong:
            wrong.append(f"(it said {said[:200]!r}, exit code {code})")
        return ", ".join(wrong)

    def attack(self, name, words, output, resumes, kinds, short):
        words = words + (["-q"] if output else [])
        self.fresh()
        code, said, printed = self.run(words)
        if code != 0:
            print(f"{name}: exit code {code} without a fault: {said.decode(errors='replace')}")
            self.broken += 1
            return
        whole = contents(f"{self.work}/{output}") if output else {}
        for kind in kinds:
            n, tried = 1, 0
            while True:
                wrong = self.judge(name, words, output, resumes, f"{kind}:{n}", whole, printed)
                if wrong is None:
                    break
                self.tried += 1
                tried += 1
                if wrong:
                    self.broken += 1
                    print(f"{name}: {kind} {n}: {wrong}", flush=True)
                n = max(n + 1, int(n * 2.5)) if short else n + 1 if n < 60 else int(n * 1.3)
            print(f"{name}: {kind}: {tried} faults", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("shim")
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--kind", default="")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        os.mkdir(f"{scratch}/samples")
        campaign.make_samples(os.path.abspath(arguments.program), f"{scratch}/samples")
        faults = Faults(arguments.program, arguments.shim, scratch)
        for name, words, output, resumes in COMMANDS:
            if (arguments.only and name != arguments.only) or (arguments.short and name not in SHORT):
                continue
            kinds = [arguments.kind] if arguments.kind else SHORT[name] if arguments.short else KINDS
            faults.attack(name, words, output, resumes, kinds, arguments.short)
        print(f"{faults.tried} faults, {faults.broken} broke a promise")
        return 1 if faults.broken else 0


if __name__ == "__main__":
    sys.exit(main())
