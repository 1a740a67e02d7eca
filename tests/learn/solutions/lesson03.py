"""Scan difference: how many turns are read wrong by more than 5 degrees."""
import math

import common

turns = common.rows("turns.csv")


def wrong(sign=1):
    count = 0
    for turn in turns:
        truly = turn["heading_after_deg"] - turn["heading_before_deg"]
        error = math.degrees(common.wrapped(math.radians(sign * turn["read_deg"] - truly)))
        count += abs(error) > 5
    return count


unwrapped = sum(abs(t["read_deg"] - (t["heading_after_deg"] - t["heading_before_deg"])) > 5 for t in turns)
common.answer(wrong(), right_ones=len(turns) - wrong(), all=len(turns), unwrapped=unwrapped, turned_round=wrong(-1),
              commands=2 * len(turns), radians=0, share=wrong() / len(turns))
