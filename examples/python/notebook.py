# SPDX-License-Identifier: BSD-3-Clause
# A notebook in the percent format: Jupyter (jupytext), VS Code and Spyder open it as cells, python3 runs it as it is,
# in the folder that holds crowd. docs/notebook.md is this file with what it prints and draws.

# %% [markdown]
# # A notebook: what moves in front of the camera
#
# From two images to a trajectory and masks, with numpy, OpenCV and matplotlib. The sequence is rendered, so that the
# truth is known of every pixel:
#
# ```sh
# hmcdyn_synthesize --scene crowd --frames 45 --output crowd
# ```

# %%
import pathlib

import cv2
import matplotlib.pyplot as plot
import numpy

import hmcdyn
from masks_for_folder import pose_of
from track_folder import FrontEnd, frames_of, read_boxes, tum_row

folder = pathlib.Path("crowd")
frames = list(frames_of(folder))  # (time stamp (s), gray, depth (m)) of each
boxes = read_boxes(folder / "boxes.txt")  # people, by time stamp; here a detector's would be
boxes = [boxes.get(round(time, 4), []) for time, _, _ in frames]
truth = [cv2.imread(str(file), cv2.IMREAD_UNCHANGED) for file in sorted((folder / "mask").glob("*.png"))]
camera = hmcdyn.PinholeCamera(535.4, 539.2, 320.1, 247.6)
print(len(frames), "frames of", frames[0][1].shape, "px,", sum(map(len, boxes)), "boxes")

# %% [markdown]
# ## Two images
#
# Key points of any front end, here OpenCV's corners, and an image from 0.1 s before. hmcdyn follows the key points
# back into it, estimates how the camera moved, and measures how far each point is from where a standing one would be.

# %%
now, before = 20, 17
_, gray, depth = frames[now]
u, v = cv2.goodFeaturesToTrack(gray, 1000, 0.01, 7)[:, 0].T
z = depth[v.astype(int), u.astype(int)]
result = hmcdyn.filter_dynamic_features(frames[before][1], gray, u, v, z, boxes[now])

# %% [markdown]
# Red is far from its epipolar line. What is near may still move, along that line; a depth that does not fit the
# neighbours, and the box around, tell the rest.

# %%
figure, (left, right) = plot.subplots(1, 2, figsize=(12, 4.8), layout="constrained")
for axes in (left, right):
    axes.imshow(gray, cmap="gray")
    axes.axis("off")
    for x_min, y_min, x_max, y_max, *_ in boxes[now]:
        axes.add_patch(plot.Rectangle((x_min, y_min), x_max - x_min, y_max - y_min, fill=False, color="deepskyblue"))
drawn = left.scatter(u, v, s=7, c=result.distance, cmap="RdYlGn_r", vmin=0, vmax=3)
figure.colorbar(drawn, ax=left, label="distance (px)", shrink=0.8)
label = result.stage.label
for kind, color in ((hmcdyn.PointLabel.STATIC, "limegreen"), (hmcdyn.PointLabel.SUSPECT, "gold"),
                    (hmcdyn.PointLabel.DYNAMIC, "red"), (hmcdyn.PointLabel.UNMATCHED, "gray")):
    chosen = label == kind
    right.scatter(u[chosen], v[chosen], s=7, c=color, label=f"{kind.name.lower()}: {chosen.sum()}")
right.legend(loc="lower right", fontsize=8)

# %% [markdown]
# How good that is, against the truth: a point moves where the mask says 255.

# %%
moves = truth[now][v.astype(int), u.astype(int)] == 255
left_out = label == hmcdyn.PointLabel.DYNAMIC
print(f"{moves.sum()} of {len(u)} points move; of the {left_out.sum()} left out {(moves & left_out).sum()} do")

# %% [markdown]
# ## A sequence
#
# `FrameFilter` keeps what it needs of earlier images, so that a front end has one call a frame: see `FrontEnd.track` in
# [track_folder.py](../examples/python/track_folder.py), which has OpenCV's ORB and PnP and nothing else. It tracks the
# folder twice, without the filter and with it.

# %%
trajectories = {}
for rule in ("none", "hmc"):
    front_end = FrontEnd(camera, rule)
    poses = [(time, front_end.track(time, gray, depth, boxes[i])) for i, (time, gray, depth) in enumerate(frames)]
    trajectories[rule] = numpy.array([tum_row(time, pose) for time, pose in poses if pose is not None])

groundtruth = hmcdyn.read_trajectory(folder / "groundtruth.txt")
errors = {rule: hmcdyn.ate(groundtruth, rows) for rule, rows in trajectories.items()}
for rule, found in errors.items():
    relative = hmcdyn.rpe(groundtruth, trajectories[rule], delta=1.0)
    print(f"{rule:4}: ATE {found.error.rmse:.3f} m (largest {found.error.max:.3f}), "
          f"RPE {relative.translation.rmse:.3f} m a second, {len(trajectories[rule])} frames tracked")

# %%
figure, (left, right) = plot.subplots(1, 2, figsize=(11, 4), layout="constrained")
left.plot(*groundtruth[:, 1:3].T, "k", label="truth")
for rule, color in (("none", "red"), ("hmc", "limegreen")):
    left.plot(*errors[rule].estimated[:, :2].T, color=color, label=rule)
    right.plot(errors[rule].timestamps - groundtruth[0, 0], errors[rule].errors, color=color, label=rule)
left.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
right.set(xlabel="time (s)", ylabel="error (m)")
left.legend()
right.legend()

# %% [markdown]
# ## Masks
#
# With poses, and without any box, `MotionMaskEstimator` says of every pixel whether it moves: 255 does, 128 stands but
# moved before, 64 is unknown (dark in the picture: the wall beyond 4 m). For a dense map `static_depth` takes the
# moving pixels out of the depth.

# %%
estimator = hmcdyn.MotionMaskEstimator(camera)
masks = []
for (time, gray, depth), row in zip(frames, groundtruth):
    masks.append(estimator.update(time, depth, pose_of(row), gray=gray).label.copy())

found, wanted = [mask == 255 for mask in masks[5:]], [mask == 255 for mask in truth[5:]]
both = sum((a & b).sum() for a, b in zip(found, wanted))
print(f"of the pixels that move {both / sum(a.sum() for a in wanted):.0%} are found; "
      f"of those found {both / sum(a.sum() for a in found):.0%} move")

# %%
figure, axes = plot.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
color_of = numpy.zeros((256, 3), numpy.uint8)
color_of[[64, 128, 255]] = (60, 60, 60), (255, 200, 0), (255, 0, 0)
for axis, mask, title in ((axes[0], masks[now], "found, without a detector"), (axes[1], truth[now], "truth")):
    gray = cv2.cvtColor(frames[now][1], cv2.COLOR_GRAY2RGB)
    axis.imshow(numpy.where((mask > 0)[..., None], gray // 2 + color_of[mask] // 2, gray))
    axis.set_title(title)
    axis.axis("off")
