# SPDX-License-Identifier: BSD-3-Clause
"""Cases of networks: just enough of ONNX to write a model that answers every image with the same numbers."""
from __future__ import annotations

import dataclasses
from typing import Any, Callable, Sequence, Union

import numpy as np

from fault_cases.case import Case, Run
from fault_cases.outcome import Expect, refused


def varint(value: int) -> bytes:
    out = b""
    while value > 0x7F:
        out, value = out + bytes([value & 0x7F | 0x80]), value >> 7
    return out + bytes([value])


def field(number: int, value: Union[int, bytes, str]) -> bytes:
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    content = value.encode() if isinstance(value, str) else value
    return varint(number << 3 | 2) + varint(len(content)) + content


def tensor(name: str, values: Any, sides: Sequence[int]) -> bytes:
    kind = 1 if values.dtype == np.float32 else 7
    return b"".join(field(1, s) for s in sides) + field(2, kind) + field(8, name) + field(9, values.tobytes())


def value_info(name: str, sides: Sequence[int]) -> bytes:
    shape = b"".join(field(1, field(1, s)) for s in sides)
    return field(1, name) + field(2, field(1, field(1, 1) + field(2, shape)))


def onnx_node(kind: str, inputs: Sequence[str], output: str, attribute: bytes = b"") -> bytes:
    return (b"".join(field(1, i) for i in inputs) + field(2, output) + field(3, kind + output) + field(4, kind) +
            (field(5, attribute) if attribute else b""))


def onnx_model(answer: Any, side: int, last: str = "Reshape") -> bytes:
    """@param answer the output, whatever the image; @param last operator that shapes it."""
    flat, n = answer.astype(np.float32).ravel(), answer.size
    kernel = field(1, "kernel_shape") + field(8, 1) + field(8, 1) + field(20, 7)
    graph = [field(1, onnx_node("GlobalAveragePool", ["images"], "mean")),
             field(1, onnx_node("Conv", ["mean", "kernels", "biases"], "flat", kernel)),
             field(1, onnx_node(last, ["flat", "shape"], "output0")), field(2, "answer"),
             field(5, tensor("kernels", np.zeros(3 * n, np.float32), (n, 3, 1, 1))),
             field(5, tensor("biases", flat, (n,))),
             field(5, tensor("shape", np.array(answer.shape, np.int64), (answer.ndim,))),
             field(11, value_info("images", (1, 3, side, side))), field(12, value_info("output0", answer.shape))]
    return field(1, 7) + field(7, b"".join(graph)) + field(8, field(2, 12))


def network(answer: Callable[[], Any], side: int = 64, last: str = "Reshape") -> Run:
    """S with a model of that answer."""
    return lambda lab: lab.slam(lab.copy(), "--detector", "yolo", "--input-size", str(side), "--model",
                                lab.write("net.onnx", onnx_model(answer(), side, last)))


def zeros(*sides: int) -> Callable[[], Any]:
    return lambda: np.full(sides, 0.01)


def undecoded() -> Any:
    """YOLOX for 640 px as its export leaves it: offsets in a cell, logarithms of sizes, then probabilities."""
    random = np.random.default_rng(1)
    out = np.full((1, 8400, 85), 0.01)
    out[..., :2] = random.uniform(-0.5, 1.5, (1, 8400, 2))
    out[..., 2:4] = random.normal(0.0, 1.0, (1, 8400, 2))
    return out


def head_cases() -> list[Case]:
    """A network whose output is not decoded is named for what it is."""
    def ours(*said: str) -> Expect:
        return dataclasses.replace(refused(*said, "hmcdyn does not decode", "export"), unsaid=("OpenCV",))
    return [
        Case("13", "YOLOX, undecoded (1 x 8400 x 85)", network(undecoded, 640), ours("YOLOX")),
        Case("22", "YOLOv7 --end2end (37 x 7)", network(zeros(37, 7)), ours("YOLOv7")),
        Case("22", "YOLOv10 (1 x 300 x 6)", network(zeros(1, 300, 6)), ours("YOLOv10")),
        Case("22", "YOLOv8 segmentation (1 x 116 x 8400)", network(zeros(1, 116, 8400), 640), ours("segmentation")),
        Case("22", "raw heads (1 x 255 x 20 x 20)", network(zeros(1, 255, 20, 20)), ours("1 x 255 x 20 x 20")),
        Case("22", "transposed YOLOv8 (1 x 8400 x 84)", network(zeros(1, 8400, 84), 640), ours("transposed")),
        Case("22", "one class (1 x 5 x 8400)", network(zeros(1, 5, 8400), 640), ours("1 class|one class")),
        Case("own", "an operator that no importer knows", network(zeros(1, 84, 84), last="NoSuchOperator"),
             refused("net.onnx", "OpenCV \\d", "NoSuchOperator")),
        Case("own", "a PyTorch .pt as --model",
             lambda lab: lab.slam(lab.copy(), "--detector", "yolo", "--model", lab.write("yolov8n.pt", b"PK\3\4" * 99)),
             refused("yolov8n.pt", "export|ONNX")),
    ]
