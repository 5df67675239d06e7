# SPDX-License-Identifier: BSD-3-Clause
import os
import pathlib

import numpy
import pytest


@pytest.fixture
def clip():
    """The folder of the real clip; the test skips where it is missing."""
    folder = pathlib.Path(os.environ.get("HMCDYN_SHARED_DATA", "../shared")) / "data/fr3_walking_halfsphere_first50"
    if not folder.is_dir():
        pytest.skip(f"{folder} is missing")
    return folder


@pytest.fixture
def box_of_points():
    """A wall at 3 m, half of it in a box, and a person at 1 m in front of it who moves by 4 px."""
    random = numpy.random.default_rng(1)
    n = 120
    u = random.uniform(0, 640, n).astype(numpy.float32)
    v = random.uniform(0, 480, n).astype(numpy.float32)
    depth = numpy.full(n, 3, numpy.float32)
    distance = random.uniform(0, 0.3, n).astype(numpy.float32)
    person = (u > 200) & (u < 400) & (numpy.arange(n) % 2 == 0)
    depth[person] = 1 + random.uniform(0, 0.05, person.sum())
    distance[person] = 4
    return u, v, depth, distance, person, [[200, 0, 400, 480]]
