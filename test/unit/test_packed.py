"""Odometry in packed form is, byte for byte, what ROS makes of the message."""

from io import BytesIO

import pytest
from genpy import Time
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.nodes import convert
from aro_robocop_goto_as.nodes.packed import PackedOdometry

COVARIANCE = [float(i) for i in range(36)]


@pytest.mark.parametrize("frame, child", [("odom", "base_footprint"), ("robot_1/odom", "robot_1/base"), ("ö", "é")])
def test_its_bytes_are_those_of_an_ordinary_message(frame: str, child: str) -> None:
    packed = PackedOdometry(frame, child, COVARIANCE)
    for seq in (1, 2, 3):
        pose, twist, stamp = Pose2D(1.5 * seq, -2.5, 0.7), Twist2D(0.2, -seq), Time(seq, 999999999)
        ordinary = convert.to_odometry(pose, twist, stamp, frame, child, COVARIANCE)
        ordinary.header.seq = seq
        expected, found = BytesIO(), BytesIO()
        ordinary.serialize(expected)
        packed.update(pose, twist, stamp).serialize(found)
        assert found.getvalue() == expected.getvalue()
    assert isinstance(packed, Odometry)
