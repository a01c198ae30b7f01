"""Scans and maps as arrays."""

import math
from unittest.mock import MagicMock

import numpy as np
import pytest
from sensor_msgs.msg import LaserScan
from visualization_msgs.msg import Marker, MarkerArray

from aro_robocop_goto_as.geometry import Pose3D
from aro_robocop_goto_as.ros import markers
from aro_robocop_goto_as.ros.web.part import Context
from aro_robocop_goto_as.ros.web.scenery import (
    FREE,
    LABEL_HEIGHT,
    MAX_MAP_CELLS,
    OCCUPIED,
    UNKNOWN,
    SceneryPart,
    map_image,
    part_labels,
    scan_points,
)
from aro_robocop_goto_as.web.frames import FrameTree
from aro_robocop_goto_as.web.scene import BOX, TEXT, PageScene, Shape
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
    scenery = SceneryPart(Context(MagicMock(), PageScene(MagicMock()), state, MagicMock(), FrameTree(), "map"), cameras)
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


def test_texts_that_would_cover_each_other_are_raised_above_one_another():
    places = {"first": (0.0, 0.0, 0.6), "beside": (0.5, 0.1, 0.6), "behind": (0.0, 2.0, 0.6), "state": (0.0, 0.0, 0.9)}
    group = {name: (Shape(TEXT, text=name), Pose3D(position)) for name, position in places.items()}
    group["wall"] = (Shape(BOX), Pose3D((0.0, 0.0, 0.6)))
    server = {"state": group.pop("state")}
    part_labels(group, server)
    places = {name: pose.position for name, (_, pose) in (*group.items(), *server.items())}
    assert places.pop("wall") == (0.0, 0.0, 0.6)
    assert places["first"] == (0.0, 0.0, 0.6) and places["behind"] == (0.0, 2.0, 0.6)
    ups = sorted(y + z for _, y, z in places.values())
    assert min(above - below for below, above in zip(ups, ups[1:])) >= LABEL_HEIGHT - 1e-9
