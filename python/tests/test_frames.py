# SPDX-License-Identifier: BSD-3-Clause
"""Images: the filter of two images, FrameFilter, the motion mask, the refinement, the evaluator."""
import gc
import threading

import hmcdyn
import numpy
import pytest


def scene(shift, height=240, width=320):
    """A textured wall, and a textured patch before it that moves to the right by `shift` px."""
    wall = numpy.random.default_rng(1).integers(0, 255, (height // 4, width // 4)).repeat(4, 0).repeat(4, 1)
    patch = numpy.random.default_rng(2).integers(0, 255, (30, 15)).repeat(4, 0).repeat(4, 1)
    depth = numpy.full((height, width), 3, numpy.float32)
    gray = wall.astype(numpy.uint8)
    gray[60:180, 100 + shift:160 + shift] = patch
    depth[60:180, 100 + shift:160 + shift] = 1.5
    return gray, depth


def corners():
    """Every corner of the texture."""
    v, u = numpy.mgrid[8:236:8, 8:316:8]
    return numpy.stack([u.ravel(), v.ravel()], 1).astype(numpy.float32)


def boxes(shift):
    return [[95 + shift, 55, 165 + shift, 185, 0.9, 0]]


def run(filters, frames=4):
    results = []
    for i in range(frames):
        gray, depth = scene(4 * i)
        results.append(filters.filter(i / 30, gray, corners(), boxes(4 * i), depth=depth))
    return results


def inside(shift):
    points = corners()
    return ((points[:, 0] > 104 + shift) & (points[:, 0] < 156 + shift) & (points[:, 1] > 64)
            & (points[:, 1] < 176))


def test_two_images_say_what_moves():
    earlier, _ = scene(0)
    current, depth = scene(4)
    points = corners()
    at = points.astype(int)
    result = hmcdyn.filter_dynamic_features(earlier, current, points[:, 0], points[:, 1], depth[at[:, 1], at[:, 0]],
                                            boxes(4))
    moving = result.stage.label == hmcdyn.PointLabel.DYNAMIC
    assert moving[inside(4)].mean() > 0.9
    assert moving[~inside(-50) & (points[:, 0] > 200)].mean() == 0


def test_regions_say_which_labels_may_move_and_an_empty_list_that_none_may():
    (earlier, _), (current, depth) = scene(0), scene(4)
    points = corners()
    at = points.astype(int)
    labels = numpy.zeros(current.shape, numpy.uint8)
    labels[55:186, 99:170] = 3

    def moving(**regions):
        result = hmcdyn.filter_dynamic_features(earlier, current, points[:, 0], points[:, 1],
                                                depth[at[:, 1], at[:, 0]], labels=labels, **regions)
        return (result.stage.label == hmcdyn.PointLabel.DYNAMIC)[inside(4)].mean(), len(result.stage.boxes)

    assert moving() == moving(regions=[hmcdyn.LabelRegion(3)])
    assert moving()[0] > 0.9
    assert moving(regions=[])[1] == 0


def test_frame_filter_drops_who_moves_and_repeats_bit_for_bit():
    first, again = run(hmcdyn.FrameFilter()), run(hmcdyn.FrameFilter())
    assert first[0].status == hmcdyn.FrameFilterStatus.NO_HISTORY
    assert first[3].status == hmcdyn.FrameFilterStatus.FILTERED
    assert first[3].keep.dtype == bool
    assert first[3].keep[inside(12)].mean() < 0.1
    for one, other in zip(first, again):
        assert one.weight.tobytes() == other.weight.tobytes()
        assert one.lambda_.tobytes() == other.lambda_.tobytes()


def test_frame_filter_lets_go_of_its_images():
    filters = hmcdyn.FrameFilter()
    gray, depth = scene(0)
    filters.filter(0.0, gray, corners(), boxes(0), depth=depth)
    gray[:] = 0  # the filter has its own copy
    del gray, depth
    gc.collect()
    gray, depth = scene(4)
    result = filters.filter(1 / 30, gray, corners(), boxes(4), depth=depth)
    expected = run(hmcdyn.FrameFilter(), 2)[1]
    assert result.keep.tobytes() == expected.keep.tobytes()


@pytest.mark.parametrize("change, message", [
    (lambda gray, depth: (gray.astype(numpy.float32), depth), "gray is an array of float32"),
    (lambda gray, depth: (numpy.dstack([gray] * 3), depth), r"gray is an array of uint8, shape \(240, 320, 3\)"),
    (lambda gray, depth: (gray, (depth * 5000).astype(numpy.uint16)), "divide what the camera's file holds"),
    (lambda gray, depth: (gray, depth[:100]), "expected"),
    (lambda gray, depth: (gray[:0], depth), r"gray is an array of uint8, shape \(0, 320\)"),
])
def test_frames_of_another_type_or_size_are_refused_and_not_remembered(change, message):
    filters = hmcdyn.FrameFilter()
    gray, depth = change(*scene(0))
    with pytest.raises(ValueError, match=message):
        filters.filter(0.0, gray, corners(), boxes(0), depth=depth)
    gray, depth = scene(0)
    assert filters.filter(0.0, gray, corners(), boxes(0), depth=depth).status == hmcdyn.FrameFilterStatus.NO_HISTORY


def test_strided_and_read_only_images_give_the_same():
    expected = run(hmcdyn.FrameFilter(), 2)[1]
    filters = hmcdyn.FrameFilter()
    for i in range(2):
        gray, depth = scene(4 * i)
        wide = numpy.zeros((240, 400), numpy.uint8)
        wide[:, 40:360] = gray
        depth = numpy.asfortranarray(depth.astype(numpy.float64))
        depth.setflags(write=False)
        result = filters.filter(i / 30, wide[:, 40:360], corners(), boxes(4 * i), depth=depth)
    assert result.weight.tobytes() == expected.weight.tobytes()


def test_a_silent_detector_is_not_one_that_found_nothing():
    silent, nothing = hmcdyn.FrameFilter(), hmcdyn.FrameFilter()
    gray, depth = scene(0)
    for filters in (silent, nothing):
        filters.filter(0.0, gray, corners(), boxes(0), depth=depth)
    gray, depth = scene(4)
    assert len(silent.filter(1 / 30, gray, corners(), depth=depth).boxes) == 1
    assert nothing.filter(1 / 30, gray, corners(), [], depth=depth).bridged <= 1


def test_two_threads_share_a_filter_without_harm():
    filters = hmcdyn.FrameFilter()
    gray, depth = scene(0)

    def work(first):
        for i in range(20):
            filters.filter(first + i, gray, corners(), boxes(0), depth=depth)

    threads = [threading.Thread(target=work, args=(first,)) for first in (0.0, 0.5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert filters.options.min_kept == 100


def test_motion_mask_finds_what_came_into_free_space():
    estimator = hmcdyn.MotionMaskEstimator(hmcdyn.PinholeCamera(300, 300, 160, 120))
    for i in range(8):
        gray, depth = scene(6 * i)
        mask = estimator.update(i / 15, depth, numpy.eye(4), gray=gray)
    assert mask.state == hmcdyn.MaskState.GOOD
    moving = mask.label == hmcdyn.MaskLabel.MOVING
    assert moving[80:160, 150:195].mean() > 0.5
    assert moving[:40].mean() == 0
    kept = mask.label.copy()
    estimator.update(1.0, depth, numpy.eye(4), gray=gray)
    numpy.testing.assert_array_equal(mask.label, kept)  # the next call leaves it alone
    static = hmcdyn.static_depth(depth, mask.label)
    assert (static[moving] == 0).all()


def test_refine_pose_finds_the_pose_of_exact_pixels():
    camera = hmcdyn.PinholeCamera(500, 500, 320, 240)
    points = numpy.random.default_rng(3).uniform([-1, -1, 2], [1, 1, 4], (50, 3)).astype(numpy.float32)
    pose = numpy.eye(4)
    pose[:3, 3] = [0.05, -0.02, 0.03]
    seen = points + pose[:3, 3]
    u, v = 500 * seen[:, 0] / seen[:, 2] + 320, 500 * seen[:, 1] / seen[:, 2] + 240
    result = hmcdyn.refine_pose(*points.T, u, v, camera, numpy.eye(4))
    assert result.succeeded
    assert result.termination == hmcdyn.PoseRefinementTermination.CONVERGED
    numpy.testing.assert_allclose(result.camera_from_world, pose, atol=1e-5)
    assert result.covariance.shape == (6, 6)
    with pytest.raises(ValueError, match=r"initial is an array of float64, shape \(2, 2\)"):
        hmcdyn.refine_pose(*points.T, u, v, camera, numpy.eye(2))


def trajectory(offset=0.0):
    time = numpy.arange(50) / 10
    rows = numpy.zeros((50, 8))
    rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 7] = time, time, numpy.sin(time), 1
    rows[:, 3] = offset * (-1.0) ** numpy.arange(50)
    return rows


def test_ate_and_rpe_of_a_shaken_trajectory():
    # Every second pose 1 cm above the truth, the others below: neither shift nor turn makes it less than 1 cm,
    # but for the share of a slope that a zigzag of even length has.
    result = hmcdyn.ate(trajectory(), trajectory(0.01))
    assert result.error.rmse == pytest.approx(0.01, rel=2e-3)
    assert len(result.errors) == 50
    assert result.estimated.shape == (50, 3)
    assert hmcdyn.rpe(trajectory(), trajectory()).translation.rmse == pytest.approx(0, abs=1e-9)
    with pytest.raises(ValueError, match="expected a TUM trajectory"):
        hmcdyn.ate(trajectory()[:, :7], trajectory())
    with pytest.raises(ValueError, match="nowhere.txt"):
        hmcdyn.ate("nowhere.txt", trajectory())


def test_files_and_arrays_give_one_error(tmp_path):
    numpy.savetxt(tmp_path / "truth.txt", trajectory())
    by_file = hmcdyn.ate(tmp_path / "truth.txt", trajectory(0.01))
    assert by_file.error.rmse == pytest.approx(hmcdyn.ate(trajectory(), trajectory(0.01)).error.rmse)
    numpy.testing.assert_allclose(hmcdyn.read_trajectory(tmp_path / "truth.txt"), trajectory(), atol=1e-12)
    with pytest.raises(TypeError):
        hmcdyn.read_trajectory(5)
