"""The server's view of its inputs: it changes in one piece, and what is missing is said in the right words."""

import math
import re
import threading

import pytest
import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.errors import RobocopError
from aro_robocop_goto_as.goto.params import GotoParams
from aro_robocop_goto_as.goto.rule import Outcome
from aro_robocop_goto_as.ros.server import inputs
from aro_robocop_goto_as.ros.server.inputs import FIRST_MESSAGE_TIMEOUT, Inputs


class Server:
    """Inputs with clocks and parameters that a test sets."""

    def __init__(self, monkeypatch):
        self.ros_time, self.wall, self.params = 1.5, 100.0, GotoParams()
        monkeypatch.setattr(rospy, "get_rostime", lambda: rospy.Time.from_sec(self.ros_time))
        monkeypatch.setattr(inputs.time, "monotonic", lambda: self.wall)
        self.inputs = Inputs(self)

    def receive_odom(self, stamp, x=0.0, w=1.0, unit=10**9):
        """Odometry of a time [`unit` ns]; its position x [m], and its orientation's w."""
        odom = Odometry()
        odom.header.stamp = rospy.Time(nsecs=round(stamp * unit))
        odom.pose.pose.position.x, odom.pose.pose.orientation.w = x, w
        self.inputs.on_odom(odom)

    def receive_scan(self, stamp, ahead=2.0):
        """A scan of a time [s] with one beam [m]."""
        scan = LaserScan(angle_increment=0.1, range_max=5.0, ranges=[ahead])
        scan.header.stamp = rospy.Time(stamp)
        self.inputs.on_scan(scan)


@pytest.fixture
def server(monkeypatch):
    return Server(monkeypatch)


def test_topic_without_any_message_since_the_goal_was_accepted_may_be_connecting(server):
    assert server.inputs.missing(now=50.0, started=0.0, accepted=100.0) is None
    server.wall += FIRST_MESSAGE_TIMEOUT
    missing = server.inputs.missing(now=50.0, started=0.0, accepted=100.0)
    assert missing == (Outcome.NO_ODOM, "no message on /odom so far (limit 1 s)")


@pytest.mark.parametrize(
    "odom, ahead, outcome, words",
    [
        (False, 2.0, Outcome.NO_ODOM, "message on /odom"),
        (True, None, Outcome.NO_SCAN, "message on /scan"),
        (True, math.nan, Outcome.NO_SCAN, "valid beam ahead on /scan"),
    ],
)
def test_odometry_or_valid_scans_that_have_been_missing_for_more_than_a_second_are_named(
    server, odom, ahead, outcome, words
):
    server.receive_odom(1.5)
    server.receive_scan(1.5)
    for now, missing in ((2.4, None), (2.6, (outcome, f"no {words} for 1.1 s (limit 1 s)"))):
        server.ros_time = now
        if odom:
            server.receive_odom(now)
        if ahead is not None:
            server.receive_scan(now, ahead)
        assert server.inputs.missing(now, started=1.5, accepted=99.0) == missing


def test_data_from_before_the_goal_is_not_used_and_the_goal_has_a_second_for_newer_data(server):
    server.receive_odom(1.5)
    server.receive_scan(1.5)
    server.ros_time = 60.0
    assert server.inputs.read() is None
    assert server.inputs.missing(60.9, started=60.0, accepted=0.0) is None
    assert server.inputs.missing(61.1, started=60.0, accepted=0.0)[0] is Outcome.NO_ODOM


@pytest.mark.parametrize("x, w", [(0.0, 0.0), (0.0, 1.2), (0.0, math.nan), (math.nan, 1.0), (-1e39, 1.0)])
def test_impossible_pose_of_odometry_is_refused(server, x, w):
    server.receive_odom(1.5, x, w)
    server.receive_scan(1.5)
    expected = "finite numbers within +-1e+06 m" if w == 1.0 else "a quaternion of length 1"
    with pytest.raises(RobocopError, match=re.escape(f"/odom holds an impossible pose: expected {expected}, got x ")):
        server.inputs.read()


@pytest.mark.parametrize(
    "first, last, increment", [(-3.14, 3.14, -0.0175), (3.14, -3.14, 0.0175), (0.0, 0.0, 0.0), (0.0, 359.0, 1.0)]
)
def test_scan_whose_angles_contradict_themselves_ends_the_goal(server, first, last, increment):
    server.receive_odom(1.5)
    server.inputs.on_scan(
        LaserScan(angle_min=first, angle_max=last, angle_increment=increment, range_max=5.0, ranges=[2.0] * 360)
    )
    expected = f"none is, or the angles contradict each other (360 beams, angles {first:g} to {last:g} rad"
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


def test_two_messages_that_came_close_together_once_do_not_make_later_ticks_wait(ticking):
    for stamp in (1.51, 2.0, 2.5):  # the first by another publisher
        ticking.receive_odom(stamp)
        ticking.receive_scan(stamp)
    ticking.inputs.wait_for_tick(29 * 10**8)
    assert ticking.warnings == []


def test_message_is_waited_for_where_its_period_is_one_nanosecond_shorter_than_the_one_before(ticking):
    ticking.receive_scan(2.0)
    for nanoseconds in (2033333333, 2066666667):
        ticking.receive_odom(nanoseconds, unit=1)
    ticking.inputs.wait_for_tick(2100000000)
    assert len(ticking.warnings) == 1
