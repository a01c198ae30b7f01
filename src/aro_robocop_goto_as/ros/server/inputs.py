"""The server's inputs: the newest odometry and scan -> pose and clearance ahead, or the reason why one is missing."""

import math
import threading
import time
from dataclasses import dataclass
from typing import Any, Optional, Tuple

import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from ...errors import FrameError, RobocopError
from ...geometry import Pose2D
from ...goto.obstacle_ahead import clearance_ahead
from ...goto.rule import Outcome
from .. import convert
from .tuning import Tuning

# [s, wall] for a topic's first message after a goal was accepted: its publisher may be connecting
FIRST_MESSAGE_TIMEOUT = 3.0
ROUNDING = 1  # [ns] by which two periods of a topic differ, as stamps are rounded
TICK_TIMEOUT = 1.0  # [s, wall] for messages that a simulator in lockstep has already published


@dataclass(frozen=True)
class ReceivedMessage:
    """A message with the ROS time [s] and the wall time [s] of its arrival, its stamp and the topic's period [ns]."""

    message: Any
    at: float
    wall: float
    stamp_ns: int
    period_ns: float  # since the message before
    clearance: Optional[float]  # [m] to the nearest obstacle ahead, of a scan that has a beam ahead


def _received(message: Any, previous: Optional[ReceivedMessage], clearance: Optional[float] = None) -> ReceivedMessage:
    stamp_ns, period_ns = message.header.stamp.to_nsec(), math.inf
    if previous is not None and stamp_ns > previous.stamp_ns:
        period_ns = stamp_ns - previous.stamp_ns
    return ReceivedMessage(message, rospy.get_rostime().to_sec(), time.monotonic(), stamp_ns, period_ns, clearance)


class Inputs:
    """Callbacks store the newest messages; the control loop reads what they mean."""

    def __init__(self, tuning: Tuning) -> None:
        self._tuning = tuning
        self.odom: Optional[ReceivedMessage] = None
        self.scan: Optional[ReceivedMessage] = None
        self.valid_scan: Optional[ReceivedMessage] = None  # the newest, except those whose beams ahead are all NaN
        self._arrived = threading.Condition()

    def on_odom(self, message: Odometry) -> None:
        """Store odometry; a callback."""
        with self._arrived:
            self.odom = _received(message, self.odom)
            self._arrived.notify_all()

    def on_scan(self, message: LaserScan) -> None:
        """Store a scan; a callback."""
        clearance = self._clearance_in(message)
        with self._arrived:
            self.scan = _received(message, self.scan, clearance)
            if clearance is None or not math.isnan(clearance):
                self.valid_scan = self.scan
            self._arrived.notify_all()

    def wait_for_tick(self, tick_ns: int) -> None:
        """Wait for the messages that a simulator in lockstep published before it let the clock reach this tick.

        A topic's period tells whether a message is due; until two messages have come, the period is unknown and no
        message is due.
        """

        def complete() -> bool:
            known = [topic for topic in (self.odom, self.scan) if topic is not None]
            return all(tick_ns - topic.stamp_ns + ROUNDING < topic.period_ns for topic in known)

        with self._arrived:
            if not self._arrived.wait_for(complete, TICK_TIMEOUT):
                rospy.logwarn_throttle(10.0, f"no odometry or scan of {tick_ns / 1e9:.3f} s within {TICK_TIMEOUT:g} s")

    def missing(self, now: float, started: float, accepted: float) -> Optional[Tuple[Outcome, str]]:
        """Outcome and reason when odometry or valid scans have been missing for data_timeout since the goal's start.

        A topic without any message since the goal was accepted, at the wall time `accepted`, may still be connecting.
        """
        for name, outcome, newest, valid in (
            ("odom", Outcome.NO_ODOM, self.odom, self.odom),
            ("scan", Outcome.NO_SCAN, self.scan, self.valid_scan),
        ):
            last = started if valid is None else max(started, valid.at)
            is_silent = newest is None or newest.wall < accepted
            is_connecting = is_silent and time.monotonic() - accepted < FIRST_MESSAGE_TIMEOUT
            if now - last > self._tuning.params.data_timeout and not is_connecting:
                return outcome, self._absence(name, valid, now)
        return None

    def _absence(self, name: str, valid: Optional[ReceivedMessage], now: float) -> str:
        # Compared with the present time: scans may have arrived since the control period began.
        what = "valid beam ahead" if name == "scan" and self._is_recent(self.scan) else "message"
        since = "so far" if valid is None else f"for {now - valid.at:.1f} s"
        return f"no {what} on {rospy.resolve_name(name)} {since} (limit {self._tuning.params.data_timeout:g} s)"

    def _is_recent(self, message: Optional[ReceivedMessage]) -> bool:
        now, limit = rospy.get_rostime().to_sec(), self._tuning.params.data_timeout
        return message is not None and now - message.at <= limit

    def read(self) -> Optional[Tuple[Pose2D, float]]:
        """Pose in odom and clearance ahead [m]; None without recent messages.

        RobocopError when a message is unusable: an impossible pose, a scan without a beam ahead.
        """
        odom, scan = self.odom, self.valid_scan
        if odom is None or scan is None or not (self._is_recent(odom) and self._is_recent(scan)):
            return None
        try:
            pose = convert.from_pose_msg(odom.message.pose.pose)
        except FrameError as error:
            raise RobocopError(f"{rospy.resolve_name('odom')} holds an impossible pose: {error}") from error
        if scan.clearance is None:
            s, cone = scan.message, math.degrees(self._tuning.params.obstacle_half_angle)
            angles = f"angles {s.angle_min:g} to {s.angle_max:g} rad, increment {s.angle_increment:g} rad"
            raise RobocopError(
                f"{rospy.resolve_name('scan')}: no beam is known to be within {cone:.0f} degrees of straight ahead: "
                f"none is, or the angles contradict each other ({len(s.ranges)} beams, {angles})"
            )
        return pose, scan.clearance

    def clearance(self) -> Optional[float]:
        """Distance to the nearest obstacle ahead [m]; None without a recent valid scan or without a beam ahead."""
        scan = self.valid_scan
        return scan.clearance if scan is not None and self._is_recent(scan) else None

    def _clearance_in(self, s: LaserScan) -> Optional[float]:
        if s.angle_increment * (s.angle_max - s.angle_min) < 0.0:  # so it is not known which beams are ahead
            return None
        half_angle = self._tuning.params.obstacle_half_angle
        return clearance_ahead(s.ranges, s.angle_min, s.angle_increment, s.range_min, s.range_max, half_angle)
