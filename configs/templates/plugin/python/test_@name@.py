"""python3 -m unittest discover -s FOLDER_OF_THIS_FILE"""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import @name@ as plugin


class Lines(unittest.TestCase):
    def test_a_quarter_turn_is_a_unit_quaternion(self):
        words = plugin.trajectory_line("1.5 2 3 1.5707963\n").split()
        self.assertEqual(words[:3], ["1.5", "2", "3"])
        self.assertAlmostEqual(sum(float(word) ** 2 for word in words[4:]), 1.0)


if __name__ == "__main__":
    unittest.main()
