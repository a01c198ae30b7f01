"""The server's view of its inputs: it changes in one piece, and what is missing is said in the right words."""

import math
import re
import threading

import pytest
import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.errors import RobocopError
from aro_robocop_goto_as.goto import Outcome
from aro_robocop_goto_as.goto_params import GotoParams
from aro_robocop_goto_as.ros.server import inputs
from aro_robocop_goto_as.ros.server.inputs import FIRST_MESSAGE_TIMEOUT, Inputs


class Server:
    """Inputs with clocks and parameters that a test sets."""

    def __init__(self, monkeypatch):
        self.ros_time, self.wall, self.params = 1.5, 100.0, GotoParams()
        monkeypatch.setattr(rospy, "get_rostime", lambda: rospy.Time.from_sec(self.ros_time))
        monkeypatch.setattr(inputs.time, "monotonic", lambda: self.wall)
        self.inputs = Inputs(self)

    def receive_odom(self, stamp):
        """Odometry of a time [s]."""
        odom = Odometry()
        odom.header.stamp, odom.pose.pose.orientation.w = rospy.Time(stamp), 1.0
        self.inputs.on_odom(odom)

    def receive_scan(self, stamp):
        """A scan of a time [s]."""
        scan = LaserScan(angle_increment=0.1, range_max=5.0, ranges=[2.0])
        scan.header.stamp = rospy.Time(stamp)
        self.inputs.on_scan(scan)

    def receive(self, ahead, orientation_w=1.0):
        """Odometry, and a scan with one beam [m]."""
        odom = Odometry()
        odom.pose.pose.orientation.w = orientation_w
        self.inputs.on_odom(odom)
        self.inputs.on_scan(LaserScan(angle_increment=0.1, range_max=5.0, ranges=[ahead]))


@pytest.fixture
def server(monkeypatch):
    return Server(monkeypatch)


def test_topic_without_any_message_since_the_goal_was_accepted_may_be_connecting(server):
    assert server.inputs.missing(now=50.0, started=0.0, accepted=100.0) is None
    server.wall += FIRST_MESSAGE_TIMEOUT
    missing = server.inputs.missing(now=50.0, started=0.0, accepted=100.0)
    assert missing == (Outcome.NO_ODOM, "no message on /odom so far (limit 1 s)")


@pytest.mark.parametrize("w", [0.0, 1.2, math.nan])
def test_odometry_whose_orientation_is_no_rotation_is_refused(server, w):
    server.receive(2.0, w)
    with pytest.raises(
        RobocopError, match="/odom holds an impossible pose: expected a quaternion of length 1, got x 0"
    ):
        server.inputs.read()


@pytest.mark.parametrize(
    "first, last, increment", [(-3.14, 3.14, -0.0175), (3.14, -3.14, 0.0175), (0.0, 0.0, 0.0), (0.0, 359.0, 1.0)]
)
def test_scan_whose_angles_contradict_themselves_ends_the_goal(server, first, last, increment):
    server.receive(2.0)
    server.inputs.on_scan(
        LaserScan(angle_min=first, angle_max=last, angle_increment=increment, range_max=5.0, ranges=[2.0] * 360)
    )
    expected = f"/scan has no beam within 30 degrees of straight ahead (360 beams, angles {first:g} to {last:g} rad"
    with pytest.raises(RobocopError, match=re.escape(f"{expected}, increment {increment:g} rad)")):
        server.inputs.read()


@pytest.fixture
def ticking(server, monkeypatch):
    """A server that knows that odometry and scan come every 0.5 s, the last ones at 1.5 s."""
    monkeypatch.setattr(inputs, "TICK_TIMEOUT", 0.05)
    monkeypatch.setattr(rospy, "logwarn_throttle", lambda _, text: server.warnings.append(text))
    server.warnings = []
    for stamp in (1.0, 1.5):
        server.receive_odom(stamp)
        server.receive_scan(stamp)
    return server


def test_messages_of_a_tick_are_waited_for(ticking, monkeypatch):
    monkeypatch.setattr(inputs, "TICK_TIMEOUT", 60.0)
    ticking.receive_odom(2.0)
    late = threading.Timer(0.05, ticking.receive_scan, (2.0,))
    late.start()
    ticking.inputs.wait_for_tick(2 * 10**9)
    assert ticking.inputs.scan.stamp_ns == 2 * 10**9
    assert ticking.warnings == []


def test_message_that_does_not_come_is_told(ticking):
    ticking.inputs.wait_for_tick(2 * 10**9)
    assert ticking.warnings == ["no odometry or scan of 2.000 s within 0.05 s"]


def test_message_that_is_not_due_is_not_waited_for(ticking):
    ticking.inputs.wait_for_tick(19 * 10**8)
    assert ticking.warnings == []
