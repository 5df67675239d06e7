# SPDX-License-Identifier: BSD-3-Clause
"""The type stubs say what the module has, and what results hold."""
import ast
import pathlib
import sys

import hmcdyn
import numpy
import pytest
from hmcdyn import _hmcdyn
from test_frames import corners, run, scene, trajectory

PYTHON = pathlib.Path(__file__).parents[1]
sys.path.insert(0, str(PYTHON / "tools"))
import write_stubs  # noqa: E402

STUBS = (PYTHON / "hmcdyn/_hmcdyn.pyi").read_text()
TREE = ast.parse(STUBS)
CLASSES = {node.name: node for node in TREE.body if isinstance(node, ast.ClassDef)}


def test_the_file_is_what_the_module_gives():
    assert write_stubs.stubs() == STUBS, "see python/tools/write_stubs.py"


def test_the_package_says_that_it_has_types():
    folder = pathlib.Path(hmcdyn.__file__).parent
    assert (folder / "py.typed").is_file()
    assert (folder / "_hmcdyn.pyi").read_text() == STUBS


def test_each_public_name_is_in_both():
    named = {node.name for node in TREE.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    named |= {node.target.id for node in TREE.body if isinstance(node, ast.AnnAssign)}
    assert {name for name in named if not name.startswith("_")} == {
        name for name in dir(_hmcdyn) if not name.startswith("_")}


def fields_of(name):
    """(field, type) of a class, as the stubs have them."""
    for node in CLASSES[name].body:
        if isinstance(node, ast.AnnAssign):
            yield node.target.id, ast.unparse(node.annotation)
        elif isinstance(node, ast.FunctionDef) and any(ast.unparse(d) == "property" for d in node.decorator_list):
            yield node.name, ast.unparse(node.returns)


def check(value, text, where):
    """That a value is of the type, with all that is in it."""
    if text.endswith(" | None"):
        if value is not None:
            check(value, text[:-len(" | None")], where)
    elif text.startswith("list["):
        assert isinstance(value, list), where
        for item in value:
            check(item, text[5:-1], where)
    elif text.startswith("tuple["):
        assert isinstance(value, tuple) and all(isinstance(item, int) for item in value), where
    elif text.startswith("numpy.typing.NDArray["):
        assert isinstance(value, numpy.ndarray), where
        element = text[len("numpy.typing.NDArray["):-1]
        if element != "Any":
            assert value.dtype == getattr(numpy, element.removeprefix("numpy.")), where
    elif text in CLASSES:
        assert type(value).__name__ == text, where
        for field, inner in fields_of(text):
            check(getattr(value, field), inner, f"{where}.{field}")
    else:
        assert type(value).__name__ == text, where


def results():
    """One of each large result, by what made it."""
    (earlier, _), (current, depth) = scene(0), scene(4)
    u, v = corners().T
    at = corners().astype(int)
    depths = depth[at[:, 1], at[:, 0]]
    camera = hmcdyn.PinholeCamera(300, 300, 160, 120)
    frames = hmcdyn.FrameFilter(camera=camera)
    yield run(frames)[-1]
    yield frames.mask()
    yield frames.options
    yield hmcdyn.filter_dynamic_features(earlier, current, u, v, depths, [[95, 55, 165, 185]])
    yield hmcdyn.surface_depths(depth, u, v)
    yield hmcdyn.ate(trajectory(), trajectory(0.01))
    yield hmcdyn.rpe(trajectory(), trajectory(0.01))
    yield hmcdyn.refine_pose(depths, depths, depths, u, v, camera, numpy.eye(4))
    for name in CLASSES:
        if name.endswith("Options"):
            yield getattr(hmcdyn, name)()


@pytest.mark.parametrize("result", results(), ids=lambda result: type(result).__name__)
def test_fields_of_results_are_of_their_types(result):
    check(result, type(result).__name__, type(result).__name__)
