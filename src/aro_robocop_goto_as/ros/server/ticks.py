"""The ticks of the control loop, each known by its ROS time [ns]: a whole multiple of the loop's period."""

import math
import threading
from fractions import Fraction
from typing import Callable, Optional, Sequence

import rospy
from rosgraph_msgs.msg import Clock

from aro_robocop_goto_as.msg import TickAnswer

from ...geometry import NANOSECONDS, STANDSTILL, Twist2D
from .. import convert
from ..publishing.publisher import publisher


class Ticks:
    """Waits for ticks, and answers them: a simulator in lockstep holds time at each one until it is answered.

    Unlike rospy.Rate, the wait can be interrupted, as by a cancel while /clock is paused.
    """

    def __init__(self, rate: float, inputs: Sequence[rospy.Subscriber], on_set_back: Callable[[str], None]) -> None:
        """`rate` [Hz]; `on_set_back` is called with the reason when simulated time was set back.

        The first answer is sent once the `inputs` are connected; from then on a simulator in lockstep waits for this
        node.
        """
        self.command: Optional[Twist2D] = None  # since the last answer
        self._period_ns = NANOSECONDS / Fraction(rate).limit_denominator(10**6)  # exactly
        self._inputs, self._on_set_back = inputs, on_set_back
        self._has_joined = False
        self._changed = threading.Condition()
        self._clock = rospy.Time()
        self._is_simulated = rospy.get_param("/use_sim_time", False)
        self.answers = publisher("tick_answer", TickAnswer)  # sends at once: simulated time stands meanwhile
        self.answered_ns = self.newest_ns()  # the newest tick [ns] that is done
        if self._is_simulated:  # rospy subscribed to /clock before, so its time is already new in this callback
            rospy.Subscriber("/clock", Clock, self._on_clock, queue_size=1, tcp_nodelay=True)

    def _on_clock(self, message: Clock) -> None:
        before, self._clock = self._clock, message.clock
        if message.clock < before:
            self._on_set_back(
                f"simulated time was set back from {before.to_sec():.1f} to {message.clock.to_sec():.1f} s"
            )
        topics = (self.answers, *self._inputs)
        if not self._has_joined and all(topic.get_num_connections() for topic in topics):
            self._has_joined = True
            self._publish(self.answered_ns, None)
        self.wake()

    def wake(self) -> None:
        """Wake the thread that waits, so that it looks for an interruption."""
        with self._changed:
            self._changed.notify_all()

    def newest_ns(self) -> int:
        """The time of the newest tick [ns]."""
        return self._tick_ns(rospy.get_rostime().to_nsec())

    def _tick_ns(self, time_ns: int, later: int = 0) -> int:
        """The newest tick [ns] at a time [ns], or the one `later` ticks after it; rounded down as in the simulator."""
        number = math.ceil((time_ns + 1) / self._period_ns) - 1 + later
        return math.floor(number * self._period_ns)

    def wait_for_next(self, last_ns: int, is_interrupted: Callable[[], bool]) -> int:
        """Wait until there is a later tick than the last one, or for an interruption; the newest tick [ns]."""
        with self._changed:
            while self.newest_ns() <= last_ns and not is_interrupted():
                if self._is_simulated:
                    self._changed.wait()
                    continue
                if self.newest_ns() < last_ns:  # the wall clock was set back
                    last_ns = self.answered_ns = self.newest_ns()
                remaining = self._tick_ns(last_ns, later=1) - rospy.get_rostime().to_nsec()
                self._changed.wait(max(0, remaining) / NANOSECONDS)
        return self.newest_ns()

    def answer(self, tick_ns: int) -> None:
        """Tell a simulator in lockstep that this tick is done, with the command since the last answer, if any."""
        if tick_ns > self.answered_ns:
            self.answered_ns = tick_ns
            command, self.command = self.command, None
            if self._has_joined:
                self._publish(tick_ns, command)

    def _publish(self, tick_ns: int, command: Optional[Twist2D]) -> None:
        twist = convert.to_twist_msg(command or STANDSTILL)
        self.answers.publish(TickAnswer(convert.to_time(tick_ns), command is not None, twist))
