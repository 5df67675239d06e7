# SPDX-License-Identifier: BSD-3-Clause
"""The other end of `hmcdyn_slam --detector command`: makes a detector of a function."""
import json
import os
import struct
import sys
import zlib
from typing import Any, BinaryIO, Callable, Optional

import numpy

_PROTOCOL = 1


def _png(mask: Any) -> bytes:
    """A mask as the bytes of a PNG of one channel, 8 or 16 bit."""
    mask = numpy.asarray(mask)
    if mask.dtype == bool:
        mask = mask.astype(numpy.uint8)
    if mask.ndim != 2 or mask.dtype not in (numpy.uint8, numpy.uint16):
        raise ValueError(f"the mask is an array of {mask.dtype}, shape {mask.shape}; "
                         "expected (height, width) of bool, uint8 or uint16")
    height, width = mask.shape
    bits = 8 * mask.dtype.itemsize
    rows = mask.astype(">u2" if bits == 16 else numpy.uint8)
    lines = b"".join(b"\0" + row.tobytes() for row in rows)

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(lines, 1)) + chunk(b"IEND", b""))


def _row(box: Any) -> "list[Any]":
    """A box as the protocol has it: x_min, y_min, x_max, y_max, score, class."""
    if hasattr(box, "x_min"):
        return [box.x_min, box.y_min, box.x_max, box.y_max, box.score, box.class_id]
    row = list(box)
    if not 4 <= len(row) <= 6:
        raise ValueError(f"the box {row} has {len(row)} elements; "
                         "expected x_min, y_min, x_max, y_max, perhaps score, perhaps class")
    numbers = [float(value) for value in row[:5]] + [1.0] * (5 - len(row))
    name = row[5] if len(row) == 6 else 0
    return numbers + [name if isinstance(name, str) else int(name)]


def _is_mask(answer: Any, image: Any) -> bool:
    dtype, shape = getattr(answer, "dtype", None), getattr(answer, "shape", ())
    return len(shape) == 2 and (dtype in (bool, numpy.uint8, numpy.uint16) or tuple(shape) == image.shape[:2])


def _read(stream: BinaryIO, size: int) -> Optional[bytearray]:
    """So many bytes, or nothing where the stream ends before."""
    data = bytearray(size)
    view = memoryview(data)
    done = 0
    while done < size:
        got = stream.readinto(view[done:])  # type: ignore[attr-defined]
        if not got:
            return None
        done += got
    return data


def serve_detector(function: Callable[..., Any], version: str = "", timestamps: bool = False) -> None:
    """Answers hmcdyn_slam's images with what a function finds in them, until there are no more.

    function: takes an image, uint8, (height, width, 3), blue first (as OpenCV has it), and returns what moves or
    may move: boxes, DetectionBoxes or rows x_min, y_min, x_max, y_max (px), score (0..1; 1 where it is left out),
    class (COCO, a number or a name; person); or a mask, (height, width) of bool, uint8 or uint16, 0 = background,
    other values number things or classes.
    version: what summary.json is to say of the detector.
    timestamps: the function is called with (image, timestamp (s)).

    What the function prints goes to the standard error. What it throws is told to hmcdyn_slam, which starts the
    program again, up to --command-restarts times.

        hmcdyn_slam --detector command --command 'python3 my_yolo.py' ...

        model = ultralytics.YOLO("yolo11n.pt")
        hmcdyn.serve_detector(lambda image: model(image, verbose=False)[0].boxes.data.cpu().numpy())
    """
    requests = sys.stdin.buffer
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # so that nothing that is printed gets between the answers

    def say(message: "dict[str, Any]", data: bytes = b"") -> None:
        answers.write(json.dumps(message).encode() + b"\n" + data)
        answers.flush()

    try:
        say({"hmcdyn_detector": _PROTOCOL, "version": str(version)})
        while line := requests.readline():
            request = json.loads(line)
            pixels = _read(requests, request["bytes"])
            if pixels is None:
                return
            image = numpy.frombuffer(pixels, numpy.uint8).reshape(request["height"], request["width"], 3)
            found = function(image, request["timestamp"]) if timestamps else function(image)
            if _is_mask(found, image):
                png = _png(found)
                say({"frame": request["frame"], "mask_bytes": len(png)}, png)
            else:
                say({"frame": request["frame"], "boxes": [_row(box) for box in found]})
    except BrokenPipeError:
        return  # hmcdyn_slam has gone
    except Exception as error:
        say({"error": f"{type(error).__name__}: {error}"})
        raise
