"""What the page shows of topics: one in full, of the others rate and newest message if they are listened to."""

from unittest.mock import MagicMock

import pytest
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.ros.web import topics
from aro_robocop_goto_as.web.state import PageState

PUBLISHED = (
    ("/camera/image", "sensor_msgs/Image"),
    ("/cmd_vel", "geometry_msgs/Twist"),
    ("/odom", "nav_msgs/Odometry"),
)
STATE = PageState(topics=PUBLISHED)
INBOX = MagicMock()


@pytest.fixture
def part(monkeypatch):
    monkeypatch.setattr(topics.rospy, "Subscriber", MagicMock())
    part = topics.Topics(MagicMock())
    part._choice.value, part._all.value = "/cmd_vel", False
    return part


def test_only_the_topic_that_is_chosen_is_subscribed_to_and_only_while_there_is_a_browser(part):
    part.ask_master(STATE, INBOX)
    assert list(part._listeners) == ["/cmd_vel"]
    part.context.server.get_clients.return_value = {}
    part.ask_master(STATE, INBOX)
    assert not part._listeners
    assert topics.rospy.Subscriber.return_value.unregister.call_count == 1


def test_on_request_all_topics_are_subscribed_to_but_cameras(part):
    part._all.value = True
    part.ask_master(STATE, INBOX)
    assert set(part._listeners) == {"/cmd_vel", "/odom"}
    part._choice.value = "/camera/image"
    part.ask_master(STATE, INBOX)
    assert "/camera/image" in part._listeners


def test_a_rate_is_counted_in_simulated_seconds(part, monkeypatch):
    part.ask_master(STATE, INBOX)
    listener, now = part._listeners["/cmd_vel"], [100.0]
    monkeypatch.setattr(topics.time, "monotonic", lambda: now[0])
    for _ in range(11):
        listener._on_message(Twist())
        now[0] += 0.2
    assert listener.rate(STATE.factor) == "5.0 Hz"
    assert listener.rate(0.5) == "10.0 Hz"
    now[0] += topics.SPAN
    assert listener.rate(STATE.factor) == ""


def test_a_message_in_full_is_what_rostopic_echo_prints_with_long_lines_cut():
    scan = LaserScan(ranges=[1.0] * 360)
    lines = topics.full(scan).splitlines()
    assert "angle_min: 0.0" in lines and len(max(lines, key=len)) == topics.WIDTH
    assert topics.brief(Twist()).startswith("linear: x: 0.0 y: 0.0 z: 0.0 angular:")
    assert "stamp" not in topics.brief(Odometry())[:20]


def test_a_message_of_an_unknown_type_is_not_read():
    assert topics.class_of("geometry_msgs/Twist") is Twist
    assert topics.class_of("nobody_msgs/Nothing") is rospy.AnyMsg
    assert topics.full(rospy.AnyMsg()) == "a message of a type that is not built here"
