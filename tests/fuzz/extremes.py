#!/usr/bin/env python3
"""Gives every key of every configuration values that nobody means, one at a time, and checks what the program makes of them.

    tests/fuzz/extremes.py PROGRAM [--only COMMAND] [--keys TEXT]

The commands, their keys, and the judgement are those of --print-config and of campaign.py: a documented exit code, one printable line, its limits of
time and memory. Exit code 1 when something broke that.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import campaign  # noqa: E402  (samples and judgement)

VALUES = ["-1", "0", "1", "1e-300", "1e9", "1e300", "nan", "inf", "-inf", "2147483648", "18446744073709551616", "", "x", "true", "0x10",
          "1e-9", "0.5", "-1e300", "99999"]
# Name, words before the settings; {samples} and {out} are replaced.
COMMANDS = [
    ("simulate", ["simulate", "{samples}/room.png", "--duration", "2", "-o", "{out}.rawlog"]),
    ("explore", ["explore", "{samples}/room.png", "--duration", "2", "-o", "{out}"]),
    ("graph", ["run", "graph", "{samples}/run.rawlog", "-o", "{out}"]),
    ("particles", ["run", "particles", "{samples}/run.rawlog", "-o", "{out}"]),
    ("icp", ["run", "icp", "{samples}/run.rawlog", "-o", "{out}"]),
    ("rbpf", ["run", "rbpf", "{samples}/run.rawlog", "-o", "{out}"]),
    ("naive", ["run", "naive", "{samples}/run.rawlog", "-o", "{out}"]),
]


def keys_of(program, words):
    """section.key of everything that the command can be told."""
    printed = subprocess.run([program, *words, "--print-config"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    section, keys = "", []
    for line in printed.stdout.split("\n"):
        if match := re.match(r"\[(.*)\]", line):
            section = match[1]
        elif match := re.match(r"(\w+) *=", line):
            keys.append(f"{section}.{match[1]}")
    if not keys:
        sys.exit(f"extremes: no keys from: {' '.join(words)}: {printed.stderr.strip()}")
    return keys


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--only", default="")
    parser.add_argument("--keys", default="", help="those that this is in")
    arguments = parser.parse_args()
    program = os.path.abspath(arguments.program)
    broken = tried = 0
    with tempfile.TemporaryDirectory() as scratch:
        samples, work = f"{scratch}/samples", f"{scratch}/work"
        os.mkdir(samples)
        campaign.make_samples(program, samples)
        for name, words in COMMANDS:
            if arguments.only not in ("", name):
                continue
            words = [word.format(samples=samples, out=f"{work}/out") for word in words]
            for key in keys_of(program, words):
                if arguments.keys not in key:
                    continue
                for value in VALUES:
                    shutil.rmtree(work, ignore_errors=True)
                    os.mkdir(work)
                    wrong = campaign.judge([program, *words, "--set", f"{key}={value}"], work, campaign.CODES)
                    tried += 1
                    if wrong:
                        broken += 1
                        print(f"{name} {key}={value}: {wrong}", flush=True)
            print(f"{name}: {tried} values so far, {broken} broke a promise", flush=True)
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
