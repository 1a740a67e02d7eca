#!/usr/bin/env python3
"""Damages small files of every format that the program reads and checks what it makes of them.

    tests/fuzz/campaign.py PROGRAM [--mutations 50] [--seed 1] [--only FORMAT] [--keep FOLDER]

Each damaged file is read by a command. That has to end with a documented exit code, within the time and the memory below,
and to say what is wrong in one printable line: the program's name and a message of at most 300 bytes. What breaks that is printed, and kept in FOLDER.
Exit code 1 when there was any.
"""
import argparse
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

CODES = {0, 1, 2, 3, 4, 5, 6}
LONGEST_LINE = len("rasterslam: ") + 300
MOST_MB = 1500
MOST_CPU_S = 20
MOST_S = 120  # of the clock: for what waits without an end

# Of every format: the file to damage, inside the folder of samples, and the command that reads it. A folder behind `in` is
# copied whole, and the damaged file stands in it. {file}, {folder}, {out} and {samples} are replaced.
FORMATS = [
    ("rawlog", "plain.rawlog", ["info", "{file}"]),
    ("rawlog-run", "plain.rawlog", ["run", "naive", "{file}", "-o", "{out}"]),
    ("rawlog-observations", "observations.rawlog", ["check", "{file}"]),
    ("rawlog-rare", "rare.rawlog", ["info", "{file}"]),
    ("rawlog-gz", "run.rawlog", ["info", "{file}"]),
    ("rawlog-bz2", "run.rawlog.bz2", ["info", "{file}"]),
    ("rawlog-xz", "run.rawlog.xz", ["info", "{file}"]),
    ("carmen", "run.clf", ["info", "{file}"]),
    ("carmen-run", "run.clf", ["run", "graph", "{file}", "-o", "{out}"]),
    ("bag", "run.bag", ["info", "{file}"]),
    ("mcap", "run.mcap", ["info", "{file}"]),
    ("db3", "run.db3", ["info", "{file}"]),
    ("convert", "run.clf", ["convert", "{file}", "{out}.rawlog"]),
    ("truth", "run.gt.tum", ["eval", "{samples}/graph", "--truth", "{file}"]),
    ("relations", "run.relations", ["eval", "{samples}/graph", "--relations", "{file}"]),
    ("g2o", "graph/graph.g2o", ["graph", "optimise", "{file}", "-o", "{out}.g2o"]),
    ("method", "graph.ini", ["run", "{file}", "{samples}/run.rawlog", "-o", "{out}"]),
    ("plugin", "plugin.ini", ["plugin", "check", "{file}", "{samples}/run.rawlog"]),
    ("config", "config.ini", ["simulate", "{samples}/room.png", "--config", "{file}", "--duration", "1", "-o", "{out}.rawlog"]),
    ("suite", "suite.ini", ["bench", "{file}", "-o", "{out}"]),
    ("png", "room.png", ["world", "check", "{file}"]),
    ("bmp", "room.bmp", ["world", "check", "{file}"]),
    ("pgm", "room.pgm", ["simulate", "{file}", "--duration", "1", "-o", "{out}.rawlog"]),
    ("yaml", "room.yaml", ["simulate", "{file}", "--duration", "1", "-o", "{out}.rawlog"]),
    ("operations", "run.operations.txt", ["plot", "operations", "{file}", "-o", "{out}.png"]),
    ("simplemap", "graph/map.simplemap", ["run", "graph", "{samples}/run.rawlog", "--localise", "{file}", "-o", "{out}"]),
    ("gridmap", "graph/map.gridmap.gz", ["run", "graph", "{samples}/run.rawlog", "--localise", "{file}", "-o", "{out}"]),
    ("scene", "graph/map.3Dscene", ["eval", "{folder}", "--truth", "{samples}/run.gt.tum"]),
    ("manifest", "graph/manifest.json", ["eval", "{folder}"]),
    ("path", "graph/trajectory.tum", ["eval", "{folder}"]),
    ("result", "graph/manifest.json", ["report", "{folder}", "-o", "{out}.html"]),
    ("journal", "graph/journal.csv", ["report", "{folder}", "-o", "{out}.html"]),
    ("scores", "compared/scores.json", ["report", "{folder}", "-o", "{out}.html"]),
    ("comparison", "compared/manifest.json", ["report", "{folder}", "-o", "{out}.html"]),
    ("sweep-plan", "swept/plan.json", ["report", "{folder}", "-o", "{out}.html"]),
]

# An observation of another sensor, a battery of two cells, as MRPT writes it: its reader trusts the number of cells.
BATTERY = bytes.fromhex(
    "a36d7270743a3a6f62733a3a434f62736572766174696f6e42617474657279537461746502" + "00" * 18 + "02" + "00" * 9 + "0840"
    + "00" * 6 + "0840" + "00" * 8 + "d15d6d53487fdd0188")

SUITE = """[suite]
worlds = {samples}/room.png
methods = naive
seeds = 1
[simulation]
duration_s = 2
"""


def make_samples(program, folder):
    """Small files of every format, by the program itself and the packers that are here."""
    from base64 import b64decode  # noqa: F401  (the pictures are drawn below)

    def run(*words):
        done = subprocess.run([program, *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        if done.returncode:
            print(f"campaign: no sample from: {' '.join(words)}: {done.stderr.decode(errors='replace').strip()}")

    size, wall = 120, 4
    rows = [bytes(0 if min(x, y, size - 1 - x, size - 1 - y) < wall or (40 < x < 52 and y < 70) else 255
                  for x in range(size)) for y in range(size)]
    pgm = b"P5\n%d %d\n255\n" % (size, size) + b"".join(rows)
    open(f"{folder}/room.pgm", "wb").write(pgm)
    header = b"BM" + (54 + 1024 + size * size).to_bytes(4, "little") + bytes(4) + (54 + 1024).to_bytes(4, "little")
    header += (40).to_bytes(4, "little") + size.to_bytes(4, "little") * 2 + (1).to_bytes(2, "little")
    header += (8).to_bytes(2, "little") + bytes(24)
    colours = b"".join(bytes([i, i, i, 0]) for i in range(256))
    open(f"{folder}/room.bmp", "wb").write(header + colours + b"".join(reversed(rows)))
    import struct
    import zlib

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    open(f"{folder}/room.png", "wb").write(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 0, 0, 0, 0))
        + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))
    open(f"{folder}/room.yaml", "w").write(
        "image: room.pgm\nresolution: 0.05\norigin: [0.0, 0.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n")
    open(f"{folder}/config.ini", "w").write("[simulation]\nduration_s = 3\n[lidar]\nbeams = 61\nmax_range_m = 8\n")
    open(f"{folder}/graph.ini", "w").write("[method]\ntype = graph\n[graph]\nkeyframe_distance_m = 0.4\n")
    open(f"{folder}/plugin.ini", "w").write(
        "[method]\ntype = external\ntime_limit_s = 5\nmemory_limit_mb = 200\n"
        "command = awk '{ print $1, $2, $3, 0, 0, 0, sin($4/2), cos($4/2) }' {scans} > {output}\n")
    open(f"{folder}/suite.ini", "w").write(SUITE.format(samples=folder))
    run("simulate", "room.yaml", "--config", "config.ini", "-o", "run.rawlog", "--seed", "3")
    run("relations", "run.gt.tum", "-o", "run.relations", "--step", "0.1")
    run("convert", "run.rawlog", "observations.rawlog", "--form", "observation")
    for suffix in ("clf", "bag", "mcap", "db3"):
        run("convert", "run.rawlog", f"run.{suffix}")
    for name in ("run.rawlog", "observations.rawlog"):
        import gzip
        plain = gzip.open(f"{folder}/{name}").read()
        open(f"{folder}/{'plain.rawlog' if name == 'run.rawlog' else name}", "wb").write(plain)
        if name == "observations.rawlog":
            open(f"{folder}/rare.rawlog", "wb").write(BATTERY * 3 + plain)
        if name == "run.rawlog":
            import bz2
            import lzma
            open(f"{folder}/run.rawlog.bz2", "wb").write(bz2.compress(plain))
            open(f"{folder}/run.rawlog.xz", "wb").write(lzma.compress(plain))
    run("run", "graph", "run.rawlog", "-o", "graph")
    run("compare", "run.rawlog", "-o", "compared", "--methods", "naive,icp")
    run("bench", "suite.ini", "-o", "swept")


TEXT = re.compile(rb"[\t\n\r -~]")


def damage(data, draw):
    """One to four changes of a kind that finds something."""
    data = bytearray(data)
    for _ in range(draw.choice((1, 1, 2, 4))):
        size = max(1, len(data))
        at = draw.randrange(size)
        kind = draw.randrange(10)
        if kind == 0 and data:
            data[at] ^= 1 << draw.randrange(8)
        elif kind == 1 and data:
            data[at] = draw.randrange(256)
        elif kind == 2:  # a size or count of all sizes
            value = draw.choice((0, 1, 2**15, 2**24, 2**31 - 1, 2**31, 2**32 - 1, 2**30))
            data[at:at + 4] = value.to_bytes(4, "little")
        elif kind == 3:
            data[at:at + 8] = draw.choice((b"\xff" * 8, b"\0" * 8, b"\xff" * 7 + b"\x7f", b"\0\0\0\0\0\0\xf0\x7f"))
        elif kind == 4:
            del data[at:]
        elif kind == 5:
            del data[at:at + draw.randrange(1, 64)]
        elif kind == 6:  # a piece once more
            piece = data[at:at + draw.randrange(1, 400)]
            data[at:at] = piece * draw.choice((1, 2, 50))
        elif kind == 7:
            data[at:at] = draw.choice((b"A" * 5000, b"\x1b[31m\x07", b"\n" * 300, b"9" * 400, b"[" * 20000, b"{\"a\":" * 5000,
                                       b"-1", b"nan", b"1e308", b"1e999", b"\xff\xfe\x80", b"%s%n", b"../../"))
        elif kind == 8:  # a number by another one
            numbers = list(re.finditer(rb"-?\d+\.?\d*", bytes(data[:200000])))
            if numbers:
                number = draw.choice(numbers)
                data[number.start():number.end()] = draw.choice(
                    (b"-1", b"0", b"1e300", b"nan", b"inf", b"99999999999", b"-99999999999", b"1e-300", b"", b"x", b"2147483648"))
        else:  # a line elsewhere, or gone
            lines = bytes(data).split(b"\n")
            if len(lines) > 2:
                line = lines.pop(draw.randrange(len(lines)))
                if draw.random() < 0.5:
                    lines.insert(draw.randrange(len(lines)), line)
                data = bytearray(b"\n".join(lines))
    return bytes(data)


def limits():
    os.setsid()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (2 * MOST_CPU_S, 2 * MOST_CPU_S))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))
    os.nice(5)


def judge(command, work, codes):
    """What the command broke, in words; "" when nothing."""
    with open(f"{work}/said", "wb") as said, open(f"{work}/printed", "wb") as printed:
        child = subprocess.Popen(command, cwd=work, stdin=subprocess.DEVNULL, stdout=printed, stderr=said, preexec_fn=limits)
        begun, waited = time.monotonic(), 0
        while waited == 0:
            waited, status, usage = os.wait4(child.pid, os.WNOHANG)
            if waited == 0:
                if time.monotonic() - begun > MOST_S:
                    os.killpg(child.pid, 9)
                time.sleep(0.005)
        child.returncode = os.waitstatus_to_exitcode(status)
    text = open(f"{work}/said", "rb").read()
    wrong = []
    if child.returncode not in codes:
        wrong.append(f"exit code {child.returncode}")
    if usage.ru_utime + usage.ru_stime > MOST_CPU_S or time.monotonic() - begun > MOST_S:
        wrong.append(f"{usage.ru_utime + usage.ru_stime:.0f} s of CPU")
    if usage.ru_maxrss / 1024 > MOST_MB:
        wrong.append(f"{usage.ru_maxrss / 1024:.0f} MB")
    lines = text.split(b"\n")[:-1] if text.endswith(b"\n") else text.split(b"\n")
    own = [line for line in lines if line.startswith(b"rasterslam: ")]
    if child.returncode not in (0, 4, 5, 6) and len(own) != 1 and "check" not in command[1:3]:  # which has findings instead
        wrong.append(f"{len(own)} lines of errors")
    if any(len(line) > LONGEST_LINE for line in lines):
        wrong.append(f"a line of {max(map(len, lines))} bytes")
    for name, what in (("said", text), ("printed", open(f"{work}/printed", "rb").read())):
        if any(not (c == 9 or c == 10 or c == 13 or 32 <= c < 127 or c >= 128) for c in what):
            wrong.append(f"control bytes {name}")
        try:
            what.decode()
        except UnicodeDecodeError:
            wrong.append(f"bytes that are no UTF-8 {name}")
    if wrong and own:
        wrong.append("it said: " + own[0][:200].decode(errors="backslashreplace"))
    return ", ".join(wrong)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--mutations", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--keep", default="")
    arguments = parser.parse_args()
    program = os.path.abspath(arguments.program)
    broken = tried = 0
    with tempfile.TemporaryDirectory() as scratch:
        samples = f"{scratch}/samples"
        os.mkdir(samples)
        make_samples(program, samples)
        for name, sample, words in FORMATS:
            if arguments.only and arguments.only != name:
                continue
            if not os.path.exists(f"{samples}/{sample}"):
                print(f"{name}: no sample {sample}")
                broken += 1
                continue
            data = open(f"{samples}/{sample}", "rb").read()
            draw = random.Random(f"{arguments.seed} {name}")
            here = 0
            for number in range(arguments.mutations):
                work = f"{scratch}/work"
                os.mkdir(work)
                if "/" in sample and "{folder}" in words:
                    folder = f"{work}/{sample.split('/')[0]}"
                    shutil.copytree(f"{samples}/{sample.split('/')[0]}", folder)
                else:
                    folder = work
                    for beside in ("room.pgm",):
                        shutil.copy(f"{samples}/{beside}", work)
                file = f"{folder}/{os.path.basename(sample)}"
                with open(file, "wb") as out:
                    out.write(damage(data, draw) if number else data)
                fill = {"{file}": file, "{folder}": folder, "{out}": f"{work}/out", "{samples}": samples}
                command = [program]
                for word in words:
                    for key, value in fill.items():
                        word = word.replace(key, value)
                    command.append(word)
                # The first is whole.
                wrong = judge(command + ["-q"] * ("-o" in words), work, CODES if number else {0, 4} if "--localise" in words else {0})
                tried += 1
                if wrong:
                    broken += 1
                    here += 1
                    print(f"{name} {number}: {wrong}", flush=True)
                    if arguments.keep:
                        os.makedirs(arguments.keep, exist_ok=True)
                        shutil.copy(file, f"{arguments.keep}/{name}-{number}-{os.path.basename(sample)}")
                shutil.rmtree(work)
            print(f"{name}: {arguments.mutations} tried, {here} broke a promise", flush=True)
    print(f"{tried} damaged files, {broken} broke a promise")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
