# SPDX-License-Identifier: BSD-3-Clause
"""Cases of settings files and calibrations."""
from __future__ import annotations

import json
from typing import Sequence

from fault_cases.case import Case, Run, camera, images
from fault_cases.images import millimetres, shrunk
from fault_cases.outcome import ANY, READ, Expect, read_or, refused


def settings(*drop: str, **changes: str) -> str:
    """A settings file as ORB-SLAM2 has them, of this clip; in names of changes _ stands for the dot."""
    values = {"Camera.fx": "535.4", "Camera.fy": "539.2", "Camera.cx": "320.1", "Camera.cy": "247.6",
              "Camera.k1": "0.0", "Camera.k2": "0.0", "Camera.p1": "0.0", "Camera.p2": "0.0",
              "Camera.width": "640", "Camera.height": "480", "Camera.fps": "30.0", "Camera.bf": "40.0",
              "Camera.RGB": "1", "ThDepth": "40.0", "DepthMapFactor": "5000.0", "ORBextractor.nFeatures": "1000"}
    values.update({key.replace("_", ".", 1): value for key, value in changes.items()})
    return "%YAML:1.0\n\n# Camera\n" + "".join(f"{k}: {v}\n" for k, v in values.items() if k not in drop)


VIEWER = "Viewer.KeyFrameSize: 0.05\nViewer.PointSize:2\nViewer.LineWidth:0.9\nViewer.ViewpointF: 500\n"


def stock(fx: float, fy: float, cx: float, cy: float, distortion: Sequence[float] = ()) -> str:
    """A settings file as ORB-SLAM2 comes with: the last keys without a blank behind the colon."""
    names = zip(("Camera_k1", "Camera_k2", "Camera_p1", "Camera_p2", "Camera_k3"), distortion)
    return settings(Camera_fx=str(fx), Camera_fy=str(fy), Camera_cx=str(cx), Camera_cy=str(cy),
                    **{name: str(value) for name, value in names}) + VIEWER


NESTED = """# as stella_vslam has them
Camera:
  name: "TUM RGBD 3"
  setup: "RGBD"
  model: "perspective"
  fx: 535.4
  fy: 539.2
  cx: 320.1
  cy: 247.6
  k1: 0.0
  k2: 0.0
  p1: 0.0
  p2: 0.0
  k3: 0.0
  fps: 30.0
  cols: 640
  rows: 480
  color_order: "RGB"
  depthmap_factor: 5000.0
"""


OPEN3D = json.dumps({"width": 640, "height": 480,
                     "intrinsic_matrix": [535.4, 0, 0, 0, 539.2, 0, 320.1, 247.6, 1]}, indent=1)


ROS_ECHO = """header:
  stamp:
    secs: 1341846434
    nsecs: 710184000
  frame_id: "camera_rgb_optical_frame"
height: 480
width: 640
distortion_model: "plumb_bob"
D: [0.0, 0.0, 0.0, 0.0, 0.0]
K: [535.4, 0.0, 320.1, 0.0, 539.2, 247.6, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
P: [535.4, 0.0, 320.1, 0.0, 0.0, 539.2, 247.6, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
binning_y: 0
"""


ORB_SLAM3 = """%YAML:1.0
File.version: "1.0"
Camera.type: "PinHole"
Camera1.fx: 535.4
Camera1.fy: 539.2
Camera1.cx: 320.1
Camera1.cy: 247.6
Camera.width: 640
Camera.height: 480
Camera.fps: 30
Camera.RGB: 1
Stereo.ThDepth: 40.0
Stereo.b: 0.0745
RGBD.DepthMapFactor: 5000.0
"""


def options_with_camera(name: str) -> Run:
    return lambda lab: lab.slam(lab.copy(), camera=name)


def plausibility_cases() -> list[Case]:
    """What no camera has is refused with what would fit; what cannot be told is said."""
    twice = {"Camera_fx": "1070.8", "Camera_fy": "1078.4", "Camera_cx": "640.2", "Camera_cy": "495.2"}
    return [
        Case("9", "depth factor 1.0", camera(settings(DepthMapFactor="1.0")),
             Expect(ANY, ("median of [\\d.]+ km",))),
        Case("10", "depth in mm under a camera of 5000", images("depth", millimetres),
             Expect(ANY, ("1000|millimet",))),
        Case("own", "depth of 5000 read as mm", camera(settings(DepthMapFactor="1000.0")), Expect(ANY, ("5000",))),
        Case("11", "k4, k5, k6 that are not 0",
             camera(settings(Camera_k4="0.31", Camera_k5="-0.2", Camera_k6="0.05")), refused("k4|k5|k6", "rectify")),
        Case("12", "intrinsics of 1280 x 960, size 640 x 480", camera(settings(**twice)),
             refused("1280 x 960", "535.4")),
        Case("12", "intrinsics and size of 1280 x 960",
             camera(settings(**twice, Camera_width="1280", Camera_height="960")), refused("1280 x 960", "535.4")),
        Case("12", "intrinsics of 1280 x 960 without a size",
             camera(settings("Camera.width", "Camera.height", **twice)), refused("1280 x 960", "535.4")),
        Case("12", "cx = 1320", camera(settings(Camera_cx="1320")), refused("1320", "outside")),
        Case("12", "Camera.fx twice, with two values", camera(settings() + "Camera.fx: 517.3\n"),
             refused("Camera.fx is given twice", "535.4", "517.3")),
        Case("own", "width and height exchanged", camera(settings(Camera_width="480", Camera_height="640")),
             refused("480 x 640", "640 x 480")),
        Case("own", "fy negative, as in graphics", camera(settings(Camera_fy="-539.2")), refused("fy", "-539.2")),
        Case("own", "fx is .nan", camera(settings(Camera_fx=".nan")), refused("settings.yaml:4", "fx", "nan")),
        Case("own", "fx in thousands: 0.5354", camera(settings(Camera_fx="0.5354", Camera_fy="0.5392")),
             refused("fx|focal")),
        Case("own", "images halved, camera tum3",
             images("rgb", shrunk), refused("320 x 240", "267.7")),
        Case("own", "ROS's default calibration (525, 319.5)",
             camera(settings(Camera_fx="525.0", Camera_fy="525.0", Camera_cx="319.5", Camera_cy="239.5")),
             Expect(0, ("tracked 15 of 15",))),
    ]


def settings_cases() -> list[Case]:
    """What its own system reads is read; else a sentence on what kind of file it is."""
    sizes = ("Camera.width", "Camera.height")
    return [
        Case("29", "ORB-SLAM2's TUM1.yaml",
             camera(stock(517.306408, 516.469215, 318.643040, 255.313989,
                          (0.262383, -0.953104, -0.005358, 0.002628, 1.163314)), "TUM1.yaml"),
             Expect(0, ("tracked 15 of 15",))),
        Case("29", "ORB-SLAM2's TUM2.yaml",
             camera(stock(520.908620, 521.007327, 325.141442, 249.701764,
                          (0.231222, -0.784899, -0.003257, -0.000105, 0.917205)), "TUM2.yaml"),
             Expect(0, ("tracked 15 of 15",))),
        Case("29", "ORB-SLAM2's TUM3.yaml", camera(stock(535.4, 539.2, 320.1, 247.6), "TUM3.yaml"), READ),
        Case("30", "no Camera.width, Camera.height", camera(settings(*sizes) + VIEWER), READ),
        Case("31", "stella_vslam's, keys nested", camera(NESTED), READ),
        Case("31", "KITTI's, no depth factor", camera(settings("DepthMapFactor")), refused("DepthMapFactor", "KITTI")),
        Case("31", "an unfilled template", camera(settings(Camera_fx="<fx>", Camera_fy="<fy>")),
             refused("settings.yaml:4", "<fx>", "template")),
        Case("31", "two headers pasted into one value", camera(settings(Camera_fx="%YAML:1.0 %YAML:1.0 535.4")),
             refused("settings.yaml:4", "Camera.fx", "two lines in one|header")),
        Case("other", "no %YAML line", camera(settings().split("\n", 1)[1] + VIEWER), READ),
        Case("24", "--camera TUM3.yaml that is missing", options_with_camera("TUM3.yaml"),
             refused("TUM3.yaml", "no such file|not found")),
        Case("own", "ORB-SLAM3's version 1.0 (Camera1.fx)", camera(ORB_SLAM3), READ),
        Case("own", "OpenCV's XML",
             camera("<?xml version=\"1.0\"?>\n<opencv_storage>\n<Camera.fx>535.4</Camera.fx>\n</opencv_storage>\n",
                    "camera.xml"), refused("XML")),
        Case("own", "Open3D's JSON (columns first), no depth factor", camera(OPEN3D, "camera.json"),
             refused("camera.json", "depth|JSON")),
        Case("own", "rostopic echo, two messages, a depth factor",
             camera("depth_factor: 5000\n" + ROS_ECHO + "---\n" + ROS_ECHO + "---\n"), READ),
        Case("own", "a comment in Latin-1",
             camera(settings().encode() + "# für die Küche\n".encode("latin-1")), READ),
        Case("own", "units behind values: 535.4 px", camera(settings(Camera_fx="535.4 px")),
             refused("settings.yaml:4", "535.4 px")),
        Case("own", "decimal commas", camera(settings(Camera_fx="535,4", Camera_fy="539,2")),
             refused("settings.yaml:4", "535,4", "comma|point")),
        Case("own", "an empty file", camera(""), refused("settings.yaml", "empty|no settings|no focal")),
        Case("own", "an image", lambda lab: lab.slam(lab.copy(), camera=lab.clip.folder / lab.clip.rgb[0][1]),
             refused("png", "binary|image|not")),
        Case("own", "a folder", lambda lab: lab.slam(lab.copy(), camera=lab.clip.folder), refused("folder|directory")),
        Case("own", "names of the keys in capitals (CAMERA.FX)",
             camera("".join(l.split(":")[0].upper() + ":" + l.split(":", 1)[1] + "\n" if ":" in l and l[0] != "%" else l
                            + "\n" for l in settings().splitlines())), read_or("CAMERA.FX|focal length|Camera.fx")),
    ]
