#!/usr/bin/env python3
"""Runs the commands that a page of the documentation prints.

  tests/docs/run_blocks.py PROGRAM PAGE.md [SECONDS]

Every block marked ```sh is run by bash in the order of the page, all in one scratch folder, with the folder of PROGRAM
first on the PATH and the folders that commands name (configs, .github) at hand. Each block must end with exit code 0, and
each file that it names after -o must be there then. A block may take SECONDS (200). One that cannot
be run says why in the line above it:

  <!-- not run: opens a window -->

and one that is meant to fail says how:

  <!-- exit code: 3 -->

A command in a table, `rasterslam ...`, has to begin a line of a block that is run, so that it is tried, too; but for view,
which opens a window.

Exit code 1 and one line per failure otherwise.
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def blocks(text):
    """(line, mark above it or "", commands) of each block of commands."""
    lines = text.split("\n")
    inside, start, taken = None, 0, []
    for number, line in enumerate(lines, 1):
        if inside is None and line.startswith("```"):
            inside, start, taken = line[3:].strip(), number, []
        elif inside is not None and line.startswith("```"):
            if inside == "sh":
                above = next((l for l in reversed(lines[: start - 1]) if l.strip()), "")
                mark = re.fullmatch(r"<!-- (not run: .+|exit code: \d+) -->", above.strip())
                yield start, mark.group(1) if mark else "", "\n".join(taken)
            inside = None
        elif inside is not None:
            taken.append(line)


def untried(text, tried):
    """Commands in tables that begin none of the lines that were run."""
    for row in (line for line in text.split("\n") if line.startswith("|")):
        for command in re.findall(r"`(rasterslam [^`]+)`", row):
            words = command.split()
            if words[1] == "view" or any(line.split()[: len(words)] == words for line in tried):
                continue
            yield command


def outputs(commands):
    """What the commands were told to write with -o."""
    for line in commands.split("\n"):
        words = shlex.split(line, comments=True)
        for flag, name in zip(words, words[1:]):
            if flag in ("-o", "--output"):
                yield name


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    limit_s = int(sys.argv[3]) if len(sys.argv) == 4 else 200
    program, page = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    text, problems, run, tried = page.read_text(encoding="utf-8"), [], 0, []
    with tempfile.TemporaryDirectory() as scratch:
        for name in ("configs", ".github", "benchmarks", "docs"):
            os.symlink(ROOT / name, pathlib.Path(scratch) / name)
        env = dict(os.environ, PATH=f"{program.parent}:{os.environ['PATH']}", LC_ALL="C.UTF-8")
        for line, mark, commands in blocks(text):
            if mark.startswith("not run"):
                continue
            expected = int(mark.split(":")[1]) if mark else 0
            run += 1
            tried += commands.split("\n")
            place = f"{page.name}:{line}"
            try:
                done = subprocess.run(["bash", "-euo", "pipefail", "-c", commands], cwd=scratch, env=env,
                                      stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                      timeout=limit_s)
            except subprocess.TimeoutExpired:
                problems.append(f"{place}: not done after {limit_s} s")
                break
            if done.returncode != expected:
                tail = done.stdout.decode(errors="replace").strip().split("\n")[-3:]
                problems.append(f"{place}: exit code {done.returncode}, expected {expected}: " + " | ".join(tail))
                break
            missing = [name for name in outputs(commands) if not (pathlib.Path(scratch) / name).exists()]
            if missing and expected == 0:
                problems.append(f"{place}: did not write {', '.join(missing)}")
    problems += [f"{page.name}: `{command}` in a table begins no command that is run" for command in untried(text, tried)]
    if run == 0:
        problems.append(f"{page.name}: has no block that is run")
    print(f"{page.name}: {run} blocks run")
    sys.exit("\n".join(problems) if problems else 0)


if __name__ == "__main__":
    main()
