"""Which transform a goal's position is computed with."""

from unittest.mock import MagicMock

import pytest
import rospy
import tf2_ros
from geometry_msgs.msg import PoseStamped, TransformStamped
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.errors import FrameError
from aro_robocop_goto_as.ros.client import goal_frame

TIMEOUT = 0.02  # [s, wall]
LAST_STAMP = 2**32 - 1


@pytest.fixture(name="robot")
def _robot(monkeypatch):
    """TF and odometry, which a test sets."""
    return Robot(monkeypatch)


class BufferWithoutNode(tf2_ros.Buffer):
    """One that offers no service."""

    def __init__(self):
        super().__init__(debug=False)


class Robot:
    def __init__(self, monkeypatch):
        self.odom, self.warnings = None, []
        monkeypatch.setattr(tf2_ros, "Buffer", BufferWithoutNode)
        monkeypatch.setattr(tf2_ros, "TransformListener", MagicMock())
        monkeypatch.setattr(rospy, "logwarn", self.warnings.append)
        self.transformer = goal_frame.GoalTransformer("odom", "map", TIMEOUT, lambda: self.odom)

    def send_transform(self, x, frame="base_footprint", stamp=1):
        sent = TransformStamped()
        sent.header.frame_id, sent.child_frame_id, sent.transform.rotation.w = "odom", frame, 1.0
        sent.header.stamp, sent.transform.translation.x = rospy.Time(stamp), x
        self.transformer.buffer.set_transform(sent, "a publisher")

    def send_odometry(self, x):
        self.odom = Odometry(child_frame_id="base_footprint")
        self.odom.header.frame_id, self.odom.pose.pose.orientation.w = "odom", 1.0
        self.odom.pose.pose.position.x = x

    def resolve(self, stamp=1):
        pose = PoseStamped()
        pose.header.frame_id, pose.header.stamp = "base_footprint", rospy.Time(stamp)
        return self.transformer.resolve(pose).x


def test_transform_at_the_goals_time_is_used_without_a_warning(robot):
    for stamp in (1, 2, 3):
        robot.send_transform(float(stamp), stamp=stamp)
    robot.send_odometry(9.0)
    assert (robot.resolve(2), robot.warnings) == (2.0, [])


@pytest.mark.parametrize("stamp", [5, LAST_STAMP])
def test_latest_transform_is_used_with_a_warning_where_there_is_none_of_the_goals_time(robot, stamp):
    robot.send_transform(1.0)
    assert robot.resolve(stamp) == 1.0
    assert "using the latest one" in robot.warnings[0]


def test_odometry_is_used_at_once_where_tf_does_not_connect_the_frames(robot, monkeypatch):
    monkeypatch.setattr(robot.transformer, "timeout", 600.0)
    robot.send_odometry(3.0)
    assert (robot.resolve(5), robot.warnings) == (3.0, [])


def test_frames_that_nothing_connects_are_refused(robot):
    with pytest.raises(FrameError, match="no transform from 'base_footprint' to 'odom' within 0.02 s"):
        robot.resolve()
