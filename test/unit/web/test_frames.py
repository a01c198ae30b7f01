"""Transforms between frames: the newest, or those of a stamp."""

import math
from typing import Optional

import pytest

from aro_robocop_goto_as.geometry import Pose2D, Pose3D, lifted
from aro_robocop_goto_as.web.frames import KEPT, FrameTree


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


def x_at(tree: FrameTree, stamp: Optional[float]) -> float:
    """Where base is in map at a stamp [s], on a way along x."""
    found = tree.lookup("map", "base", stamp)
    assert found is not None
    return found.position[0]


def test_a_frame_is_looked_up_at_the_stamp_nearest_to_the_one_that_is_asked_for_among_those_of_some_seconds() -> None:
    tree = FrameTree()
    tree.update("map", "odom", lifted(Pose2D(10.0, 0.0)))
    for stamp in range(20):
        tree.update("odom", "base", lifted(Pose2D(float(stamp), 0.0)), float(stamp))
    assert [x_at(tree, stamp) for stamp in (None, 16.0, 16.4, 16.6, 99.0)] == [29.0, 26.0, 26.0, 27.0, 29.0]
    assert x_at(tree, 0.0) == 10.0 + 19.0 - KEPT


def test_an_older_transform_replaces_newer_ones_as_after_a_restart_of_the_simulator() -> None:
    tree = FrameTree()
    for stamp, x in ((8.0, 7.0), (9.0, 9.0), (0.5, 1.0)):
        tree.update("map", "base", lifted(Pose2D(x, 0.0)), stamp)
    assert x_at(tree, None) == x_at(tree, 9.0) == 1.0
