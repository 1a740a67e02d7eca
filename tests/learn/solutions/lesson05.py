"""Occupancy grid: log-odds add up. p_hit and p_pass stand in the question."""
import math
import re

import common

task = open("TASK.md", encoding="utf-8").read()
p_hit = float(re.search(r"hit says occupied with probability ([0-9.]+),", task).group(1))
p_pass = float(re.search(r"pass with probability ([0-9.]+)\.", task).group(1))
scans = common.rows("cell.csv")


def log_odds(column, evidence):
    return sum(math.log(evidence[row[column]] / (1 - evidence[row[column]])) for row in scans if row[column] in evidence)


def probability(l):
    return 1 / (1 + math.exp(-l))


both = {2: p_hit, 1: p_pass}
p = probability(log_odds("exact", both))
seen = [both[row["exact"]] for row in scans if row["exact"] in both]
common.answer(
    p,
    squeezed=probability(log_odds("squeezed", both)),
    log_odds=log_odds("exact", both),
    share=sum(row["exact"] == 2 for row in scans) / len(seen),
    mean=sum(seen) / len(seen),
    only_hits=probability(log_odds("exact", {2: p_hit})),
    free=1 - p,
    percent=100 * p,
)
