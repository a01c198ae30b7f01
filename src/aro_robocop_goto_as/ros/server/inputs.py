"""The server's inputs: the newest odometry and scan -> pose and clearance ahead, or which of the two is missing."""

import math
import threading
import time
from dataclasses import dataclass
from typing import Any, Callable, Optional, Tuple

import rospy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from ...errors import FrameError, RobocopError
from ...geometry import Pose2D
from ...goto import Outcome
from ...obstacle_ahead import clearance_ahead
from ...process.peer import await_others, others_want_to_run
from .. import convert
from .tuning import Tuning

# [s, wall] for the first message on a topic after a goal was accepted. The connection to a publisher that has just
# started takes up to a second on a busy machine; at full speed data_timeout passes meanwhile.
FIRST_MESSAGE = 3.0
LATE_DATA = 0.2  # [s, wall] that a message may arrive after the clock tick it was published before
# [s, wall and processor] for messages that a simulator in lockstep has already published
LOCKSTEP_PATIENCE = 1.0


@dataclass(frozen=True)
class Received:
    """A message with the ROS time [s] and the wall time [s] of its arrival, its stamp and the topic's period [ns]."""

    message: Any
    at: float
    wall: float
    stamp_ns: int
    period_ns: float = math.inf  # the shortest so far


def _ros_time() -> float:
    return rospy.get_rostime().to_sec()


class Inputs:
    """Callbacks store the newest messages; the control loop reads what they mean."""

    def __init__(
        self,
        tuning: Tuning,
        ros_time: Callable[[], float] = _ros_time,
        wall: Callable[[], float] = time.monotonic,
        processor_time: Callable[[], float] = time.process_time,
        callbacks_want_to_run: Callable[[], bool] = others_want_to_run,
    ) -> None:
        """The first three are clocks [s]; the last tells whether a callback may wait for a processor."""
        self._tuning = tuning
        self._ros_time, self._wall, self._processor_time = ros_time, wall, processor_time
        self._callbacks_want_to_run = callbacks_want_to_run
        self.odom: Optional[Received] = None
        self.scan: Optional[Received] = None
        self.valid_scan: Optional[Received] = None  # the newest with a valid beam ahead, by clearance_ahead
        self._tick_ns = 0  # the newest one that was awaited
        self._arrived = threading.Condition()

    def on_odom(self, message: Odometry) -> None:
        """Store odometry; a callback."""
        with self._arrived:
            self.odom = self._received(message, self.odom)
            self._arrived.notify_all()

    def on_scan(self, message: LaserScan) -> None:
        """Store a scan; a callback."""
        received = self._received(message, self.scan)
        clearance = self._clearance_in(message)
        with self._arrived:
            if clearance is None or not math.isnan(clearance):
                self.valid_scan = received
            self.scan = received
            self._arrived.notify_all()

    def _received(self, message: Any, previous: Optional[Received]) -> Received:
        stamp_ns, period_ns = convert.to_ns(message.header.stamp), math.inf
        if previous is not None and stamp_ns > previous.stamp_ns:  # false after the clock was set back
            period_ns = min(stamp_ns - previous.stamp_ns, previous.period_ns)
        return Received(message, self._ros_time(), self._wall(), stamp_ns, period_ns)

    def await_tick(self, tick_ns: int) -> None:
        """Wait for the messages that a simulator in lockstep published before it let the clock reach this tick.

        A topic's period tells whether one is due; before that is known, whether callbacks want to run.
        """

        def complete() -> bool:
            newest = [topic for topic in (self.odom, self.scan) if topic is not None]
            return all(tick_ns - topic.stamp_ns < topic.period_ns for topic in newest)

        is_set_back, self._tick_ns = tick_ns <= self._tick_ns, tick_ns
        self._forget_earlier_run(is_set_back)
        if not self._knows_periods():
            self._await(self._knows_periods, 0.0, LOCKSTEP_PATIENCE)
            self._forget_earlier_run(is_set_back)
        if self.odom is not None:  # otherwise the other node may be no simulator
            self._await(complete, LOCKSTEP_PATIENCE, LOCKSTEP_PATIENCE)

    def _knows_periods(self) -> bool:
        return all(topic is not None and math.isfinite(topic.period_ns) for topic in (self.odom, self.scan))

    def _forget_earlier_run(self, is_set_back: bool) -> None:
        """Forget messages from before the clock was set back, at that tick also those whose callbacks came later.

        These are told by their stamps, with a margin, as a message may be handled before the clock that follows it.
        """
        latest_ns = (self._ros_time() + 1.0 / self._tuning.params.control_rate) * 1e9 if is_set_back else math.inf

        def kept(topic: Optional[Received]) -> Optional[Received]:
            return topic if topic is not None and self.is_of_this_run(topic) and topic.stamp_ns <= latest_ns else None

        with self._arrived:
            self.odom, self.scan, self.valid_scan = kept(self.odom), kept(self.scan), kept(self.valid_scan)

    def is_of_this_run(self, topic: Received) -> bool:
        """False for a message that was received before the clock was set back: later than it is now."""
        return topic.at <= self._ros_time()

    def _await(self, complete: Callable[[], bool], wall: float, processor: float) -> bool:
        """Wait for messages until `complete`, by await_others(); returns whether it is."""

        def wait(timeout: float) -> bool:
            with self._arrived:
                return self._arrived.wait_for(complete, timeout)

        return await_others(wait, wall, processor, self._processor_time, self._callbacks_want_to_run)

    def missing(self, now: float, started: float, accepted: float) -> Optional[Tuple[Outcome, str]]:
        """Outcome and reason when odometry or valid scans have been missing for data_timeout since the goal's start.

        They must be missing on the wall clock, too: a topic without any message since the goal was accepted, at the
        wall time `accepted`, may just be connecting, and a message published before a clock tick may arrive after it.
        """
        for name, outcome, newest, valid in (
            ("odom", Outcome.NO_ODOM, self.odom, self.odom),
            ("scan", Outcome.NO_SCAN, self.scan, self.valid_scan),
        ):
            last = started
            if valid is not None and self.is_of_this_run(valid):  # one later than `now` may be
                last = max(started, valid.at)
            overdue = now - last > self._tuning.params.data_timeout
            connecting = newest is None or newest.wall < accepted
            if connecting and self._wall() - accepted < FIRST_MESSAGE:
                continue
            if overdue and not self._await(self._has_data, LATE_DATA, LATE_DATA):
                return outcome, self._absence(name, valid, now)
        return None

    def _absence(self, name: str, valid: Optional[Received], now: float) -> str:
        # By the present time, as scans have arrived since the control period began.
        what = "valid beam ahead" if name == "scan" and self._is_recent(self.scan) else "message"
        since = "so far" if valid is None else f"for {now - valid.at:.1f} s"
        return f"no {what} on {rospy.resolve_name(name)} {since} (limit {self._tuning.params.data_timeout:g} s)"

    def _is_recent(self, received: Optional[Received]) -> bool:
        age = -1.0 if received is None else self._ros_time() - received.at
        return 0.0 <= age <= self._tuning.params.data_timeout

    def _has_data(self) -> bool:
        """Whether both odometry and a valid scan are recent enough to move the robot."""
        return self._is_recent(self.odom) and self._is_recent(self.valid_scan)

    def read(self) -> Optional[Tuple[Pose2D, float]]:
        """Pose in odom and clearance ahead [m]; None without recent messages.

        RobocopError when a message is unusable: an impossible pose, a scan without a beam ahead.
        """
        odom, scan = self.odom, self.valid_scan
        if odom is None or scan is None or not self._has_data():
            return None
        try:
            pose = convert.from_pose_msg(odom.message.pose.pose)
        except FrameError as error:
            raise RobocopError(f"{rospy.resolve_name('odom')} holds an impossible pose: {error}") from error
        clearance = self._clearance_in(scan.message)
        if clearance is None:
            s, cone = scan.message, math.degrees(self._tuning.params.obstacle_half_angle)
            angles = f"angles {s.angle_min:g} to {s.angle_max:g} rad, increment {s.angle_increment:g} rad"
            raise RobocopError(
                f"{rospy.resolve_name('scan')} has no beam within {cone:.0f} degrees of straight ahead "
                f"({len(s.ranges)} beams, {angles})"
            )
        return pose, clearance

    def clearance(self) -> Optional[float]:
        """Distance to the nearest obstacle ahead [m]; None without a recent valid scan or without a beam ahead."""
        scan = self.valid_scan
        return self._clearance_in(scan.message) if scan is not None and self._is_recent(scan) else None

    def _clearance_in(self, s: LaserScan) -> Optional[float]:
        if s.angle_increment * (s.angle_max - s.angle_min) < 0.0:  # clockwise or counter-clockwise?
            return None
        half_angle = self._tuning.params.obstacle_half_angle
        return clearance_ahead(s.ranges, s.angle_min, s.angle_increment, s.range_min, s.range_max, half_angle)
