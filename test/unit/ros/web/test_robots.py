"""Which robots the page knows, and where it takes their places from."""

from unittest.mock import MagicMock

from frames_of_tests import transform
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.ros.graph import Topic
from aro_robocop_goto_as.ros.web.frames import Frames
from aro_robocop_goto_as.ros.web.part import Context
from aro_robocop_goto_as.ros.web.robots import RobotsPart, robots_of
from aro_robocop_goto_as.web.state import PageState, SharedState


def odometry(x):
    message = Odometry(child_frame_id="base_footprint")
    message.header.frame_id, message.pose.pose.position.x, message.pose.pose.orientation.w = "odom", x, 1.0
    return message


def test_odometry_is_the_transform_where_nobody_publishes_that_one():
    frames = Frames()
    robots = RobotsPart(Context(MagicMock(), MagicMock(), SharedState(PageState()), MagicMock(), frames, "map"))
    robots._on_odometry(0.0, odometry(1.0))
    assert frames.lookup("odom", "base_footprint").position == (1.0, 0.0, 0.0)
    robots._on_tf(0.0, TFMessage([transform("odom", "base_footprint", 2.0, stamp=1.0)]))
    robots._on_odometry(0.0, odometry(1.0))
    assert frames.lookup("odom", "base_footprint").position == (2.0, 0.0, 0.0)


def test_robots_are_the_namespaces_of_published_odometry():
    odometry = "nav_msgs/Odometry"
    topics = (("/odom", odometry), ("/red/odom", odometry), ("/blue/odom", "std_msgs/String"), ("/red/truth", odometry))
    assert robots_of(Topic(name, kind, ("/sim",)) for name, kind in topics) == ("", "red")
