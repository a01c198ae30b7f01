"""Where the obstacles are that RViz shows."""

import math

import pytest
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from visualization_msgs.msg import Marker, MarkerArray

from aro_robocop_goto_as.geometry import quaternion_from_rpy
from aro_robocop_goto_as.ros.cli.rviz import corners_of


def test_corners_are_those_of_the_obstacle_where_it_stands():
    turned = Pose(Point(1.0, 2.0, 0.25), Quaternion(*quaternion_from_rpy(0.0, 0.0, math.pi / 2.0)))
    wall = Marker(ns="world", id=1, type=Marker.CUBE, pose=turned, scale=Vector3(4.0, 0.2, 0.5))
    mesh = Marker(ns="world", id=2, type=Marker.TRIANGLE_LIST, pose=turned, points=[Point(1.0, 0.0, 0.0)] * 3)
    robot = Marker(ns="robots", type=Marker.CYLINDER, scale=Vector3(1.0, 1.0, 1.0))
    corners = corners_of(MarkerArray([wall, mesh, robot]))
    assert corners[:8].min(axis=0) == pytest.approx([0.9, 0.0, 0.0])
    assert corners[:8].max(axis=0) == pytest.approx([1.1, 4.0, 0.5])
    assert corners[8:].tolist() == [pytest.approx([1.0, 3.0, 0.25])] * 3
