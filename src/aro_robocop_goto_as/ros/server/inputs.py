"""The server's inputs: the newest odometry and scan -> pose and clearance ahead, or which of the two is missing."""

import math
import threading
import time
from dataclasses import dataclass
from typing import Any, Optional, Tuple

import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from ... import goto
from ...errors import FrameError, RobocopError
from ...geometry import Pose2D
from ...goto import Outcome
from ...params import GotoParams
from .. import convert
from ..ticker import wait_until

# [s, wall] for the first message on a topic after a goal was accepted. The connection to a publisher that has just
# started takes up to a second on a busy machine; at full speed data_timeout passes meanwhile.
FIRST_MESSAGE = 3.0
LATE_DATA = 0.2  # [s, wall] that a message may arrive after the clock tick it was published before
LOCKSTEP_PATIENCE = 1.0  # [s, wall] for messages that a simulator in lockstep has already published


@dataclass(frozen=True)
class Received:
    """A message with the ROS time [s] and the wall time [s] of its arrival, its stamp and the topic's period [ns]."""

    message: Any
    at: float
    wall: float  # of time.monotonic
    stamp_ns: int
    period_ns: Optional[int]  # the shortest so far

    def is_newest_at(self, tick_ns: int) -> bool:
        """Whether, by the topic's period, no newer message is due by this time."""
        return self.period_ns is None or tick_ns - self.stamp_ns < self.period_ns


def _now() -> float:
    return rospy.get_rostime().to_sec()


def _received(message: Any, previous: Optional[Received]) -> Received:
    stamp_ns = convert.to_ns(message.header.stamp)
    periods = []
    if previous is not None and stamp_ns > previous.stamp_ns:  # false after the clock was set back
        periods = [period for period in (stamp_ns - previous.stamp_ns, previous.period_ns) if period is not None]
    return Received(message, _now(), time.monotonic(), stamp_ns, min(periods) if periods else None)


class Inputs:
    """Callbacks store the newest messages; the control loop reads what they mean."""

    def __init__(self, p: GotoParams) -> None:
        self.p = p
        self.odom: Optional[Received] = None
        self.scan: Optional[Received] = None
        self.valid_scan: Optional[Received] = None  # the newest with a valid beam ahead, by goto.clearance_ahead
        self._arrived = threading.Condition()
        # No queue size: with one, rospy drops all but the newest of a burst, which hides the topic's period.
        # Without TCP_NODELAY the kernel may hold a small message back for 40 ms: several control periods at high speed.
        rospy.Subscriber("odom", Odometry, self._on_odom, tcp_nodelay=True)
        rospy.Subscriber("scan", LaserScan, self._on_scan, tcp_nodelay=True)

    def _on_odom(self, message: Odometry) -> None:
        with self._arrived:
            self.odom = _received(message, self.odom)
            self._arrived.notify_all()

    def _on_scan(self, message: LaserScan) -> None:
        received = _received(message, self.scan)
        clearance = self._clearance_in(message)
        with self._arrived:
            if clearance is None or not math.isnan(clearance):
                self.valid_scan = received
            self.scan = received
            self._arrived.notify_all()

    def await_tick(self, tick_ns: int) -> None:
        """Wait for the messages that a simulator in lockstep published before it let the clock reach this tick."""
        with self._arrived:
            self._arrived.wait_for(
                lambda: all(topic is None or topic.is_newest_at(tick_ns) for topic in (self.odom, self.scan)),
                LOCKSTEP_PATIENCE,
            )

    def missing(self, now: float, started: float, accepted: float) -> Optional[Tuple[Outcome, str]]:
        """Outcome and reason when odometry or valid scans have been missing for data_timeout since the goal's start.

        They must be missing on the wall clock, too: a topic without any message since the goal was accepted, at
        `accepted` of time.monotonic, may just be connecting, and a message published before a clock tick may arrive
        after it.
        """
        for received, outcome in ((self.odom, Outcome.NO_ODOM), (self.valid_scan, Outcome.NO_SCAN)):
            last = started
            # A message later than the present is from before the clock was set back; one later than `now` need not be.
            if received is not None and received.at <= _now():
                last = max(started, received.at)
            if now - last <= self.p.data_timeout or self._may_be_connecting(outcome, accepted):
                continue
            if not wait_until(self._has_data, LATE_DATA):
                since = "so far" if received is None else f"for {now - received.at:.1f} s"
                return outcome, f"no {self._what_is_missing(outcome)} {since}, limit {self.p.data_timeout:g} s"
        return None

    def _may_be_connecting(self, outcome: Outcome, accepted: float) -> bool:
        newest = self.odom if outcome is Outcome.NO_ODOM else self.scan
        return (newest is None or newest.wall < accepted) and time.monotonic() - accepted < FIRST_MESSAGE

    def _what_is_missing(self, outcome: Outcome) -> str:
        if outcome is Outcome.NO_ODOM:
            return f"message on {rospy.resolve_name('odom')}"
        # By the time of now, as scans have arrived since the control period began.
        what = "valid beam ahead" if self._is_recent(self.scan, _now()) else "message"
        return f"{what} on {rospy.resolve_name('scan')}"

    def _is_recent(self, received: Optional[Received], now: float) -> bool:
        return received is not None and 0.0 <= now - received.at <= self.p.data_timeout

    def _has_data(self) -> bool:
        """Whether both odometry and a valid scan are recent enough to move the robot."""
        now = _now()
        return self._is_recent(self.odom, now) and self._is_recent(self.valid_scan, now)

    def read(self) -> Optional[Tuple[Pose2D, float]]:
        """Pose in odom and clearance ahead [m]; None without recent messages.

        RobocopError when a message is unusable: an impossible pose, a scan without a beam ahead.
        """
        odom, scan = self.odom, self.valid_scan
        if odom is None or scan is None or not self._has_data():
            return None
        try:
            pose = convert.to_possible_pose(odom.message.pose.pose)
        except FrameError as error:
            raise RobocopError(f"{rospy.resolve_name('odom')} holds an impossible pose: {error}") from error
        clearance = self._clearance_in(scan.message)
        if clearance is None:
            degrees = math.degrees(self.p.obstacle_half_angle)
            raise RobocopError(
                f"{rospy.resolve_name('scan')} has no beam within {degrees:.0f} degrees of straight ahead"
            )
        return pose, clearance

    def clearance(self) -> Optional[float]:
        """Distance to the nearest obstacle ahead [m]; None without a recent valid scan or without a beam ahead."""
        scan = self.valid_scan
        return self._clearance_in(scan.message) if scan is not None and self._is_recent(scan, _now()) else None

    def _clearance_in(self, s: LaserScan) -> Optional[float]:
        return goto.clearance_ahead(
            s.ranges, s.angle_min, s.angle_increment, s.range_min, s.range_max, self.p.obstacle_half_angle
        )
