"""Loop closure: how far the last vertex moves. Needs solved.g2o, made with --robust local, and fooled.g2o, with --robust none."""
import math

import common


def last(name):
    vertices = {}
    with open(name, encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if words and words[0] == "VERTEX_SE2":
                vertices[int(words[1])] = (float(words[2]), float(words[3]))
    return vertices[max(vertices)]


before, after, fooled = last("loop.g2o"), last("solved.g2o"), last("fooled.g2o")
moved = math.dist(before, after)
common.answer(
    moved,
    with_false_loop=math.dist(before, fooled),
    from_start=math.hypot(*after),
    odometry_from_start=math.hypot(*before),
    x_alone=abs(before[0] - after[0]),
    centimetres=100 * moved,
    sign=-moved,
)
