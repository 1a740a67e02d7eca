"""What the solutions share. Each is run in the student's folder; it prints the right answer, and wrong ones by the name of their hint."""
import csv
import json
import math


def rows(name):
    with open(name, encoding="utf-8", newline="") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def poses(name):
    """(time, x, y, yaw) per line of a trajectory."""
    result = []
    with open(name, encoding="utf-8") as file:
        for line in file:
            if line.strip() and not line.startswith("#"):
                t, x, y, _, _, _, qz, qw = map(float, line.split())
                result.append((t, x, y, 2 * math.atan2(qz, qw)))
    return result


def wrapped(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


def answer(value, **wrong):
    print(json.dumps({"answer": value, "wrong": wrong}))
