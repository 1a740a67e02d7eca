"""python3 -m unittest discover -s FOLDER_OF_THIS_FILE"""
import math
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import @name@ as method


def room_from(pose):
    """The walls of a room of 6 x 4 m, as points in the frame of a robot at this pose in it."""
    walls = [(x / 10, y) for x in range(-30, 31) for y in (-2.0, 2.0)]
    walls += [(x, y / 10) for x in (-3.0, 3.0) for y in range(-20, 21)]
    return method.moved(method.between(pose, (0.0, 0.0, 0.0)), walls)


class Poses(unittest.TestCase):
    def test_between_undoes_compose(self):
        a, b = (1.0, -2.0, 3.0), (0.5, 0.2, -2.0)
        for found, expected in zip(method.between(a, method.compose(a, b)), b):
            self.assertAlmostEqual(found, expected)


class Estimate(unittest.TestCase):
    def test_a_robot_that_stands_stays_where_it_is(self):
        scan = method.Scan(0.0, (0.0, 0.0, 0.0), room_from((0.0, 0.0, 0.0)))
        for pose in method.estimate([scan, scan, scan]):
            self.assertLess(max(abs(value) for value in pose), 1e-6)

    def test_a_drive_is_followed(self):
        truth = [(0.05 * i, 0.0, math.radians(2.0 * i)) for i in range(10)]
        scans = [method.Scan(0.1 * i, pose, room_from(pose)) for i, pose in enumerate(truth)]
        end = method.estimate(scans)[-1]
        self.assertLess(math.hypot(end[0] - truth[-1][0], end[1] - truth[-1][1]), 0.05)

    # Next: give the wheels an error here, and ask of your correct() that it takes it away.


if __name__ == "__main__":
    unittest.main()
