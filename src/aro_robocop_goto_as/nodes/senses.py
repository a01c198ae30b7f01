"""The newest odometry and scan -> pose and clearance ahead, or which of the two is missing."""

import math
from dataclasses import dataclass
from typing import Optional, Tuple

import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from .. import goto
from ..errors import RobocopError
from ..geometry import Pose2D
from ..goto import Outcome
from ..params import GotoParams
from . import convert
from .ticker import wait_until

LATE_DATA = 0.2  # [s, wall] that data may come later than the tick of the clock it was sent before
LOCKSTEP_PATIENCE = 1.0  # [s, wall] for data that a simulator in lockstep has sent already


@dataclass(frozen=True)
class Received:
    """A message with the ROS time [s] of its arrival, its own stamp and the shortest time between two so far [ns]."""

    message: object
    at: float
    stamp_ns: int
    period_ns: Optional[int]

    def is_newest_at(self, tick_ns: int) -> bool:
        """Whether, by the topic's own period, nothing newer is due by a time."""
        return self.period_ns is None or tick_ns - self.stamp_ns < self.period_ns


def _now() -> float:
    return rospy.get_rostime().to_sec()


def _received(message: object, before: Optional[Received]) -> Received:
    stamp_ns = convert.to_ns(message.header.stamp)  # type: ignore[attr-defined]
    gaps = []
    if before is not None and stamp_ns > before.stamp_ns:  # not so when the clock was set back
        gaps = [gap for gap in (stamp_ns - before.stamp_ns, before.period_ns) if gap is not None]
    return Received(message, _now(), stamp_ns, min(gaps) if gaps else None)


class Senses:
    """Callbacks keep the newest message; whoever asks gets what it means."""

    def __init__(self, p: GotoParams) -> None:
        self.p = p
        self.odom: Optional[Received] = None
        self.scan: Optional[Received] = None
        # No queue size: rospy would drop all but the newest of what comes at once, and the topic's period with it.
        rospy.Subscriber("odom", Odometry, self._on_odom)
        rospy.Subscriber("scan", LaserScan, self._on_scan)

    def _on_odom(self, message: Odometry) -> None:
        self.odom = _received(message, self.odom)

    def _on_scan(self, message: LaserScan) -> None:
        self.scan = _received(message, self.scan)

    def await_tick(self, tick_ns: int) -> None:
        """Wait for what a simulator in lockstep sent before it let the clock reach this tick."""
        wait_until(lambda: all(it is None or it.is_newest_at(tick_ns) for it in (self.odom, self.scan)),
                   LOCKSTEP_PATIENCE, poll=0.0005)

    def missing(self, now: float, started: float) -> Optional[Tuple[Outcome, str]]:
        """Outcome and words when odometry or scan has been silent too long, counted from the goal's start at the least.

        What was sent before the clock ticked may arrive after it, so the silence has to last on the wall clock too.
        """
        for received, outcome, topic in ((self.odom, Outcome.NO_ODOM, "odom"), (self.scan, Outcome.NO_SCAN, "scan")):
            last = started if received is None else max(started, min(received.at, now))
            if now - last > self.p.data_timeout and not wait_until(self._has_data, LATE_DATA):
                since = "ever" if received is None else f"for {now - received.at:.1f} s"
                limit = f"limit {self.p.data_timeout:g} s"
                return outcome, f"no message on {rospy.resolve_name(topic)} {since}, {limit}"
        return None

    def _has_data(self) -> bool:
        """Whether odometry and scan are recent enough to drive by."""
        now = _now()
        return all(received is not None and now - received.at <= self.p.data_timeout
                   for received in (self.odom, self.scan))

    def read(self) -> Optional[Tuple[Pose2D, float]]:
        """Pose and clearance of the newest messages; None while there are none, or only such from long ago.

        RobocopError when they can't be driven by: a pose that is not finite, a scan that does not look ahead.
        """
        odom = self.odom
        if odom is None or not self._has_data():
            return None
        pose = convert.from_pose_msg(odom.message.pose.pose)
        if not all(map(math.isfinite, (pose.x, pose.y, pose.yaw))):
            raise RobocopError("{} holds a pose that is not finite: {}".format(rospy.resolve_name("odom"), pose))
        clearance = self.clearance()
        if clearance is None:
            raise RobocopError("{} has no beam within {:.0f} degrees of straight ahead".format(
                rospy.resolve_name("scan"), math.degrees(self.p.obstacle_half_angle)))
        return pose, clearance

    def clearance(self) -> Optional[float]:
        """Distance to the nearest obstacle ahead [m]; None when there is no scan, or none that looks ahead."""
        scan = self.scan
        if scan is None:
            return None
        s = scan.message
        return goto.clearance_ahead(s.ranges, s.angle_min, s.angle_increment, s.range_min, s.range_max,
                                    self.p.obstacle_half_angle)
