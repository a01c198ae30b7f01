"""Transforms between frames, whatever their age."""

import math

import pytest

from aro_robocop_goto_as.geometry import Pose2D, Pose3D, lifted
from aro_robocop_goto_as.web.frames import FrameTree


def test_frames_are_looked_up_along_parents_and_siblings() -> None:
    tree = FrameTree()
    tree.update("map", "odom", lifted(Pose2D(1.0, 0.0, math.pi / 2.0)))
    tree.update("odom", "base", lifted(Pose2D(2.0, 0.0, 0.0)))
    tree.update("map", "world", lifted(Pose2D(0.0, 5.0, 0.0)))
    found = tree.lookup("map", "base")
    assert found is not None
    assert found.position == pytest.approx((1.0, 2.0, 0.0))
    sibling = tree.lookup("world", "base")
    assert sibling is not None and sibling.position == pytest.approx((1.0, -3.0, 0.0))
    back = tree.lookup("base", "map")
    assert back is not None and back.position == pytest.approx((-2.0, 1.0, 0.0))


def test_frames_that_are_not_connected_give_no_pose() -> None:
    tree = FrameTree()
    tree.update("map", "odom", Pose3D())
    tree.update("other", "base", Pose3D())
    assert tree.lookup("map", "base") is None
    assert tree.lookup("map", "nowhere") is None
    assert tree.lookup("nowhere", "nowhere") == Pose3D()
    assert tree.names() == ["map", "other", "base", "odom"]


def test_an_older_transform_replaces_a_newer_one_as_after_a_restart_of_the_simulator() -> None:
    tree = FrameTree()
    tree.update("map", "odom", lifted(Pose2D(9.0, 0.0)))
    tree.update("map", "odom", lifted(Pose2D(1.0, 0.0)))
    found = tree.lookup("map", "odom")
    assert found is not None and found.position[0] == 1.0
