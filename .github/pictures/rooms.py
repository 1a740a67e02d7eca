#!/usr/bin/env python3
"""Draws the rooms of libslam from their includes: rooms.svg, for docs/architecture.md.

  rooms.py            writes the picture
  rooms.py --check    exit code 1 when the committed picture is of other includes

A room stands above all that it includes. An arrow that others already imply (a -> b -> c implies a -> c) is left out. Left (red): rooms
that know the ground truth; right (green): rooms that a robot has; grey: both may use them; blue: rooms that compose both.
"""
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
LIBRARY = HERE.parents[1] / "libslam"
PICTURE = HERE / "rooms.svg"
TRUTH = {"world", "rays", "buildings", "drafting", "check", "movers", "sim", "mrptworld", "metrics", "oracle", "draw", "pictures", "report", "viewer"}
ROBOT = {"gridmap", "scanmatch", "sparse", "posegraph", "certified", "obstacles", "safety", "paths", "goals", "choices", "strategies", "navigate", "mrptnav",
         "odometry", "wheels", "keyframes", "uncertainty", "tracking", "loops", "bundle", "graph", "particles", "builders", "methods", "mapping"}
FLOOR = {"core", "threads", "files", "resources", "lidar", "robot", "objects", "bags", "rawlogs", "logs", "edit", "stats", "table", "calibration", "doctor", "process"}
WIDTH, BOX, ROW = 1180, (104, 30), 74


def includes():
    """{room: rooms that its files include}"""
    rooms = {}
    for file in sorted(LIBRARY.glob("*/**/*")):
        if file.suffix not in (".h", ".cpp"):
            continue
        room = file.relative_to(LIBRARY).parts[0]
        found = re.findall(r'#\s*include\s*["<]libslam/([a-z]+)/', file.read_text())
        rooms.setdefault(room, set()).update(set(found) - {room})
    rooms.pop("testing", None)
    return rooms


def reached(rooms, room):
    """All rooms below `room`. Errors: SystemExit that names a circle."""
    seen, left = set(), list(rooms[room])
    while left:
        other = left.pop()
        if other == room:
            sys.exit(f"rooms.py: {room} includes itself by way of others")
        if other not in seen:
            seen.add(other)
            left += rooms[other]
    return seen


def shortened(rooms):
    """The arrows that no others imply."""
    below = {room: reached(rooms, room) for room in rooms}
    return {room: {other for other in direct if not any(other in below[third] for third in direct)}
            for room, direct in rooms.items()}


def floors(rooms):
    """{room: number of its floor}: one above the highest of those that it includes."""
    floor = {}
    while len(floor) < len(rooms):
        for room, direct in rooms.items():
            if room not in floor and all(other in floor for other in direct):
                floor[room] = 1 + max((floor[other] for other in direct), default=-1)
    return floor


def side(room):
    return 0 if room in TRUTH else 2 if room in ROBOT else 1


def places(rooms, arrows):
    """{room: centre of its box}: the truth's side left, the robot's right, each near the middle of those that it is tied to."""
    floor = floors(rooms)
    height = 1 + max(floor.values())
    rows = [sorted((room for room in rooms if floor[room] == f), key=lambda room: (side(room), room)) for f in range(height)]
    x = {}
    for f, row in enumerate(rows):
        def wish(room):
            below = [x[other] for other in arrows[room]]
            return sum(below) / len(below) if below else WIDTH / 2
        row.sort(key=lambda room: (side(room), wish(room), room))
        for i, room in enumerate(row):
            x[room] = WIDTH * (i + 1) / (len(row) + 1)
    return {room: (x[room], ROW * (height - floor[room]) - ROW / 2 + 20) for room in rooms}


def svg(rooms):
    arrows = shortened(rooms)
    at = places(rooms, arrows)
    height = max(y for _, y in at.values()) + 40
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:.0f}" font-family="sans-serif" font-size="15">',
           '<title>Rooms of libslam: an arrow leads from a room to one that it includes</title>',
           '<defs><marker id="tip" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
           '<path d="M0 0 8 4 0 8z" fill="#777"/></marker></defs>',
           f'<rect width="{WIDTH}" height="{height:.0f}" fill="#fff"/>']
    for room in sorted(rooms):
        for other in sorted(arrows[room]):
            (x0, y0), (x1, y1) = at[room], at[other]
            y0, y1 = y0 + BOX[1] / 2, y1 - BOX[1] / 2
            bend = (y1 - y0) / 2
            out.append(f'<path d="M{x0:.0f} {y0:.0f}C{x0:.0f} {y0 + bend:.0f} {x1:.0f} {y1 - bend:.0f} {x1:.0f} {y1:.0f}" '
                       'fill="none" stroke="#999" marker-end="url(#tip)"/>')
    for room in sorted(rooms):
        colour = ("#f6d0cc" if room in TRUTH else "#cfe8cf" if room in ROBOT else "#e4e4e4" if room in FLOOR else "#cfe0f5")
        x, y = at[room]
        out.append(f'<rect x="{x - BOX[0] / 2:.0f}" y="{y - BOX[1] / 2:.0f}" width="{BOX[0]}" height="{BOX[1]}" rx="5" '
                   f'fill="{colour}" stroke="#555"/>'
                   f'<text x="{x:.0f}" y="{y + 5:.0f}" text-anchor="middle">{room}</text>')
    return "\n".join(out + ["</svg>", ""])


def main():
    picture = svg(includes())
    if sys.argv[1:] == ["--check"]:
        if not PICTURE.exists() or PICTURE.read_text() != picture:
            sys.exit(f"{PICTURE.name} is not what the includes say; make it anew: .github/pictures/rooms.py")
    elif sys.argv[1:]:
        sys.exit(__doc__)
    else:
        PICTURE.write_text(picture)


if __name__ == "__main__":
    main()
