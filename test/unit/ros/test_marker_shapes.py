"""Markers of RViz as shapes: additions, deletions, frames, and what can't be shown."""

import math

import pytest
from geometry_msgs.msg import Point
from visualization_msgs.msg import Marker, MarkerArray

from aro_robocop_goto_as.geometry import Pose2D, Pose3D, lifted
from aro_robocop_goto_as.ros.marker_shapes import MarkerStore, to_shape
from aro_robocop_goto_as.web.scene import BOX


def marker(number, action=Marker.ADD, kind=Marker.CUBE, namespace="walls", frame="map", **fields):
    made = Marker(ns=namespace, id=number, action=action, type=kind, **fields)
    made.header.frame_id = frame
    made.pose.orientation.w = made.scale.x = made.scale.y = made.scale.z = made.color.a = 1.0
    return made


@pytest.fixture
def store():
    store = MarkerStore()
    store.apply(MarkerArray([marker(1), marker(2), marker(3, namespace="robots"), marker(4, frame="/odom")]))
    return store


def keys(store, **options):
    return {number for _, number in store.placed(lambda frame: Pose3D(), **options)}


def test_markers_stay_until_they_are_deleted(store):
    assert keys(store) == {1, 2, 3, 4} and keys(store, skip=("robots",)) == {1, 2, 4}
    store.apply(MarkerArray([marker(2, Marker.DELETE)]))
    assert keys(store) == {1, 3, 4}
    store.apply(MarkerArray([marker(0, Marker.DELETEALL), marker(5)]))
    assert keys(store) == {5}


def test_a_marker_is_placed_in_its_frame_and_left_out_while_that_is_unknown(store):
    placed = store.placed({"odom": lifted(Pose2D(1.0, 2.0, 0.0))}.get)
    assert {key: (shape.kind, pose.position) for key, (shape, pose) in placed.items()} == {
        ("walls", 4): (BOX, (1.0, 2.0, 0.0))
    }


def test_a_marker_that_becomes_impossible_is_no_longer_shown(store):
    broken = marker(1)
    broken.pose.position.x = math.nan
    store.apply(MarkerArray([broken, marker(2, kind=Marker.ARROW)]))
    assert keys(store) == {3, 4}


@pytest.mark.parametrize(
    "kind, corners", [(Marker.TRIANGLE_LIST, 4), (Marker.TRIANGLE_LIST, 0), (Marker.LINE_STRIP, 1)]
)
def test_incomplete_triangles_and_lines_are_not_shown(kind, corners):
    assert to_shape(marker(1, kind=kind, points=[Point()] * corners)) is None
