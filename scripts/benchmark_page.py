#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Turns the JSON files of the benchmarks into docs/benchmarks.md and a plot. Standard library only."""
import argparse
import datetime
import json
import math
import pathlib
import platform
import statistics
import subprocess
import sys

# Kernel, N, peer, what is asked: ("at most", x) = our time is at most x times the peer's;
# ("at least", x) = we are at least x times as fast.
TARGETS = [
    ("clustering", 50, "sort", ("at most", 0.5)),
    ("clustering", 50, "nanoflann", ("at least", 24)),
    ("clustering", 50, "cv_partition", ("at least", 13)),
    ("clustering", 100, "sort", ("at most", 0.9)),
    ("clustering", 100, "nanoflann", ("at least", 16)),
    ("clustering", 100, "cv_partition", ("at least", 12)),
    ("clustering", 200, "sort", ("at most", 1.25)),
    ("clustering", 200, "nanoflann", ("at least", 13)),
    ("clustering", 200, "cv_partition", ("at least", 12)),
    ("clustering", 500, "sort", ("at most", 0.7)),
    ("clustering", 500, "nanoflann", ("at least", 36)),
    ("clustering", 1000, "sort", ("at most", 0.42)),
    ("clustering", 1000, "nanoflann", ("at least", 85)),
    ("clustering", 1000, "open3d", ("at least", 350)),
    ("clustering", 1000000, "sort", ("at most", 1.0)),
    ("clustering", 1000000, "nanoflann", ("at least", 18)),
    ("clustering", 1000000, "pcl", ("at least", 35)),
    ("clustering", 1000000, "open3d", ("at least", 100)),
    ("epipolar", 1000, "scalar_loop", ("at least", 3)),
    ("pose", 50, "ceres_full", ("at least", 21)),
    ("pose", 200, "ceres_full", ("at least", 38)),
    ("pose", 1000, "ceres_full", ("at least", 45)),
    ("pose", 1000, "tiny_solver", ("at least", 14)),
    ("pose", 1000, "solvepnp_lm_default", ("at least", 70)),
    ("filter_stage", 1000, "cv_partition", ("at least", 7.5)),
    ("filter_stage", 1000, "nanoflann", ("at least", 9)),
    ("filter_stage", 1000, "open3d", ("at least", 24)),
    ("filter_stage", 1000, "pcl", ("at least", 25)),
    ("motion_mask", 307200, "opencv_warp", ("at least", 2)),
]
PEERS = {
    "sort": "`std::sort` of N floats",
    "copy": "copy of N floats",
    "nanoflann": "textbook DBSCAN on nanoflann",
    "nanoflann_sorted": "the same, neighbours sorted",
    "cv_partition": "`cv::partition`",
    "open3d": "Open3D `ClusterDBSCAN`",
    "pcl": "PCL `EuclideanClusterExtraction`",
    "scalar_loop": "loop over `cv::Point2f` in double",
    "ceres_full": "Ceres, analytic Jacobian, a block a point",
    "ceres_autodiff": "Ceres, automatic Jacobian",
    "tiny_solver": "`ceres::TinySolver` over all residuals",
    "solvepnp_lm": "`cv::solvePnPRefineLM`, stopped as early as allowed",
    "solvepnp_lm_default": "`cv::solvePnPRefineLM`, its own criteria",
    "hmcdyn_rounds": "ours with four outlier rounds",
    "lk_21_level3_30": "`cv::calcOpticalFlowPyrLK`, 21 px, 3 levels above, 30 iterations (default)",
    "lk_21_level2_30": "the same, 21 px, 2 levels, 30 iterations",
    "lk_15_level2_10": "the same, 15 px, 2 levels, 10 iterations",
    "lk_11_level2_10": "the same, 11 px, 2 levels, 10 iterations",
    "lk_9_level2_10": "the same, 9 px, 2 levels, 10 iterations",
    "fm_ransac": "`cv::findFundamentalMat`, `FM_RANSAC`",
    "fm_lmeds": "the same, `FM_LMEDS`",
    "usac_8pts": "the same, `USAC_FM_8PTS`",
    "usac_8pts_refit": "the same and an 8-point refit",
    "usac_magsac_refit": "the same, `USAC_MAGSAC` and an 8-point refit",
    "cv_orb": "`cv::ORB`",
    "opencv_warp": "OpenCV: warp of one earlier depth, threshold, close and open, large components",
    "opencv_sideways": "OpenCV alike, for a camera that moves sideways only",
}
KERNELS = {
    "clustering": "Clustering",
    "epipolar": "Epipolar distances",
    "pose": "Weighted pose refinement",
    "filter_stage": "Filter stage (distances to weights, 5 boxes of 100)",
    "motion_mask": "Motion mask (N pixels: 640x480)",
}


# Kernels on real frames: title and what is counted besides time, with its column.
FRONT_END = {
    "optical_flow": ("Optical flow (with both pyramids)",
                     {"median_px": "median error (px)", "good_percent": "within 1 px (%)",
                      "found_percent": "not dropped (%)"}),
    "fundamental": ("Fundamental matrix, 40 % wrong matches",
                    {"median_px": "median distance of true pairs (px)", "failed": "frames without"}),
    "features": ("ORB features, 8 levels",
                 {"points": "points", "cells_percent": "cells of 40 px with one (%)"}),
}


def front_end_tables(folder):
    file = folder / "results" / "bench_front_end.json"
    if not file.exists():
        return []
    rows, counts = {}, {}
    for row in json.loads(file.read_text())["benchmarks"]:
        if row["run_type"] != "iteration" or row.get("error_occurred"):
            continue
        kernel, _, contender = row["run_name"].split("/")
        scale = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}[row["time_unit"]]
        rows.setdefault(kernel, {}).setdefault(contender, []).append(row["cpu_time"] * scale)
        counts[kernel, contender] = row
    lines = []
    for kernel, (title, columns) in FRONT_END.items():
        if kernel not in rows:
            continue
        lines += ["", f"### {title}", "", "| | time | " + " | ".join(columns.values()) + " |",
                  "|---" * (len(columns) + 2) + "|"]
        for contender, times in rows[kernel].items():
            name = "**hmcdyn**" if contender == "hmcdyn" else PEERS.get(contender, contender)
            cells = [f"{counts[kernel, contender][key]:.3g}" for key in columns]
            lines.append(f"| {name} | {duration(statistics.median(times))} | "
                         + " | ".join(cells) + " |")
    if lines:
        lines = ["", "## Front end", "", "1000 points on 24 real frames of 640x480 "
                 "(TUM's fr3_walking_halfsphere); see `bench/bench_front_end.cpp` for how the truth "
                 "is made.", *lines]
    return lines


def read(folder):
    """{(kernel, n): {contender: median CPU time (ns)}} of a folder's results, and the context."""
    times, context = {}, {}
    for file in sorted((folder / "results").glob("*.json")):
        if file.name == "bench_front_end.json":
            continue
        content = json.loads(file.read_text())
        context = content["context"]
        runs = {}
        for row in content["benchmarks"]:
            name = row["run_name"].split("/")
            if row["run_type"] != "iteration" or len(name) < 3 or row.get("error_occurred"):
                continue
            scale = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}[row["time_unit"]]
            runs.setdefault((name[0], int(name[1]), name[2]), []).append(row["cpu_time"] * scale)
        for (kernel, n, contender), values in runs.items():
            times.setdefault((kernel, n), {})[contender] = statistics.median(values)
    return times, context


def ratio(times, kernel, n, peer, kind):
    row = times.get((kernel, n), {})
    if "hmcdyn" not in row or peer not in row:
        return None
    return row["hmcdyn"] / row[peer] if kind == "at most" else row[peer] / row["hmcdyn"]


def shown(value):
    return "-" if value is None else f"{value:.2f}x" if value < 10 else f"{value:.1f}x"


def verdict(value, kind, limit):
    if value is None:
        return "not measured"
    if value <= limit if kind == "at most" else value >= limit:
        return "met"
    miss = (value / limit - 1.0 if kind == "at most" else 1.0 - value / limit) * 100.0
    return f"**missed by {miss:.0f} %**"


def target_table(main, plain):
    lines = ["| kernel | N | against | target | -O3 x86-64-v3 | | plain -O2 |",
             "|---|---|---|---|---|---|---|"]
    for kernel, n, peer, (kind, limit) in TARGETS:
        value = ratio(main, kernel, n, peer, kind)
        asked = f"<= {limit}x its time" if kind == "at most" else f">= {limit}x faster"
        lines.append(f"| {KERNELS[kernel]} | {n} | {PEERS[peer]} | {asked} | {shown(value)} | "
                     f"{verdict(value, kind, limit)} | "
                     f"{shown(ratio(plain, kernel, n, peer, kind))} |")
    return lines


def duration(ns):
    for unit, scale in (("s", 1e9), ("ms", 1e6), ("us", 1e3)):
        if ns >= scale:
            return f"{ns / scale:.3g} {unit}"
    return f"{ns:.3g} ns"


def time_tables(times):
    lines = []
    for kernel, title in KERNELS.items():
        sizes = sorted(n for name, n in times if name == kernel)
        contenders = []
        for n in sizes:
            contenders += [c for c in times[kernel, n] if c not in contenders]
        if not sizes:
            continue
        lines += ["", f"### {title}", "", "| | " + " | ".join(f"N = {n}" for n in sizes) + " |",
                  "|---" * (len(sizes) + 1) + "|"]
        for contender in contenders:
            cells = [duration(times[kernel, n][contender]) if contender in times[kernel, n] else "-"
                     for n in sizes]
            name = "**hmcdyn**" if contender == "hmcdyn" else PEERS.get(contender, contender)
            lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return lines


def growth(times):
    """Largest factor by which time per N log N grows from 1e4 points on."""
    sizes = sorted(n for kernel, n in times if kernel == "clustering" and n >= 10000)
    cost = [times["clustering", n]["hmcdyn"] / (n * math.log(n)) for n in sizes]
    return sizes, [c / cost[0] for c in cost] if cost else []


def plot(times, file):
    sizes = sorted(n for kernel, n in times if kernel == "clustering")
    names = [c for c in ("hmcdyn", "sort", "nanoflann", "pcl", "open3d", "cv_partition")
             if any(c in times["clustering", n] for n in sizes)]
    colours = {"hmcdyn": "#d1242f", "sort": "#57606a", "nanoflann": "#0969da", "pcl": "#8250df",
               "open3d": "#bf8700", "cv_partition": "#1a7f37"}
    width, height, left, right, top, bottom = 760, 460, 80, 190, 30, 60
    values = [times["clustering", n][c] for n in sizes for c in names
              if c in times["clustering", n]]
    x0, x1 = math.log10(sizes[0]), math.log10(sizes[-1])
    y0, y1 = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    x = lambda n: left + (math.log10(n) - x0) / (x1 - x0) * (width - left - right)
    y = lambda t: height - bottom - (math.log10(t) - y0) / (y1 - y0) * (height - top - bottom)
    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
           'font-family="sans-serif" font-size="13">',
           f'<rect width="{width}" height="{height}" fill="#ffffff"/>']
    for power in range(y0, y1 + 1):
        svg.append(f'<line x1="{left}" x2="{width - right}" y1="{y(10 ** power):.1f}" '
                   f'y2="{y(10 ** power):.1f}" stroke="#d8dee4"/>'
                   f'<text x="{left - 8}" y="{y(10 ** power) + 4:.1f}" text-anchor="end">'
                   f'{duration(10.0 ** power)}</text>')
    for power in range(math.ceil(x0), math.floor(x1) + 1):
        svg.append(f'<line x1="{x(10 ** power):.1f}" x2="{x(10 ** power):.1f}" y1="{top}" '
                   f'y2="{height - bottom}" stroke="#d8dee4"/>'
                   f'<text x="{x(10 ** power):.1f}" y="{height - bottom + 20}" '
                   f'text-anchor="middle">{10 ** power:,}</text>')
    labels = []
    for name in names:
        points = [(n, times["clustering", n][name]) for n in sizes
                  if name in times["clustering", n]]
        path = " ".join(f"{x(n):.1f},{y(t):.1f}" for n, t in points)
        svg.append(f'<polyline points="{path}" fill="none" stroke="{colours[name]}" '
                   f'stroke-width="{3 if name == "hmcdyn" else 1.6}"/>')
        svg += [f'<circle cx="{x(n):.1f}" cy="{y(t):.1f}" r="3" fill="{colours[name]}"/>'
                for n, t in points]
        labels.append((x(points[-1][0]), y(points[-1][1]), name))
    # Beside the last point of each line, and those of one column below each other.
    last = {}
    for column, position, name in sorted(labels):
        last[column] = max(position, last.get(column, -100.0) + 16)
        svg.append(f'<text x="{column + 10:.1f}" y="{last[column] + 4:.1f}" fill="{colours[name]}" '
                   f'stroke="#ffffff" stroke-width="4" paint-order="stroke">'
                   f'{name.replace("_", "::")}</text>')
    svg.append(f'<text x="{(left + width - right) / 2}" y="{height - 14}" text-anchor="middle">'
               'points N (neighbourhoods of about 30 points from N = 10,000 on)</text></svg>')
    file.write_text("\n".join(svg) + "\n")


def version(command):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split("\n")[0]
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def machine(context):
    name = "unknown processor"
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            name = line.split(":", 1)[1].strip()
            break
    packages = []
    for package in ("libeigen3-dev", "libceres-dev", "libopencv-dev", "libnanoflann-dev",
                    "libopen3d-dev", "libpcl-dev", "libbenchmark-dev"):
        found = version(["dpkg-query", "-W", "-f=${Version}", package])
        packages.append(f"{package} {found}" if found and found != "unknown" else f"no {package}")
    return [f"{name}, {context.get('num_cpus', '?')} cores; {platform.platform()}; "
            f"{version(['c++', '--version'])}.", "", "Packages: " + ", ".join(packages) + "."]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=pathlib.Path, help="build folders, first: bench")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--call", default="scripts/benchmark.sh", help="the command behind it")
    parser.add_argument("--repetitions", type=int, default=9, help="that the medians are of")
    parser.add_argument("--notes", type=pathlib.Path, help="Markdown that is put behind the tables")
    arguments = parser.parse_args()
    times, context = read(arguments.folders[0])
    plain = read(arguments.folders[1])[0] if len(arguments.folders) > 1 else {}
    if not times:
        sys.exit(f"{arguments.folders[0]}/results: no benchmark results")
    pictures = arguments.output.parent / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    sizes, factors = growth(times)
    clustering = [n for kernel, n in times if kernel == "clustering"]  # none after some filters
    if clustering:
        plot(times, pictures / "clustering_growth.svg")
    lines = ["# Benchmarks", "",
             f"Written by `{arguments.call}`; do not edit (notes: `docs/benchmarks_notes.md`). "
             f"{datetime.date.today().isoformat()}.", "", *machine(context), "",
             "One thread; all contenders of a kernel in one process, randomly interleaved; medians of "
             f"CPU time over {arguments.repetitions} repetitions; at least 256 different inputs in "
             "rotation (fewer beyond 10,000 points). "
             "Inputs: a person at 1.5-2.5 m (s.d. 0.1 m) with distances of 1-5 px, background at 3-4 m "
             "with 0-0.5 px, 5 % outliers; MinPoints 5.", "", "## Targets", "",
             *target_table(times, plain), ""]
    if clustering:
        lines += ["## Growth", "", "![time against N](pictures/clustering_growth.svg)", ""]
    if factors:
        lines += ["Time per N log N, relative to N = " + f"{sizes[0]:,}: "
                  + ", ".join(f"{n:,}: {f:.2f}" for n, f in zip(sizes, factors)) + ".", ""]
    lines += ["## Times", "", "Median CPU time, `-O3 -march=x86-64-v3`.", *time_tables(times),
              *front_end_tables(arguments.folders[0]), ""]
    if arguments.notes and arguments.notes.exists():
        lines += [arguments.notes.read_text().rstrip(), ""]
    arguments.output.write_text("\n".join(lines))


if __name__ == "__main__":
    main()
