# SPDX-License-Identifier: BSD-3-Clause
"""What the C++ headers declare is there in Python: structs with all fields, enumerations with all values, functions.

The headers are read here without the build's extract_comments.py, which sees members with a comment only.
"""
import pathlib
import re

import hmcdyn
import pytest

ROOT = pathlib.Path(__file__).parents[2]
INCLUDE = ROOT / "include/hmcdyn"
HEADERS = [header for folder in (".", "steps", "votes", "peers") for header in sorted((INCLUDE / folder).glob("*.hpp"))]
EVALUATION = [ROOT / "examples/evaluate" / f"{name}.hpp"
              for name in ("absolute_trajectory_error", "alignment", "relative_pose_error", "statistics")]

# Structs that Python has in another form, or not.
IN_ANOTHER_FORM = {
    "FrameInput", "Regions", "MotionMaskFrame", "PoseObservations",  # arguments, see below
    "KeyPointsView", "KeyPoints", "PointPairsView", "MotionBeliefInput", "DynamicFeatureFilterInput", "EarlierFrame",
    "AteOptions", "RpeOptions",  # arguments
    "Span", "LabelImageView", "DepthImageView", "Pose", "PlainMatrix",  # arrays
}
LEFT_OUT = {
    "BoxCarrier", "BoxCarrierOptions", "CarriedFrame", "FrameDetection",  # within FrameFilter
    "ClusteringWorkspace", "FilterStageWorkspace", "DepthRansacWorkspace", "DynamicFeatureFilterWorkspace",
    "MotionBeliefWorkspace", "PoseRefinementWorkspace",  # memory between calls
    "RegionOfLabel", "DepthWindow", "Surface", "Votes", "VoteSum", "DepthPair",  # their parts
}


def without_comments(header):
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", header.read_text(), flags=re.S)
    return re.sub(r"^\s*#[^\n]*(\\\n[^\n]*)*", "", text, flags=re.M)


def body_at(text, opening):
    """What is between the brace at `opening` and the one that closes it."""
    depth = 0
    for i in range(opening, len(text)):
        depth += {"{": 1, "}": -1}.get(text[i], 0)
        if depth == 0:
            return text[opening + 1:i]
    raise ValueError("braces do not match")


def without_blocks(text):
    """Each block becomes {}, and a function's {} ends its declaration."""
    depth, kept = 0, []
    for letter in text:
        depth -= letter == "}"
        if depth == 0:
            kept.append(letter)
        depth += letter == "{"
    return re.sub(r"\)[\w\s]*\{\}", ");", "".join(kept))


def declared(kind, headers=HEADERS):
    """(name, body) of each struct, class or enumeration that is not within another one."""
    for header in headers:
        text = without_comments(header)
        for match in re.finditer(rf"^{kind} (\w+)[^;{{(]*\{{", text, flags=re.M):
            yield match.group(1), body_at(text, match.end() - 1)


def fields_of(body):
    names = []
    for statement in without_blocks(body).split(";"):
        statement = re.sub(r"\w+:(?!:)", "", statement).strip()  # public:
        while "<" in statement.split("=")[0]:
            shorter = re.sub(r"<[^<>]*>", "", statement)
            if shorter == statement:
                break
            statement = shorter
        statement = re.sub(r"=.*|\{\}", "", statement, flags=re.S)
        words = statement.split()
        if "(" in statement or len(words) < 2 or words[0] in ("using", "static", "friend", "enum", "struct", "template"):
            continue
        names += [part.split()[-1] for part in statement.split(",")]
    return names


def functions():
    """Free functions of the namespace hmcdyn."""
    for header in HEADERS:
        for match in re.finditer(r"^namespace hmcdyn \{", text := without_comments(header), flags=re.M):
            for statement in without_blocks(body_at(text, match.end() - 1)).split(";"):
                found = re.search(r"(\w+)\s*\(", statement.split("=")[0])
                words = statement.split()
                if found and len(words) > 1 and words[0] not in ("struct", "class", "using", "static_assert"):
                    yield found.group(1)


def snake_case(name):
    return re.sub(r"(?<!^)([A-Z])", r"_\1", name).lower()


STRUCTS = dict(list(declared("struct")) + list(declared("struct", EVALUATION)))


def test_the_headers_are_read():
    assert {"FrameFilterResult", "ClusteringOptions", "DetectionBox", "RpeResult"} <= STRUCTS.keys()
    assert fields_of(STRUCTS["DetectionBox"]) == ["x_min", "y_min", "x_max", "y_max", "class_id", "score"]
    assert "mask" in fields_of(STRUCTS["FrameFilterResult"])
    assert {"filterKeyPoints", "refinePose", "surfaceDepths"} <= set(functions())


def test_every_struct_and_class_is_there_or_left_out_on_purpose():
    names = {name for kind in ("struct", "class") for name, _ in declared(kind)} | STRUCTS.keys()
    assert {name for name in names if not hasattr(hmcdyn, name)} == IN_ANOTHER_FORM | LEFT_OUT


@pytest.mark.parametrize("name", sorted(name for name in STRUCTS if hasattr(hmcdyn, name)))
def test_every_field_is_there(name):
    properties = {field.rstrip("_") for field, value in vars(getattr(hmcdyn, name)).items()
                  if isinstance(value, property)}
    missing = set(fields_of(STRUCTS[name])) - properties
    assert not missing


@pytest.mark.parametrize("name, body", list(declared("enum class")) + list(declared("enum class", EVALUATION)))
def test_every_enumerator_is_there(name, body):
    expected = {}
    for number, enumerator in enumerate(part.split("=") for part in body.split(",") if part.strip()):
        value = int(enumerator[1]) if len(enumerator) == 2 else number
        expected[snake_case(enumerator[0].strip()[1:]).upper()] = value
    assert {member: value.value for member, value in getattr(hmcdyn, name).__members__.items()} == expected


@pytest.mark.parametrize("struct, function, in_another_form", [
    ("FrameInput", hmcdyn.FrameFilter.filter, set()),
    # A FrameFilter gives its verdicts to its mask itself.
    ("MotionMaskFrame", hmcdyn.MotionMaskEstimator.update, {"pose_is_known", "points", "verdicts"}),
    ("PoseObservations", hmcdyn.refine_pose, set()),
])
def test_every_field_of_an_input_is_an_argument(struct, function, in_another_form):
    arguments = set(re.findall(r"(\w+):", function.__doc__.split("\n")[0]))
    assert set(fields_of(STRUCTS[struct])) - arguments == in_another_form


def test_every_function_is_there_or_left_out_on_purpose():
    left_out = {
        "dropBeyondThreshold", "dropByChiSquare", "dropByDepthRansac", "dropByTwoThresholds", "dropWholeBoxes",  # rules
        "intersectionOverUnion", "mergeDoubles", "clipToImage",  # of boxes
        "depthError", "depthNoise", "relativeDepthError", "systematicDepthError", "hasDepth", "compact",
        "depthSimilarity", "keptPointWeight", "epipolarDistance", "epipolarLine",  # of one point; Python has arrays
        "knownMotion", "backgroundSuffices", "buildFlowPyramid",  # within the calls of a frame
        "filterRuleFromString", "toString",  # an enumeration takes and has names
        "checkBelief", "checkKeyPoints", "checkModel", "checkOptions", "checkPointPairs",  # each call checks
    }
    assert {name for name in functions() if not hasattr(hmcdyn, snake_case(name))} == left_out
