"""Dead reckoning: the whole turn by the wheels less the true one, over the true path. Needs wheels/trajectory.tum."""
import math

import common


def turned(path):
    return math.degrees(sum(common.wrapped(b[3] - a[3]) for a, b in zip(path, path[1:])))


def length(path):
    return sum(math.hypot(b[1] - a[1], b[2] - a[2]) for a, b in zip(path, path[1:]))


truth, wheels = common.poses("run.gt.tum"), common.poses("wheels/trajectory.tum")
drift, path = turned(wheels) - turned(truth), length(truth)
common.answer(
    drift / path,
    radians=math.radians(drift / path),
    sign=-drift / path,
    total=drift,
    per_second=drift / (truth[-1][0] - truth[0][0]),
    wheels_alone=turned(wheels) / path,
    percent=100 * drift / path,
)
