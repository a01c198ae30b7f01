"""Where the obstacles are that RViz shows."""

import math

import pytest
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from visualization_msgs.msg import Marker

from aro_robocop_goto_as.geometry import quaternion_from_rpy
from aro_robocop_goto_as.ros.cli.rviz import corners_of


def test_corners_are_those_of_the_obstacle_where_it_stands():
    turned = Pose(Point(1.0, 2.0, 0.25), Quaternion(*quaternion_from_rpy(0.0, 0.0, math.pi / 2.0)))
    wall = Marker(ns="world", type=Marker.CUBE, pose=turned, scale=Vector3(4.0, 0.2, 0.5))
    corners = corners_of(wall)
    assert corners.min(axis=0) == pytest.approx([0.9, 0.0, 0.0])
    assert corners.max(axis=0) == pytest.approx([1.1, 4.0, 0.5])
    mesh = Marker(ns="world", type=Marker.TRIANGLE_LIST, pose=turned, points=[Point(1.0, 0.0, 0.0)])
    assert corners_of(mesh).tolist() == [pytest.approx([1.0, 3.0, 0.25])]
    assert len(corners_of(Marker(ns="robots", type=Marker.CYLINDER))) == 0
