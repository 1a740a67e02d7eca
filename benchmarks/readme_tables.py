#!/usr/bin/env python3
"""Writes the tables of README.md and of the documentation's pages from the committed results.

  benchmarks/readme_tables.py            rewrites what stands between the marks <!-- table: NAME --> and <!-- end -->
  benchmarks/readme_tables.py --check    changes nothing; exit code 1 and the names of the tables that are not current

No table has a figure that is not in benchmarks/results.
"""
import csv
import io
import lzma
import pathlib
import re
import statistics
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "benchmarks" / "results"


def rows(name):
    path = RESULTS / name
    data = lzma.open(path, "rb").read() if path.suffix == ".xz" else path.read_bytes()
    return list(csv.DictReader(io.StringIO(data.decode())))


def markdown(head, lines):
    """The first columns without a colon after their name are text, the others figures."""
    names = [cell.rstrip(":") for cell in head]
    rule = ["---:" if cell.endswith(":") else "---" for cell in head]
    return "\n".join("| " + " | ".join(line) + " |" for line in [names, rule, *lines]).replace("| ---", "|---").replace(
        "--- |", "---|").replace("---: |", "---:|")


def number(text):
    return float(text) if text not in ("", "-") else None


def figure(text, most=4):
    """Three digits that count, or as many decimals as asked for."""
    value = float(text)
    decimals = next((digits for limit, digits in ((10, 1), (1, 2), (0.05, 3)) if value >= limit), 4)
    return f"{value:.{min(decimals, most)}f}"


def median(values, missing):
    """Of values of which None ranks as worse than any; None where that is the middle."""
    known = sorted(value for value in values if value is not None)
    worst = [missing] * (len(values) - len(known))
    return statistics.median(known + worst)


WHAT = {
    "naive": "the same with the other lidars: dead reckoning by scan difference, dots",
    "naive_blind": "the same, guessing whether it moved or turned",
    "naive_wheel": "dead reckoning by the wheels",
    "naive_correlation": "dead reckoning by our scan correlation",
    "naive_flow": "dead reckoning by our range flow",
    "icp": "MRPT ICP SLAM, tuned",
    "icp_exact": "the same, our grid without the insertion bias",
    "rbpf": "MRPT RBPF, its own grid",
    "rbpf_exact": "MRPT RBPF, our grid without the insertion bias",
    "particles": "our particle filter",
    "graph": "our graph SLAM",
}
FAILED_M = 1


ORIGINAL_LIDAR = "thesis_360"
NEWER = {"particles": "standard_particles", "graph": "standard_graph"}  # run anew later, on the same logs


def standard_rows(ending):
    old = [row for row in rows("standard" + ending) if row["method"] not in NEWER]
    return old + [row for name in NEWER.values() for row in rows(name + ending)]


def standard_line(name, what, mine, costs, with_cost=True):
    errors = [number(run["ate_final_m"]) for run in mine]
    good = [run for run, error in zip(mine, errors) if run["status"] == "ok" and error is not None and error <= FAILED_M]
    middle = median([error if error is not None and error <= FAILED_M else None for error in errors], float("inf"))
    score = {key: median([number(run[key]) for run in good], float("-inf")) if good else None
             for key in ("wall_f1", "free_iou")}
    cost = {key: statistics.median(float(costs[run["run"]][key]) for run in mine if run["run"] in costs)
            for key in ("ms_per_scan", "peak_memory_mb")} if with_cost else {}
    return [name, what, f"{100 * (len(mine) - len(good)) / len(mine):.1f}",
            f"{middle:.3f}" if middle < float("inf") else "failed",
            *(f"{value:.3f}" if value is not None else "-" for value in score.values()),
            *([f"{cost['ms_per_scan']:.2f}", f"{cost['peak_memory_mb']:.0f}"] if cost else [])]


def standard():
    standard_runs = standard_rows(".csv.xz")
    costs = {row["run"]: row for row in standard_rows("_cost.csv.xz")}

    def runs(method, with_original_lidar):
        return [run for run in standard_runs
                if run["method"] == method and (run["lidar"] == ORIGINAL_LIDAR) == with_original_lidar]

    lines = [standard_line(f"`naive`, `{ORIGINAL_LIDAR}`", "the original robot with its own lidar", runs("naive", True), costs)]
    lines += [standard_line(f"`{method}`", what, runs(method, False), costs) for method, what in WHAT.items()]
    for column, best in ((2, min), (3, min), (4, max), (5, max)):
        figures = {line[column] for line in lines if number(line[column].replace("failed", "")) is not None}
        for line in lines:
            if line[column] == best(figures, key=float):
                line[column] = f"**{line[column]}**"
    return markdown(["method", "what it is", "failed %:", "final ATE (m):", "wall F1:", "free IoU:", "ms/scan:", "MB:"],
                    lines)


def original_lidar():
    runs = rows("original_lidar.csv.xz")
    lines = [standard_line(f"`{method}`", "", [run for run in runs if run["method"] == method], {}, False) for method in WHAT]
    return markdown(["method", "failed %:", "final ATE (m):", "wall F1:", "free IoU:"], [[line[0], *line[2:]] for line in lines])


PUBLISHED = {  # Cartographer, tuned per log: Hess et al., ICRA 2016, table I
    "intel": ("Intel", "0.0229 / 0.453"),
    "fr079": ("Freiburg 079", "0.0452 / 0.538"),
    "mit-killian": ("MIT Killian Court", "0.0395 / 0.352"),
}


def relations():
    found = {(row["log"], row["path"]): row for row in rows("relations_baselines.csv") + rows("relations_ours.csv")}

    def error(log, path):
        row = found[log, path]
        return f"{figure(row['translation_mean_m'])} / {figure(row['rotation_mean_deg'], 3)}"

    lines = []
    for log, (name, published) in PUBLISHED.items():
        graph = found[log, "graph final"]
        lines.append([name, *(error(log, path) for path in ("odometry", "icp", "rbpf_exact final", "particles final")),
                      f"**{error(log, 'graph final')}**",
                      f"{float(graph['ms_per_scan']):.2f}, {float(graph['peak_memory_mb']):.0f}", published])
    return markdown(["log", "odometry:", "MRPT ICP, tuned:", "MRPT RBPF, tuned:", "`particles`:", "`graph`:",
                     "`graph` ms/scan, MB:", "best published:"], lines)


CAST_PLANS = {"flat": "flat", "office_loop": "office_loop", "willow-full": "willow (ROS)", "map": "turtlebot3 (ROS)",
              "depot": "depot (ROS)", **{f"{kind} 100 x 80 m": f"{kind} 100 x 80 m"
                                         for kind in ("flat", "office", "hall", "hospital", "cave")}}
CAST_ENGINES = ["sector table, portable", "sector table, AVX2", "sector table, AVX-512"]


def casting():
    found = {(row["plan"], row["engine"]): row for row in rows("casting.csv")}
    lines = []
    for plan, name in CAST_PLANS.items():
        mrpt = found[plan, "MRPT laserScanSimulator"]
        times = [float(found[plan, engine]["times_mrpt"]) for engine in CAST_ENGINES]
        lines.append([name, mrpt["cells"], f"{float(mrpt['mrays_per_s']):.1f}", f"{float(mrpt['error_cells']):.2f}",
                      f"{times[0]:.1f}x", f"{times[1]:.1f}x", f"**{times[2]:.1f}x**"])
    return markdown(["plan", "cells", "MRPT (Mrays/s):", "its mean error (cells):", "portable:", "AVX2:", "AVX-512:"],
                    lines)


STRATEGIES = ["longest_ray", "quadrant", "wall_follow", "nearest_frontier", "information_gain", "next_best_view"]


def exploration():
    found = {(row["plan"], row["strategy"]): row
             for name in ("exploration_truth_medians.csv", "office_loop/exploration_truth_medians.csv")
             for row in rows(name)}

    def cell(row, share):
        path = row[f"path{share}_m"]
        return f"{float(path):.0f} m" if path else f"({float(row['coverage_percent']):.1f} %)"

    lines = []
    for plan in sorted({plan for plan, _ in found}):
        for share in ("90", "99"):
            lines.append([plan if share == "90" else "", f"{share} %",
                          *(cell(found[plan, strategy], share) for strategy in STRATEGIES)])
    return markdown(["world", "to:", *(f"`{strategy}`:" for strategy in STRATEGIES)], lines)


TABLES = {"README.md": {"standard": standard, "relations": relations},
          "docs/ray-casting.md": {"casting": casting},
          "docs/exploration.md": {"exploration": exploration},
          "docs/origins.md": {"original_lidar": original_lidar}}


def stale(page, tables, check):
    """Names of the tables of a page that are not current; writes them unless `check`."""
    path = ROOT / page
    text = old = path.read_text(encoding="utf-8")
    names = []
    for name, make in tables.items():
        mark = re.compile(rf"(<!-- table: {name} -->\n)(.*?)(\n?<!-- end -->)", re.S)
        if len(mark.findall(text)) != 1:
            sys.exit(f"{page}: expected one <!-- table: {name} --> ... <!-- end -->")
        made = make()
        if mark.search(text).group(2) != made:
            names.append(name)
        text = mark.sub(lambda found: found.group(1) + made + "\n<!-- end -->", text)
    if not check and text != old:
        path.write_text(text, encoding="utf-8")
    return names


def main():
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit(__doc__)
    lines = [f"{page}: {', '.join(names)}" for page, tables in TABLES.items() if (names := stale(page, tables, check))]
    if check and lines:
        sys.exit("not as benchmarks/results has it: " + "; ".join(lines))
    if lines:
        print("\n".join(lines))


if __name__ == "__main__":
    main()
