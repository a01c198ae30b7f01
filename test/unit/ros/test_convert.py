"""Poses from other nodes: their quaternions are normalised or refused."""

import math

import pytest
from geometry_msgs.msg import Point, Pose, Quaternion

from aro_robocop_goto_as.errors import FrameError
from aro_robocop_goto_as.geometry import MAX_COORDINATE
from aro_robocop_goto_as.ros import convert

QUARTER_TURN = math.sqrt(0.5)


def turned(length):
    """A quarter turn to the left, by a quaternion of this length."""
    return Pose(Point(1.0, 2.0, 0.0), Quaternion(0.0, 0.0, length * QUARTER_TURN, length * QUARTER_TURN))


@pytest.mark.parametrize("length", [1.0, 0.99, 1.004])
def test_quaternion_of_nearly_length_1_is_normalised(length):
    assert convert.from_pose_msg(turned(length)).yaw == pytest.approx(math.pi / 2.0)
    assert convert.from_pose_msg_3d(turned(length)).orientation == pytest.approx((0.0, 0.0, QUARTER_TURN, QUARTER_TURN))


@pytest.mark.parametrize("length", [0.0, 0.5, 1.2, math.nan, math.inf, 1e300])
def test_quaternion_of_another_length_is_refused(length):
    with pytest.raises(FrameError, match="expected a quaternion of length 1, got x 0.0 y 0.0 z "):
        convert.from_pose_msg(turned(length))


def test_quaternion_that_the_sender_of_a_request_left_out_means_level():
    assert convert.from_pose_msg_3d(turned(0.0)).orientation == (0.0, 0.0, 0.0, 1.0)
    assert convert.from_pose_msg(turned(0.0), unset_is_level=True).yaw == 0.0


@pytest.mark.parametrize("x", [math.nan, math.inf, 2.0 * MAX_COORDINATE])
def test_position_that_is_no_place_is_refused(x):
    pose = turned(1.0)
    pose.position.x = x
    for convert_pose in (convert.from_pose_msg, convert.from_pose_msg_3d):
        with pytest.raises(FrameError, match="expected finite numbers within"):
            convert_pose(pose)
