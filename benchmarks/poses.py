"""Poses in the plane, each x (m), y (m), heading (rad): what the scripts of benchmarks do with them."""

import math


def wrapped(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


def between(a, b):
    """The pose b as seen from a."""
    dx, dy, c, s = b[0] - a[0], b[1] - a[1], math.cos(a[2]), math.sin(a[2])
    return c * dx + s * dy, -s * dx + c * dy, wrapped(b[2] - a[2])


def compose(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    return a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], wrapped(a[2] + b[2])


def read_tum(path):
    """Stamp and pose of each line of a TUM file, a pathlib.Path."""
    poses = []
    for line in path.read_text().splitlines():
        if line and not line.startswith("#"):
            t, x, y, _, _, _, qz, qw = map(float, line.split())
            poses.append((t, (x, y, 2 * math.atan2(qz, qw))))
    return poses
