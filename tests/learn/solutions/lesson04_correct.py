def correct(previous_points, points, T_previous_current):
    """Iterative closest point, starting at the wheels' guess: pairs of nearest points, the motion that brings them together, again."""
    cell = 0.3
    grid = {}
    for p in previous_points:
        grid.setdefault((math.floor(p[0] / cell), math.floor(p[1] / cell)), []).append(p)

    def nearest(q):
        column, row = math.floor(q[0] / cell), math.floor(q[1] / cell)
        near = [p for i in (-1, 0, 1) for j in (-1, 0, 1) for p in grid.get((column + i, row + j), ())]
        return min(near, key=lambda p: (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2, default=None)

    T = T_previous_current
    reach = cell
    for _ in range(12):
        pairs = []
        for original, q in zip(points, moved(T, points)):
            p = nearest(q)
            if p is not None and math.dist(p, q) < reach:
                pairs.append((p, q))
        if len(pairs) < 10:
            return T_previous_current
        n = len(pairs)
        px, py = sum(p[0] for p, _ in pairs) / n, sum(p[1] for p, _ in pairs) / n
        qx, qy = sum(q[0] for _, q in pairs) / n, sum(q[1] for _, q in pairs) / n
        cross = sum((q[0] - qx) * (p[1] - py) - (q[1] - qy) * (p[0] - px) for p, q in pairs)
        dot = sum((q[0] - qx) * (p[0] - px) + (q[1] - qy) * (p[1] - py) for p, q in pairs)
        turn = math.atan2(cross, dot)
        c, s = math.cos(turn), math.sin(turn)
        step = (px - (c * qx - s * qy), py - (s * qx + c * qy), turn)
        T = compose(step, T)
        reach = max(0.1, reach * 0.8)
    return T
