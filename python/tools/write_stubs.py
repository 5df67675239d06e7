# SPDX-License-Identifier: BSD-3-Clause
"""Writes the type stubs of the compiled part from its own signatures, as pybind11 puts them into docstrings.

    PYTHONPATH=build/ci/python python3 python/tools/write_stubs.py > python/hmcdyn/_hmcdyn.pyi

Beyond what mypy's stubgen makes of them: a struct of options has its fields as keywords, and so has a function that
takes fields of its options; an enumeration may be named, and a struct within a struct may be a dict.
"""
import enum
import re
import sys

from hmcdyn import _hmcdyn as module

HEAD = '''\
# SPDX-License-Identifier: BSD-3-Clause
# Written by python/tools/write_stubs.py; a test compares it with the module.
import enum
import os
from collections.abc import Sequence
from typing import Any

import numpy
import numpy.typing

_Array = numpy.typing.ArrayLike
_Boxes = Sequence[DetectionBox] | numpy.typing.ArrayLike
_Regions = Sequence[LabelRegion]
_Path = str | os.PathLike[str]
_Trajectory = str | os.PathLike[str] | numpy.typing.ArrayLike

__version__: str
'''
LIKE = {"numpy.typing.ArrayLike": "_Array", "Boxes": "_Boxes", "Regions": "_Regions", "Path": "_Path",
        "Trajectory": "_Trajectory", "numpy.ndarray": "numpy.typing.NDArray[Any]"}


def python_type(text):
    """A type as pybind11 writes it, in today's words."""
    text = text.strip().replace("hmcdyn._hmcdyn.", "")
    if match := re.fullmatch(r"(Optional|List|Tuple|numpy\.ndarray)\[(.*)\]", text):
        outer, inner = match.groups()
        if outer == "Optional":
            return python_type(inner) + " | None"
        if outer == "numpy.ndarray":
            return f"numpy.typing.NDArray[{inner}]"
        return f"{outer.lower()}[{', '.join(python_type(part) for part in split(inner))}]"
    if text not in LIKE and not re.fullmatch(r"[\w.]+", text):
        raise ValueError(f"'{text}' is no type of Python: is it bound after what mentions it?")
    return LIKE.get(text, text)


def split(arguments):
    """At the commas that are not within brackets."""
    parts, depth = [""], 0
    for letter in arguments:
        depth += (letter in "[(<") - (letter in "])>")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts if part.strip()]


def kind_of(name):
    return getattr(module, name, None) if name.isidentifier() else None


def properties_of(cls):
    """(name, type, whether it can be set) of each."""
    for name, value in vars(cls).items():
        if isinstance(value, property):
            yield name, python_type(value.fget.__doc__.strip().split("-> ")[1]), value.fset is not None


def taken(text):
    """What is taken where such a value is expected."""
    kind = kind_of(text.replace(" | None", ""))
    if isinstance(kind, type) and issubclass(kind, enum.IntEnum):
        return text + " | str"
    if isinstance(kind, type) and kind.__name__.endswith(("Options", "Model")):
        return text + " | dict[str, Any]"
    return text


def keywords_of(cls):
    return [f"{name}: {taken(text)} = ..." for name, text, is_set in properties_of(cls) if is_set]


def arguments_of(arguments, owner):
    """Those of one signature."""
    result, options = [], None
    for argument in split(arguments):
        if argument == "**kwargs":
            names = {known.split(":")[0] for known in result}  # an argument goes before a field of its name
            result += ([] if "*" in result else ["*"]) + [keyword for keyword in keywords_of(options or owner)
                                                          if keyword.split(":")[0] not in names]
            continue
        name, _, rest = argument.partition(": ")
        if name in ("self", "*"):
            result.append(name)
            continue
        text, _, default = rest.partition(" = ")
        text = python_type(text)
        if name == "options" and text.endswith(" | None"):
            options = kind_of(text[:-len(" | None")])
        text = taken(text) if not text.endswith("| None") else text
        if default == "None" and not text.endswith("| None"):
            text += " | None"
        result.append(f"{name}: {text}" + (" = ..." if default else ""))
    return result


def signature(function, indent="", owner=None):
    first = function.__doc__.split("\n")[0]
    name, arguments, returned = re.fullmatch(r"(\w+)\((.*)\) -> (.*)", first).groups()
    line = f"{indent}def {name}({', '.join(arguments_of(arguments, owner))}) -> {python_type(returned)}: ..."
    if len(line) <= 120:
        return [line]
    return ([f"{indent}def {name}("] + [f"{indent}    {argument}," for argument in arguments_of(arguments, owner)]
            + [f"{indent}) -> {python_type(returned)}: ..."])


def enumeration(cls):
    return [f"class {cls.__name__}(enum.IntEnum):"] + [f"    {name} = {value.value}"
                                                       for name, value in cls.__members__.items()]


def structure(cls):
    lines = []
    for name, text, is_set in properties_of(cls):
        lines += [f"    {name}: {text}"] if is_set else ["    @property", f"    def {name}(self) -> {text}: ..."]
    for name, value in vars(cls).items():
        if isinstance(value, staticmethod):
            lines += ["    @staticmethod"] + signature(getattr(cls, name), "    ")
        elif callable(value) and (value.__doc__ or "").startswith(f"{name}(") and (
                name in ("__init__", "__len__") or not name.startswith("_")):
            lines += signature(value, "    ", cls)
    return [f"class {cls.__name__}:"] + (lines or ["    ..."])


def stubs():
    """The text of the file."""
    parts = []
    for name in sorted(name for name in vars(module) if not name.startswith("_")):
        value = getattr(module, name)
        if isinstance(value, int):
            parts.append([f"{name}: int"])
        elif isinstance(value, type):
            parts.append((enumeration if issubclass(value, enum.IntEnum) else structure)(value))
        else:
            parts.append(signature(value))
    return HEAD + "".join("\n" + "\n".join(lines) + "\n" for lines in parts)


if __name__ == "__main__":
    sys.stdout.write(stubs())
