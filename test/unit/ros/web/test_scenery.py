"""Scans and maps as arrays."""

import math
from unittest.mock import MagicMock

import numpy as np
import pytest
import rospy
from frames_of_tests import transform
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

from aro_robocop_goto_as.geometry import Pose3D
from aro_robocop_goto_as.ros import markers
from aro_robocop_goto_as.ros.web.frames import Frames
from aro_robocop_goto_as.ros.web.part import Context
from aro_robocop_goto_as.ros.web.scenery import (
    FREE,
    MAX_MAP_CELLS,
    OCCUPIED,
    PATIENCE,
    UNKNOWN,
    SceneryPart,
    map_image,
    scan_points,
)
from aro_robocop_goto_as.web.scene import PageScene
from aro_robocop_goto_as.web.state import PageState, SharedState


def test_a_scan_becomes_the_points_of_its_valid_returns():
    ranges = [1.0, 0.0, math.nan, math.inf, 0.05, 9.0, 2.0]
    scan = LaserScan(angle_increment=math.pi / 2.0, range_min=0.1, range_max=5.0, ranges=ranges)
    assert scan_points(scan) == pytest.approx(np.array([(1.0, 0.0, 0.0), (-2.0, 0.0, 0.0)]))
    assert scan_points(LaserScan()).shape == (0, 3)


def test_a_map_has_its_own_colours_and_its_lowest_row_first():
    image = map_image([-1, 0, 100, 100, 100, 100], 3, 2)
    assert image.shape == (2, 3, 4)
    assert [tuple(pixel) for pixel in image[0]] == [UNKNOWN, FREE, OCCUPIED]


def test_a_map_that_is_too_large_is_thinned_out():
    assert map_image(np.zeros(MAX_MAP_CELLS + 1), MAX_MAP_CELLS + 1, 1).shape == (1, MAX_MAP_CELLS // 2 + 1, 4)


def test_the_cameras_turn_to_a_world_once():
    cameras, inbox = MagicMock(), MagicMock()
    state = SharedState(PageState(root="map"))
    scenery = SceneryPart(Context(MagicMock(), PageScene(MagicMock()), state, MagicMock(), Frames(), "map"), cameras)
    scenery.subscribe(inbox)
    scenery.subscribe_to_robot(inbox, "")
    receive = inbox.subscribe.call_args_list[0][0][2]
    for number in range(2):  # the second one is spawned while somebody looks
        shapes = [
            markers.marker(kind, Marker.CUBE, state.now.root, markers.GOAL_COLOR, number)
            for kind in ("world", "robots")
        ]
        receive(0.0, MarkerArray(shapes))
        scenery.show(state.now)
        assert cameras.show.call_count == 1
    assert len([*cameras.show.call_args[0][0]]) == 1, "without the robots, whose frames may be known before or after"


def test_a_scan_is_drawn_where_its_robot_was_at_its_stamp_as_soon_as_that_is_known():
    context = Context(MagicMock(), MagicMock(), SharedState(PageState(root="odom")), MagicMock(), Frames(), "odom")
    scenery = SceneryPart(context, MagicMock())

    def shown():
        scenery.show(context.state.now)
        calls = [call[0][1] for call in context.scene.show.call_args_list if call[0][0] == "scan"]
        return [(group["scan"][0].points[0], group["scan"][1]) for group in calls]

    scan = LaserScan(angle_increment=1.0, range_max=5.0, ranges=[1.0])
    scan.header.frame_id, scan.header.stamp = "base", rospy.Time(10.5)
    context.frames.update(transform("odom", "base", 1.0, stamp=10.0))
    scenery._on_scan(0.0, scan)
    assert shown() == []
    later = LaserScan(header=Header(frame_id="base", stamp=rospy.Time(10.6)))
    scenery._on_scan(0.0, later)  # which does not take its place
    context.frames.update(transform("odom", "base", 2.0, stamp=11.0))
    assert shown() == [((2.5, 0.0, 0.0), Pose3D())]


def test_a_scan_whose_transform_never_comes_is_replaced():
    scenery = SceneryPart(MagicMock(), MagicMock())
    for stamp in (10.0, 10.0 + 2.0 * PATIENCE, 1.0):  # the last one of a simulator that was started again
        scan = LaserScan(header=Header(stamp=rospy.Time(stamp)))
        scenery._on_scan(0.0, scan)
        assert scenery._scan is scan
