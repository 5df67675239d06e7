# SPDX-License-Identifier: BSD-3-Clause
"""docs/notebook.md is what the notebook is, prints and draws."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

cv2 = pytest.importorskip("cv2")
pytest.importorskip("matplotlib")

ROOT = pathlib.Path(__file__).parents[2]
PAGE = ROOT / "docs/notebook.md"
sys.path.insert(0, str(ROOT / "python/tools"))
from write_page import cells_of, write_page  # noqa: E402


def test_cells_are_told_apart_and_text_loses_its_marks():
    text = "# licence\n\n# %% [markdown]\n# # Title\n#\n# words\n\n# %%\nx = 1  # one\n\nprint(x)\n"
    assert cells_of(text) == [("markdown", "# Title\n\nwords"), ("code", "x = 1  # one\n\nprint(x)")]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The folder of a page that was written just now, and the names of the notebook."""
    synthesize = os.environ.get("HMCDYN_SYNTHESIZE", "")
    if not os.path.exists(synthesize):
        pytest.skip("hmcdyn_synthesize is not built (HMCDYN_SYNTHESIZE)")
    folder = tmp_path_factory.mktemp("notebook")
    command = re.search(r"^# hmcdyn_synthesize (.*)$", (ROOT / "examples/python/notebook.py").read_text(), re.M)
    subprocess.run([synthesize, *command[1].split(), "--quiet"], cwd=folder, check=True)
    return folder, write_page(folder, ROOT / "examples/python/notebook.py", folder / "notebook.md")


def without_figures(page):
    """Printed figures may differ in their last digits on another machine."""
    return re.sub(r"```text\n.*?```", lambda block: re.sub(r"\d+(\.\d+)?", "N", block[0]), page, flags=re.S)


def test_the_page_has_the_text_the_code_and_the_output_of_the_notebook(made):
    page = (made[0] / "notebook.md").read_text()
    assert without_figures(page) == without_figures(PAGE.read_text()), "write it anew: python/tools/write_page.py"


def test_the_pictures_are_there_and_as_large_as_those_made_now(made):
    pictures = re.findall(r"\]\((pictures/.*?)\)", PAGE.read_text())
    assert len(pictures) == 3
    for name in pictures:
        kept, now = PAGE.parent / name, cv2.imread(str(made[0] / name))
        assert kept.stat().st_size < 150_000
        assert cv2.imread(str(kept)).shape == now.shape
        assert now.std() > 20, "the picture is empty"


def test_the_filter_does_in_the_notebook_what_the_page_says_of_it(made):
    names = made[1]
    assert names["errors"]["hmc"].error.rmse < 0.2 * names["errors"]["none"].error.rmse
    assert (names["moves"] & names["left_out"]).sum() > 0.8 * names["left_out"].sum()
    assert names["both"] > 0.8 * sum(mask.sum() for mask in names["wanted"])
