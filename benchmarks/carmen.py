"""CARMEN logs as the scripts of benchmarks change them: their settings and the lines FLASER."""

import bz2
import lzma


class Scan:
    """A line FLASER: readings (m), the wheels' pose, the stamp (s), and which scan of the log it is."""

    def __init__(self, ranges, pose, stamp, index):
        self.ranges, self.pose, self.stamp, self.index = ranges, pose, stamp, index


def read_log(path):
    opener = {".bz2": bz2.open, ".xz": lzma.open}[path.suffix]
    settings, scans = [], []
    with opener(path, "rt") as file:
        for line in file:
            words = line.split()
            if words and words[0] == "PARAM":
                settings.append(line.rstrip())
            if words and words[0] == "FLASER":
                n = int(words[1])
                scans.append(Scan([float(r) for r in words[2:2 + n]], tuple(map(float, words[5 + n:8 + n])),
                                  float(words[8 + n]), len(scans)))
    return settings, scans


def write_log(path, settings, scans):
    with path.open("w") as file:
        for line in settings:
            print(line, file=file)
        for scan in scans:
            pose = " ".join(f"{v:.6f}" for v in scan.pose)
            print("FLASER", len(scan.ranges), *(f"{r:.2f}" for r in scan.ranges), pose, pose, f"{scan.stamp:.6f}", "host",
                  f"{scan.stamp:.6f}", file=file)
