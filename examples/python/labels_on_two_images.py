# SPDX-License-Identifier: BSD-3-Clause
"""Labels on two images, in ten lines: what moves is red. python3 labels_on_two_images.py [PICTURE.png]"""
import sys

import matplotlib
import numpy

import hmcdyn

matplotlib.use("Agg")
import matplotlib.pyplot as plot  # noqa: E402


def made_up_images(shift=6):
    """A wall, and a person-sized patch that moves down before it, in two gray images; the second one's depth (m)."""
    texture = [numpy.random.default_rng(i).integers(0, 255, (120, 160)).repeat(4, 0).repeat(4, 1) for i in (1, 2)]
    images = []
    for rows in (slice(90, 390), slice(90 + shift, 390 + shift)):
        image = texture[0].astype(numpy.uint8)
        image[rows, 250:390] = texture[1][:300, :140]
        images.append(image)
    depth = numpy.full((480, 640), 3.0, numpy.float32)
    depth[90 + shift:390 + shift, 250:390] = 1.8
    return *images, depth


earlier, current, depth = made_up_images()
v, u = (grid.ravel() for grid in numpy.mgrid[8:476:12, 8:636:12])  # your key points
boxes = [[230, 70, 410, 420]]  # your detector's: x_min, y_min, x_max, y_max
result = hmcdyn.filter_dynamic_features(earlier, current, u, v, depth[v, u], boxes)

label = hmcdyn.PointLabel
for kind, color in ((label.STATIC, "limegreen"), (label.SUSPECT, "gold"), (label.DYNAMIC, "red")):
    chosen = result.stage.label == kind
    plot.scatter(u[chosen], v[chosen], s=8, c=color, label=f"{kind.name.lower()}: {chosen.sum()}")
plot.imshow(current, cmap="gray")
plot.legend(loc="upper right")
plot.axis("off")
plot.savefig(sys.argv[1] if len(sys.argv) > 1 else "labels.png", bbox_inches="tight", dpi=100)
