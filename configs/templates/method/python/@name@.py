"""@name@: a SLAM method. A log goes in, a pose for every scan comes out.

    python3 @name@.py LOG SCANS OUTPUT

LOG is a CARMEN log, SCANS a text with a line `stamp x y yaw` per scan (the wheels' dead reckoning), OUTPUT the path to write as
`time x y z qx qy qz qw` per line. Poses are (x, y, yaw) in metres and radians, x ahead, y to the left, counter-clockwise positive;
T_a_b takes coordinates in b to a.
"""
import math
import sys
from collections import namedtuple

Scan = namedtuple("Scan", "time T_odom_robot points")  # points: (x, y) of the returns in the robot's frame


def compose(T_a_b, T_b_c):
    """T_a_c."""
    x, y, yaw = T_a_b
    u, v, turn = T_b_c
    c, s = math.cos(yaw), math.sin(yaw)
    return (x + c * u - s * v, y + s * u + c * v, wrapped(yaw + turn))


def between(T_a_b, T_a_c):
    """T_b_c: where c is, seen from b."""
    dx, dy = T_a_c[0] - T_a_b[0], T_a_c[1] - T_a_b[1]
    c, s = math.cos(T_a_b[2]), math.sin(T_a_b[2])
    return (c * dx + s * dy, -s * dx + c * dy, wrapped(T_a_c[2] - T_a_b[2]))


def wrapped(angle):
    """The same angle in [-pi, pi]."""
    return math.atan2(math.sin(angle), math.cos(angle))


def moved(T_a_b, points):
    """Points in b, in a."""
    x, y, yaw = T_a_b
    c, s = math.cos(yaw), math.sin(yaw)
    return [(x + c * u - s * v, y + s * u + c * v) for u, v in points]


# ---- Edit here -------------------------------------------------------------------------------------------------------------------


def correct(previous_points, points, T_previous_current):
    """A better T_previous_current than the wheels' one, from the points of two scans, each in its own robot frame.

    As it stands it believes the wheels. Align `points` with `previous_points` here (ICP, say), starting at the wheels' guess.
    """
    return T_previous_current


# ----------------------------------------------------------------------------------------------------------------------------------


def estimate(scans):
    """T_map_robot at every scan; the map's frame is the robot's at the first one."""
    path = []
    for i, scan in enumerate(scans):
        if i == 0:
            path.append((0.0, 0.0, 0.0))
            continue
        before = scans[i - 1]
        guess = between(before.T_odom_robot, scan.T_odom_robot)
        path.append(compose(path[-1], correct(before.points, scan.points, guess)))
    return path


def points_of(words):
    """The returns of a ROBOTLASER line, split at blanks, in the robot's frame. Readings that met nothing, or were lost, are left out."""
    first_angle, step, max_range = float(words[2]), float(words[4]), float(words[5])
    count = int(words[8])
    ranges = [float(word) for word in words[9 : 9 + count]]
    after = 9 + count
    after += 1 + int(words[after])  # remissions
    T_odom_lidar = tuple(float(word) for word in words[after : after + 3])
    T_odom_robot = tuple(float(word) for word in words[after + 3 : after + 6])
    returns = []
    for i, r in enumerate(ranges):
        if 0 < r < 0.99 * max_range:
            angle = first_angle + i * step
            returns.append((r * math.cos(angle), r * math.sin(angle)))
    return moved(between(T_odom_robot, T_odom_lidar), returns)


def read_scans(log_path, scans_path):
    with open(scans_path, encoding="utf-8") as lines:
        wheels = [[float(word) for word in line.split()] for line in lines if line.strip()]
    with open(log_path, encoding="utf-8") as lines:
        points = [points_of(line.split()) for line in lines if line.startswith("ROBOTLASER")]
    return [Scan(w[0], tuple(w[1:4]), p) for w, p in zip(wheels, points)]


def write_path(path, scans, output_path):
    with open(output_path, "w", encoding="utf-8") as output:
        for scan, (x, y, yaw) in zip(scans, path):
            output.write(f"{scan.time:.6f} {x:.6f} {y:.6f} 0 0 0 {math.sin(yaw / 2):.9f} {math.cos(yaw / 2):.9f}\n")


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    scans = read_scans(sys.argv[1], sys.argv[2])
    write_path(estimate(scans), scans, sys.argv[3])


if __name__ == "__main__":
    main()
