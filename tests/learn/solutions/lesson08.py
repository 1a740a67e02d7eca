"""Consistency: the ANEES of the scan matcher's errors."""
import math

import common

lines = [tuple(row.values()) for row in common.rows("errors.csv")]
nees = [(c * x * x - 2 * b * x * y + a * y * y) / (a * c - b * b) for x, y, a, b, c in lines]
n = len(lines)
anees = sum(nees) / (2 * n)
common.answer(
    anees,
    not_divided=2 * anees,
    sum=sum(nees),
    root=math.sqrt(anees),
    no_correlation=sum(x * x / a + y * y / c for x, y, a, b, c in lines) / (2 * n),
    sigma=sum(x * x / math.sqrt(a) + y * y / math.sqrt(c) for x, y, a, b, c in lines) / (2 * n),
    ratio_of_means=sum(x * x + y * y for x, y, *_ in lines) / sum(a + c for _, _, a, _, c in lines),
    inverse=1 / anees,
    sign=-anees,
)
