"""The server's view of its inputs: it changes in one piece, and what is missing is said in the right words."""

import math
import re

import pytest
import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.errors import RobocopError
from aro_robocop_goto_as.goto import Outcome
from aro_robocop_goto_as.goto_params import GotoParams
from aro_robocop_goto_as.ros.server.inputs import FIRST_MESSAGE, Inputs


class Server:
    """Inputs with clocks and parameters that a test sets."""

    def __init__(self):
        self.ros_time, self.wall, self.params = 1.5, 100.0, GotoParams()
        self.inputs = Inputs(self, lambda: self.ros_time, lambda: self.wall, lambda: 0.0, self.callbacks_want_to_run)
        self.looks = 0
        self.at_looks = []  # what happens at each look at the callbacks; they want to run while this lasts
        self.at_last_look = lambda: None

    def callbacks_want_to_run(self):
        self.looks += 1
        if not self.at_looks:
            self.at_last_look()
            return False
        self.at_looks.pop(0)()
        return True

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
def server():
    return Server()


def test_scan_of_nan_is_called_invalid_even_if_it_arrives_after_the_control_period_began(server):
    server.receive(math.nan)
    outcome, text = server.inputs.missing(now=1.45, started=0.0, accepted=0.0)
    assert outcome is Outcome.NO_SCAN
    assert text == "no valid beam ahead on /scan so far (limit 1 s)"


def test_topic_without_any_message_since_the_goal_was_accepted_may_be_connecting(server):
    assert server.inputs.missing(now=50.0, started=0.0, accepted=100.0) is None
    server.wall += FIRST_MESSAGE
    missing = server.inputs.missing(now=50.0, started=0.0, accepted=100.0)
    assert missing == (Outcome.NO_ODOM, "no message on /odom so far (limit 1 s)")


def test_topic_that_fell_silent_after_the_goal_was_accepted_is_missing_at_once(server):
    server.receive(2.0)
    server.ros_time = 50.0
    missing = server.inputs.missing(now=50.0, started=0.0, accepted=100.0)
    assert missing == (Outcome.NO_ODOM, "no message on /odom for 48.5 s (limit 1 s)")


def test_parameters_that_were_changed_hold_at_once(server):
    server.receive(2.0)
    server.ros_time = 50.0
    assert server.inputs.read() is None
    server.params = GotoParams(data_timeout=100.0)
    assert server.inputs.missing(now=50.0, started=0.0, accepted=100.0) is None
    assert server.inputs.read() is not None


def test_new_scan_is_visible_only_once_it_is_known_whether_it_is_valid(server, monkeypatch):
    looked, inputs = [], server.inputs
    real = inputs._clearance_in

    def look_and_compute(message):
        looked.append(inputs.scan)
        return real(message)

    monkeypatch.setattr(inputs, "_clearance_in", look_and_compute)
    server.receive(2.0)
    assert looked == [None]
    first = inputs.scan
    assert first is not None and inputs.valid_scan is first
    server.receive(math.nan)
    assert inputs.scan is not first and inputs.valid_scan is first


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


def test_scan_of_a_scanner_that_turns_clockwise_is_valid(server):
    server.receive(2.0)
    server.inputs.on_scan(
        LaserScan(angle_min=3.14, angle_max=-3.14, angle_increment=-0.0175, range_max=5.0, ranges=[2.0] * 360)
    )
    assert server.inputs.read()[1] == 2.0


def test_messages_of_a_tick_are_waited_for_while_their_callbacks_get_no_processor(server, monkeypatch):
    monkeypatch.setattr(f"{Inputs.__module__}.LOCKSTEP_PATIENCE", 0.01)
    server.ros_time = 2.0
    for stamp in (1.0, 1.5):
        server.receive_odom(stamp)
        server.receive_scan(stamp)
    server.at_looks = [lambda: None, lambda: server.receive_odom(2.0), lambda: server.receive_scan(2.0)]
    server.inputs.await_tick(2 * 10**9)
    assert server.at_looks == []


@pytest.mark.parametrize("number", [0, 1])  # of messages that came before: one does not tell the period yet
def test_messages_of_an_unknown_period_are_waited_for_while_callbacks_want_to_run(server, number):
    for _ in range(number):
        server.receive_odom(0.9)
        server.receive_scan(0.9)
    server.at_looks = [lambda: None, lambda: server.receive_odom(1.0), lambda: server.receive_scan(1.0)]
    server.ros_time = 1.0
    server.inputs.await_tick(10**9)
    assert server.at_looks == [] and (server.inputs.odom.stamp_ns, server.inputs.scan.stamp_ns) == (10**9, 10**9)


def test_message_that_was_not_sent_is_not_waited_for(server):
    server.inputs.await_tick(10**9)
    server.receive_odom(1.4)
    server.inputs.await_tick(10**9)
    assert server.looks == 2


def test_messages_from_before_the_clock_was_set_back_are_forgotten_and_the_first_ones_after_it_are_waited_for(server):
    server.ros_time = 5.0
    for stamp in (4.9, 5.0):
        server.receive_odom(stamp)
        server.receive_scan(stamp)
    server.ros_time = 0.1
    # One thread handles these, in this order.
    server.at_looks = [lambda: server.receive_odom(5.0), lambda: server.receive_odom(0.1)]
    server.inputs.await_tick(10**8)
    assert server.at_looks == [] and server.inputs.odom.stamp_ns == 10**8
    assert server.inputs.scan is None and server.inputs.read() is None


def test_odometry_from_before_the_clock_was_set_back_that_came_late_is_not_used(server):
    server.ros_time = 5.0
    server.inputs.await_tick(5 * 10**9)
    server.ros_time = 0.1
    server.receive_scan(0.1)
    server.at_looks = [lambda: server.receive_odom(5.0)]
    server.inputs.await_tick(10**8)
    assert server.inputs.read() is None


def test_messages_that_are_handled_before_the_clock_that_follows_them_are_kept(server):
    server.ros_time = 1.0
    for stamp in (0.9, 1.0):
        server.receive_odom(stamp)
        server.receive_scan(stamp)
    server.inputs.await_tick(10**9)
    server.receive_odom(1.3)  # of a simulator whose control period is longer
    server.receive_scan(1.3)
    server.ros_time = 1.05
    server.inputs.await_tick(105 * 10**7)
    assert server.inputs.read() is not None


def test_messages_from_before_a_reset_soon_after_the_start_are_forgotten(server):
    server.ros_time = 0.2
    for stamp in (0.1, 0.2):
        server.receive_odom(stamp)
        server.receive_scan(stamp)
    server.inputs.await_tick(2 * 10**8)
    server.ros_time = 0.1
    server.inputs.await_tick(10**8)
    assert server.inputs.odom is None and server.inputs.valid_scan is None


def test_data_that_arrives_in_the_moment_of_the_last_look_is_not_missing(server):
    server.receive(2.0)
    server.ros_time = 50.0
    server.at_last_look = lambda: server.receive(2.0)
    assert server.inputs.missing(now=50.0, started=0.0, accepted=100.0) is None
