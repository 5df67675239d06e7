# SPDX-License-Identifier: BSD-3-Clause
"""Cases of a user's programs: compilers, their options, and versions of what the library stands on."""
from __future__ import annotations

import pathlib
import re
import shutil
from typing import Sequence

from fault_cases.case import Case, Run
from fault_cases.lab import PROJECT, Lab
from fault_cases.outcome import FAILS, Expect, Outcome, Skipped


INCLUDES = ["-I", str(PROJECT / "include"), "-isystem", "/usr/include/eigen3"]


def compiler(lab: Lab) -> pathlib.Path:
    found = shutil.which("g++")
    if found is None:
        raise Skipped("no g++")
    return lab.need(pathlib.Path(found))


def syntax(*flags: str) -> Run:
    """A program of the core headers alone, read by the compiler with these flags."""
    def run(lab: Lab) -> Outcome:
        source = lab.write("user.cpp", "#include <hmcdyn/filter_stage.hpp>\n#include <hmcdyn/motion_mask.hpp>\n"
                                       "int main() {}\n")
        return lab.run([compiler(lab), "-fsyntax-only", *flags, *INCLUDES, source],
                       f"g++ -fsyntax-only {' '.join(flags)} user.cpp")
    return run


def one_error(outcome: Outcome) -> str:
    count = len(re.findall(r"^\S+:\d+:\d+: (?:fatal )?error:", outcome.text, re.M))
    return "" if count <= 2 else f"{count} errors"


def link_words(lab: Lab) -> list[str]:
    """What links a program with the built libraries, from the pkg-config files of the build."""
    build = lab.programs.parent
    words: list[str] = []
    for part in ("vision", "optimization"):
        file = lab.need(build / "pkgconfig" / f"hmcdyn-{part}.pc").read_text()
        for key in ("Cflags", "Libs"):
            words += re.search(rf"^{key}:(.*)$", file, re.M)[1].split()  # type: ignore[index]
    return [w.replace("${libdir}", str(build)) for w in words if "${includedir}" not in w]


def built(lab: Lab, source: pathlib.Path, flags: Sequence[str], name: str) -> Outcome:
    return lab.run([compiler(lab), "-std=c++17", *flags, *INCLUDES, source, "-o", lab.folder / name, *link_words(lab)],
                   f"g++ {' '.join(flags)} {source.name}")


def native(*flags: str) -> Run:
    """The consumer test's program with these flags, linked with libraries that were built without; its 20 000 values
    compared with those of one that was built as the libraries were."""
    def run(lab: Lab) -> Outcome:
        folder = PROJECT / "tests" / "consumers" / "flags"
        for name, words in (("plain", ["-O0"]), ("native", list(flags))):
            made = built(lab, lab.need(folder / "main.cpp"), words, name)
            if made.code != 0:
                return made
        outcome = lab.run([folder / "run.sh", "plain", "native"], cwd=lab.folder)
        if "skipped" in outcome.text:
            raise Skipped(outcome.text.strip())
        outcome.command = f"g++ {' '.join(flags)} main.cpp; flags/run.sh plain native"
        return outcome
    return run


FRAME_FILTER = r"""
#include <cstdio>
#include <opencv2/core.hpp>
#include <hmcdyn/hmcdyn.hpp>
int main() {
  hmcdyn::FrameFilterOptions options;
  options.camera = {525.0, 525.0, 319.5, 239.5};
  hmcdyn::FrameFilter filter(options);
  cv::RNG random(1);
  cv::Mat gray(480, 640, CV_8UC1);
  random.fill(gray, cv::RNG::UNIFORM, 0, 255);
  const cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(2.0));
  std::vector<cv::KeyPoint> points;
  for (int i = 0; i < 400; ++i) points.emplace_back(40.0f + i % 20 * 28.0f, 40.0f + i / 20 * 20.0f, 31.0f);
  const std::vector<hmcdyn::DetectionBox> boxes = {{100, 100, 400, 400}};
  std::size_t kept = 0;
  for (int frame = 0; frame < 5; ++frame) {
    hmcdyn::FrameInput input;
    input.timestamp = frame / 30.0;
    input.gray = gray;
    input.depth = depth;
    input.key_points = points;
    kept = filter.filter(input, boxes).kept;
    filter.setPose(input.timestamp, hmcdyn::Pose(Eigen::Isometry3d::Identity()));
  }
  std::printf("FrameFilter kept %zu of %zu\n", kept, points.size());
  return kept == points.size() ? 0 : 1;
}
"""


def user_program(source: str, *flags: str) -> Run:
    """A small program, built and run; the time is the run's."""
    def run(lab: Lab) -> Outcome:
        made = built(lab, lab.write("user.cpp", source), flags, "user")
        if made.code == 0:
            command, made = made.command, lab.run([lab.folder / "user"])
            made.command = command + "; ./user"
        return made
    return run


def eigen_five(lab: Lab) -> Outcome:
    """The script of ctest's consumers.eigen5, which needs no build; Eigen 5 itself is not here."""
    if shutil.which("cmake") is None or shutil.which("ninja") is None:
        raise Skipped("no cmake or ninja; covered by ctest consumers.eigen5")
    script = lab.need(PROJECT / "tests" / "consumers" / "eigen5.cmake")
    definitions = {"SOURCE": PROJECT, "SCRATCH": lab.folder, "GENERATOR": "Ninja", "COMPILER": compiler(lab),
                   "EIGEN_INCLUDE": "/usr/include/eigen3"}
    return lab.run(["cmake", *(f"-D{k}={v}" for k, v in definitions.items()), "-P", script],
                   "cmake -P tests/consumers/eigen5.cmake (ctest consumers.eigen5)")


def dependency_cases() -> list[Case]:
    """Compilers, their options, and versions of what the library stands on."""
    return [
        Case("1", "user's program with -O3 -march=native", native("-O3", "-march=native"),
             Expect(0, (r"native: \d+ values",))),
        Case("1", "user's program with -mavx2, nothing inlined", native("-O0", "-mavx2", "-mfma"),
             Expect(0, (r"native: \d+ values",))),
        Case("1", "FrameFilter with -O3 -march=native", user_program(FRAME_FILTER, "-O3", "-march=native"),
             Expect(0, ("FrameFilter kept",))),
        Case("2", "core headers with -Ofast", syntax("-std=c++17", "-Ofast"),
             Expect(FAILS, ("-Ofast", "NaN"), checks=(one_error,))),
        Case("own", "core headers with -ffinite-math-only", syntax("-std=c++17", "-ffinite-math-only"),
             Expect(FAILS, ("-ffinite-math-only",), checks=(one_error,))),
        Case("14", "an Eigen whose CMake files say 5.0.0: configured, not compiled", eigen_five, Expect(0, ())),
        Case("15", "consumer in C++11", syntax("-std=c++11"), Expect(FAILS, (r"C\+\+17",), checks=(one_error,))),
        Case("own", "consumer in C++14", syntax("-std=c++14"), Expect(FAILS, (r"C\+\+17",), checks=(one_error,))),
    ]
