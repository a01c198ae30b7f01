"""Which robots the page knows, and where it takes their places from."""

from unittest.mock import MagicMock

import pytest
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.geometry import Pose3D
from aro_robocop_goto_as.ros.graph import Topic
from aro_robocop_goto_as.ros.web.part import Context
from aro_robocop_goto_as.ros.web.robots import RobotsPart, robots_of
from aro_robocop_goto_as.web.frames import FrameTree
from aro_robocop_goto_as.web.state import PageState, SharedState


def odometry(x):
    message = Odometry(child_frame_id="base_footprint")
    message.header.frame_id, message.pose.pose.position.x, message.pose.pose.orientation.w = "odom", x, 1.0
    return message


def transform(x):
    stamped = TransformStamped(child_frame_id="base_footprint")
    stamped.header.frame_id, stamped.transform.translation.x, stamped.transform.rotation.w = "odom", x, 1.0
    return TFMessage([stamped])


def test_odometry_is_the_transform_where_nobody_publishes_that_one():
    frames = FrameTree()
    robots = RobotsPart(Context(MagicMock(), MagicMock(), SharedState(PageState()), MagicMock(), frames, "map"))
    robots._on_odometry(0.0, odometry(1.0))
    assert frames.lookup("odom", "base_footprint").position == (1.0, 0.0, 0.0)
    robots._on_tf(0.0, transform(2.0))
    robots._on_odometry(0.0, odometry(1.0))
    assert frames.lookup("odom", "base_footprint").position == (2.0, 0.0, 0.0)


@pytest.mark.parametrize("slipped, x", [((), 3.0), (("red",), 3.0), (("",), 1.0)])
def test_a_robot_whose_wheels_have_slipped_is_where_it_truly_is_and_after_a_reset_where_tf_says(slipped, x):
    frames, state = FrameTree(), SharedState(PageState(slipped=slipped))
    frames.update("world", "odom", Pose3D())
    robots = RobotsPart(Context(MagicMock(), MagicMock(), state, MagicMock(), frames, "map"))
    truth = odometry(1.0)
    truth.header.frame_id = "world"

    def shown():
        for receive, message in ((robots._on_truth, truth), (robots._on_odometry, odometry(3.0))):
            receive(0.0, message)
        robots._on_tf(0.0, transform(3.0))
        return frames.lookup("world", "base_footprint").position[0]

    assert shown() == x
    state.change(slipped=())
    assert shown() == 3.0


def test_robots_are_the_namespaces_of_published_odometry():
    odometry = "nav_msgs/Odometry"
    topics = (("/odom", odometry), ("/red/odom", odometry), ("/blue/odom", "std_msgs/String"), ("/red/truth", odometry))
    assert robots_of(Topic(name, kind, ("/sim",)) for name, kind in topics) == ("", "red")
