# SPDX-License-Identifier: BSD-3-Clause
"""The pure functions: what goes in, what comes out, what is refused."""
import gc
import resource

import hmcdyn
import numpy
import pytest


def test_a_person_who_moves_is_dynamic_and_the_wall_is_not(box_of_points):
    u, v, depth, distance, person, boxes = box_of_points
    result = hmcdyn.filter_key_points(u, v, depth, distance, boxes)
    numpy.testing.assert_array_equal(result.label == hmcdyn.PointLabel.DYNAMIC, person)
    assert (result.weight[person] == 0).all()
    assert result.frame.dynamic == person.sum()
    assert result.boxes[0].verdict.is_dynamic


def test_steps_by_hand_give_what_the_stage_gives(box_of_points):
    u, v, depth, distance, _, boxes = box_of_points
    stage = hmcdyn.filter_key_points(u, v, depth, distance, boxes)
    membership = hmcdyn.assign_to_boxes(u, v, depth, boxes)
    inside = membership.indices
    dynamism = hmcdyn.test_boxes(distance, boxes, membership)
    clustering = hmcdyn.cluster_box(depth[inside], distance[inside])
    filtered = hmcdyn.filter_clusters(depth[inside], distance[inside], dynamism.threshold[inside], clustering,
                                      stage.frame.mean_distance)
    numpy.testing.assert_array_equal(filtered.is_dynamic, stage.label[inside] == hmcdyn.PointLabel.DYNAMIC)


def test_epipolar_distance_is_the_closed_form():
    # Pure translation along x: F = [t]x, lines v2 = v1, so the distance is |v2 - v1|.
    fundamental = [[0, 0, 0], [0, 0, -1], [0, 1, 0]]
    distance = hmcdyn.epipolar_distances(fundamental, [10, 20, numpy.nan], [5, 6, 7], [30, 9, 1], [5, 9, 1])
    assert distance.dtype == numpy.float32
    numpy.testing.assert_allclose(distance, [0, 3, numpy.nan], atol=1e-6)


def test_options_are_keywords_structs_and_dicts(box_of_points):
    u, v, depth, distance, _, boxes = box_of_points
    options = hmcdyn.FilterStageOptions(rule="none", clustering={"epsilon": 0.2})
    assert options.rule == hmcdyn.FilterRule.NONE
    assert options.clustering.epsilon == pytest.approx(0.2)
    by_struct = hmcdyn.filter_key_points(u, v, depth, distance, boxes, options=options)
    by_keyword = hmcdyn.filter_key_points(u, v, depth, distance, boxes, rule=hmcdyn.FilterRule.NONE)
    assert by_struct.frame.dynamic == by_keyword.frame.dynamic == 0
    with pytest.raises(TypeError, match="ClusteringOptions has no field 'eps'; it has depth_scale"):
        hmcdyn.ClusteringOptions(eps=1)
    with pytest.raises(ValueError, match="FilterRule is magic; expected one of NONE, BOX"):
        hmcdyn.FilterStageOptions(rule="magic")


def test_errors_are_those_of_the_library():
    with pytest.raises(ValueError, match="clusterBox: 2 depths, but 3 distances; expected equal sizes"):
        hmcdyn.cluster_box([1, 2], [1, 2, 3])
    with pytest.raises(ValueError, match=r"ClusteringOptions::epsilon is -1.*expected a value in"):
        hmcdyn.cluster_box([1.0], [1.0], epsilon=-1)


@pytest.mark.parametrize("depth, message", [
    ([[1, 2]], r"depth is an array of int64, shape \(1, 2\); expected N real numbers, shape \(N,\)"),
    (["near", "far"], "depth is an array of <U4"),
    ([1j, 2j], "depth is an array of complex128"),
    (1.0, r"depth is an array of float64, shape \(\)"),
])
def test_arrays_of_another_type_or_shape_are_refused(depth, message):
    with pytest.raises(ValueError, match=message):
        hmcdyn.cluster_box(depth, [1, 2])


def test_any_order_and_read_only_arrays_give_the_same(box_of_points):
    u, v, depth, distance, _, boxes = box_of_points
    expected = hmcdyn.filter_key_points(u, v, depth, distance, boxes).label.tobytes()
    table = numpy.asfortranarray(numpy.stack([u, v, depth, distance]).astype(numpy.float64))  # strided rows
    assert hmcdyn.filter_key_points(*table, boxes).label.tobytes() == expected
    backwards = [values[::-1] for values in (u, v, depth, distance)]
    assert hmcdyn.filter_key_points(*backwards, boxes).label[::-1].tobytes() == expected
    for values in (u, v, depth, distance):
        values.setflags(write=False)
    assert hmcdyn.filter_key_points(u, v, depth, distance, boxes).label.tobytes() == expected


def test_results_outlive_what_they_came_from(box_of_points):
    u, v, depth, distance, _, boxes = box_of_points
    result = hmcdyn.filter_key_points(u, v, depth, distance, boxes)
    label, before = result.label, result.label.tobytes()
    assert label.base is not None  # a view, not a copy
    decision = result.boxes[0]
    del result, u, v, depth, distance
    gc.collect()
    assert label.tobytes() == before
    assert decision.verdict.is_dynamic


def test_boxes_come_as_objects_rows_and_arrays(box_of_points):
    u, v, depth, distance, _, boxes = box_of_points
    expected = hmcdyn.filter_key_points(u, v, depth, distance, boxes).label.tobytes()
    for same in ([hmcdyn.DetectionBox(200, 0, 400, 480)], numpy.array(boxes), [(200, 0, 400, 480, 0.9, 0)],
                 numpy.array([[200, 0, 400, 480, 0.5, 0]], numpy.float32)):
        assert hmcdyn.filter_key_points(u, v, depth, distance, same).label.tobytes() == expected
    assert hmcdyn.filter_key_points(u, v, depth, distance, []).frame.boxes == 0
    with pytest.raises(ValueError, match=r"boxes is an array of float32, shape \(3,\)"):
        hmcdyn.filter_key_points(u, v, depth, distance, [[1, 2, 3]])
    with pytest.raises(ValueError, match="boxes: a class is nan"):
        hmcdyn.filter_key_points(u, v, depth, distance, [[1, 2, 3, 4, 0.5, numpy.nan]])


def test_regions_take_the_place_of_boxes():
    labels = numpy.zeros((480, 640), numpy.uint8)
    labels[100:300, 200:260] = 7
    regions = hmcdyn.regions_in(labels)
    assert [region.label for region in regions] == [7]
    box = hmcdyn.bounding_boxes(labels, regions)[0]
    assert (box.x_min, box.y_min, box.x_max, box.y_max) == (200, 100, 259, 299)
    region = hmcdyn.regions_of_points([210, 10], [150, 10], [1, 1], labels, regions)
    assert region.tolist() == [0, -1]
    assert hmcdyn.assign_to_regions(region, 1).indices.tolist() == [0]
    with pytest.raises(ValueError, match=r"region\[0\] is 5; expected -1 \(none\) or a number below 1"):
        hmcdyn.assign_to_regions([5], 1)


def test_every_public_name_says_what_it_is():
    for name in hmcdyn.__all__:
        value = getattr(hmcdyn, name)
        if callable(value):
            assert value.__doc__, name
    assert "(1/m)" in hmcdyn.ClusteringOptions.depth_scale.__doc__


def test_ten_thousand_calls_leak_nothing(box_of_points):
    u, v, depth, distance, _, boxes = box_of_points

    def calls(times):
        for _ in range(times):
            hmcdyn.filter_key_points(u, v, depth, distance, boxes, clustering={"epsilon": 0.1}).label.sum()
            with pytest.raises(ValueError):
                hmcdyn.cluster_box(depth, distance[:-1])
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # KiB

    before = calls(1000)
    # 120 points take some 10 KB a result: 5000 of them that stayed would be 50 MB.
    assert calls(5000) - before < 5000
