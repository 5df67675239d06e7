# SPDX-License-Identifier: BSD-3-Clause
"""Runs a notebook in the percent format, and writes it as a page: its text, its code, what that prints and draws.

    hmcdyn_synthesize --scene crowd --frames 45 --output FOLDER/crowd
    PYTHONPATH=build/ci/python python3 python/tools/write_page.py FOLDER examples/python/notebook.py docs/notebook.md

FOLDER is where it runs. Pictures go to pictures/ beside the page, with its name and a number.
"""
import contextlib
import io
import os
import pathlib
import sys
from typing import Any


def cells_of(text: str) -> "list[tuple[str, str]]":
    """(kind, text) of each cell; kind is "markdown" or "code"."""
    cells = []
    for cell in text.split("\n# %%")[1:]:
        head, body = cell.split("\n", 1)
        if "[markdown]" in head:
            lines = [line[2:] if line.startswith("# ") else line[1:] for line in body.strip().splitlines()]
            cells.append(("markdown", "\n".join(lines)))
        else:
            cells.append(("code", body.strip()))
    return cells


def write_page(folder: pathlib.Path, notebook: pathlib.Path, page: pathlib.Path) -> "dict[str, Any]":
    """Gives the names that the notebook has defined in the end."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plot

    notebook, page = notebook.resolve(), page.resolve()
    (page.parent / "pictures").mkdir(exist_ok=True)
    names: "dict[str, Any]" = {}
    parts, pictures = [], 0
    path, place = list(sys.path), os.getcwd()
    sys.path.insert(0, str(notebook.parent))
    os.chdir(folder)
    try:
        for kind, text in cells_of(notebook.read_text()):
            if kind == "markdown":
                parts.append(text)
                continue
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(text, str(notebook), "exec"), names)
            parts.append(f"```python\n{text}\n```")
            if printed.getvalue():
                parts.append(f"```text\n{printed.getvalue().strip()}\n```")
            for number in plot.get_fignums():
                pictures += 1
                picture = f"pictures/{page.stem}_{pictures}.jpg"
                plot.figure(number).savefig(page.parent / picture, dpi=80, pil_kwargs={"quality": 85})
                parts.append(f"![{page.stem}, picture {pictures}]({picture})")
            plot.close("all")
    finally:
        os.chdir(place)
        sys.path[:] = path
    page.write_text("\n\n".join(parts) + "\n")
    return names


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    write_page(*map(pathlib.Path, sys.argv[1:]))
