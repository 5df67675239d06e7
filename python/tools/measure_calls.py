# SPDX-License-Identifier: BSD-3-Clause
"""What a call from Python takes beside the same call in C++ (us).

    cmake --build --preset ci --target hmcdyn_python hmcdyn_python_reference
    PYTHONPATH=build/ci/python python3 python/tools/measure_calls.py build/ci/bin/hmcdyn_python_reference

filter_key_points: the least of 1000 calls. FrameFilter.filter: processors' time, the median of 21 frames of 640 x 480
with 1000 key points and one box, a new filter in each of five rounds, of which the least counts. Every result is
compared, bit by bit.
"""
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy

import hmcdyn

CALLS, ROUNDS, FRAMES = 1000, 5, 21
BOX = [200, 100, 400, 400]


def raw(values, dtype):
    return numpy.ascontiguousarray(values, dtype).tobytes()


def microseconds(work, clock):
    """What work took, and its result."""
    start = clock()
    result = work()
    return (clock() - start) * 1e6, result


def in_cpp(program, kind, parts):
    """The time of a call (us), and the raw results."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "in").write_bytes(b"".join(parts))
        printed = subprocess.run([program, kind, folder / "in", folder / "out"], check=True, capture_output=True)
        return min(float(line) for line in printed.stdout.split()), (folder / "out").read_bytes()


def stage(program, n):
    """filter_key_points: the times of a call in C++ and in Python."""
    random = numpy.random.default_rng(1)
    arrays = [values.astype(numpy.float32) for values in (
        random.uniform(0, 640, n), random.uniform(0, 480, n), random.uniform(1, 5, n), random.exponential(1, n))]
    cpp, expected = in_cpp(program, "stage", [raw(n, "i4"), *(raw(values, "f4") for values in arrays), raw(1, "i4"),
                                              raw(BOX, "f4")])
    boxes = numpy.array([BOX], numpy.float32)
    times = []
    for _ in range(CALLS):
        taken, result = microseconds(lambda: hmcdyn.filter_key_points(*arrays, boxes), time.perf_counter)
        times.append(taken)
    assert result.label.tobytes() + result.weight.tobytes() + result.cluster.tobytes() == expected
    return cpp, min(times)


def frames(program):
    """FrameFilter.filter: the times of a call in C++ and in Python."""
    random = numpy.random.default_rng(1)
    texture = random.integers(0, 255, (160, 200)).repeat(4, 0).repeat(4, 1).astype(numpy.uint8)
    points = random.uniform([8, 8], [632, 472], (1000, 2)).astype(numpy.float32)
    boxes = numpy.array([BOX], numpy.float32)
    depth = numpy.full((480, 640), 3, numpy.float32)
    images = [numpy.ascontiguousarray(texture[2 * i:2 * i + 480, 3 * i:3 * i + 640]) for i in range(FRAMES)]
    parts = [raw([FRAMES, 480, 640], "i4")]
    for i, gray in enumerate(images):
        parts += [raw(i / 30, "f8"), raw(gray, "u1"), raw(depth, "f4"), raw(1000, "i4"), raw(points, "f4"),
                  raw(1, "i4"), raw(BOX, "f4")]
    cpp, expected = in_cpp(program, "frames", parts)
    python = []
    for _ in range(ROUNDS):
        times, results = [], []
        filters = hmcdyn.FrameFilter()
        for i, gray in enumerate(images):
            taken, result = microseconds(lambda: filters.filter(i / 30, gray, points, boxes, depth=depth),
                                         time.process_time)
            times.append(taken)
            results += [result.keep, result.weight, result.lambda_, result.label]
        python.append(statistics.median(times))
        assert b"".join(values.tobytes() for values in results) == expected
    return cpp, min(python)


def main(program):
    print("| call | C++ (us) | Python (us) | more (us) |\n|---|---|---|---|")
    rows = [(f"`filter_key_points`, {n} points, a box", stage(program, n)) for n in (1, 100, 1000)]
    rows.append(("`FrameFilter.filter`, 640 x 480, 1000 points, a box", frames(program)))
    for name, (cpp, python) in rows:
        print(f"| {name} | {cpp:.1f} | {python:.1f} | {python - cpp:.1f} |")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
