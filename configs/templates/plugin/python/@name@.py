"""@name@ LOG SCANS OUTPUT: runs a program on LOG (a CARMEN log; `log = action` in the .ini gives an MRPT rawlog) in an empty folder, and
leaves OUTPUT: `time x y z qx qy qz qw` per line. SCANS has a line `stamp x y yaw` per scan: the wheels' dead reckoning.
"""
import math
import shutil
import sys


def run_program(log_path, scans_path):
    """Edit here: start your program (subprocess.run([...], check=True)), and return the file of its poses, `stamp x y yaw` per line.

    This one believes the wheels.
    """
    shutil.copy(scans_path, "poses.txt")
    return "poses.txt"


def trajectory_line(line):
    stamp, x, y, yaw = line.split()[:4]
    half = float(yaw) / 2
    return f"{stamp} {x} {y} 0 0 0 {math.sin(half):.9f} {math.cos(half):.9f}\n"


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    poses_path = run_program(sys.argv[1], sys.argv[2])
    with open(poses_path, encoding="utf-8") as poses, open(sys.argv[3], "w", encoding="utf-8") as output:
        output.writelines(trajectory_line(line) for line in poses if line.strip())


if __name__ == "__main__":
    main()
