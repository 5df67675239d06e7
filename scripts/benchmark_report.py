#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/benchmarks.md from Google Benchmark's JSON files (see scripts/benchmark.sh)."""
import argparse
import collections
import json
import pathlib
import statistics

# kernel, points, peer, target: at most (<=) or at least (>=) this ratio of the peer's time to ours
TARGETS = {
    ("clustering", 50): {"sort": ("<=", 0.5), "nanoflann": (">=", 24), "cv_partition": (">=", 13)},
    ("clustering", 100): {"sort": ("<=", 0.9), "nanoflann": (">=", 16), "cv_partition": (">=", 12)},
    ("clustering", 200): {"sort": ("<=", 1.25), "nanoflann": (">=", 13), "cv_partition": (">=", 12)},
    ("clustering", 500): {"sort": ("<=", 0.7), "nanoflann": (">=", 36)},
    ("clustering", 1000): {"sort": ("<=", 0.42), "nanoflann": (">=", 85), "open3d": (">=", 350)},
    ("clustering", 1000000): {"sort": ("<=", 1.0), "nanoflann": (">=", 18), "pcl": (">=", 35),
                              "open3d": (">=", 100)},
    ("epipolar", 1000): {"scalar_loop": (">=", 3)},
    ("filter_stage", 1000): {"cv_partition": (">=", 7.5), "nanoflann": (">=", 9),
                             "open3d": (">=", 24), "pcl": (">=", 25)},
    ("pose", 1000): {"ceres_full": (">=", 45), "tiny_solver": (">=", 14), "solvepnp_lm": (">=", 70)},
    ("pose", 200): {"ceres_full": (">=", 38)},
    ("pose", 50): {"ceres_full": (">=", 21)},
}
TO_MICROSECONDS = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}


def read_times(folder):
    """{(kernel, points): {who: median CPU time (us)}} of all repetitions of all files."""
    runs = collections.defaultdict(lambda: collections.defaultdict(list))
    for path in sorted(folder.glob("*.json")):
        for run in json.loads(path.read_text())["benchmarks"]:
            parts = run["run_name"].split("/")
            if run["run_type"] == "iteration" and len(parts) == 3 and not run.get("error_occurred"):
                time = run["cpu_time"] * TO_MICROSECONDS[run["time_unit"]]
                runs[(parts[0], int(parts[1]))][parts[2]].append(time)
    return {key: {who: statistics.median(times) for who, times in peers.items()}
            for key, peers in runs.items()}


def table(times):
    lines = ["| kernel | N | against | its time (us) | ours (us) | figure | target | met |",
             "|---|---|---|---|---|---|---|---|"]
    for key in sorted(times):
        peers = times[key]
        ours = peers.get("hmcdyn")
        for who in sorted(peers):
            if ours is None or who == "hmcdyn":
                continue
            kind, target = TARGETS.get(key, {}).get(who, (None, None))
            if who in ("sort", "copy"):
                ratio, figure = ours / peers[who], f"{ours / peers[who]:.2f}x of its time"
            else:
                ratio, figure = peers[who] / ours, f"{peers[who] / ours:.1f}x faster"
            met = "" if kind is None else (
                "yes" if (ratio <= target if kind == "<=" else ratio >= target) else "no")
            wanted = "" if kind is None else f"{kind} {target}x"
            lines.append(f"| {key[0]} | {key[1]} | {who} | {peers[who]:.3g} | {ours:.3g} "
                         f"| {figure} | {wanted} | {met} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=pathlib.Path, help="folder of JSON files")
    parser.add_argument("--machine", default="", help="machine, versions and date, as text")
    parser.add_argument("--command", default="", help="how the files were made")
    parser.add_argument("--notes", type=pathlib.Path, help="hand-written part, appended")
    arguments = parser.parse_args()
    print("# Benchmarks\n\nWritten by `scripts/benchmark.sh`; edit docs/benchmarks_notes.md instead.\n")
    print(f"{arguments.machine}\n\n`{arguments.command}`\n")
    print("CPU time, medians of the repetitions, randomly interleaved in one process.\n")
    print(table(read_times(arguments.results)))
    if arguments.notes and arguments.notes.exists():
        print("\n" + arguments.notes.read_text().strip())


if __name__ == "__main__":
    main()
