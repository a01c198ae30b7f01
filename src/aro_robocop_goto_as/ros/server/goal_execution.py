"""The lab's loop for one goal: in each control period a velocity and feedback, at the end an outcome."""

import time
from dataclasses import dataclass
from typing import Optional, Tuple

import ros_numpy
import rospy

from aro_robocop_goto_as.msg import GoToPositionFeedback, GoToPositionGoal

from ... import goto
from ...geometry import FARTHEST, STANDSTILL
from ...goto import Decision, End, Errors, Goal, MoveForward, Outcome, Progress, Rotate, Turning
from ...goto_params import GotoParams
from ...simulation.schedule import NANOSECONDS
from ..names import place
from .inputs import Inputs
from .tuning import Tuning

MOST_JUMPS = 10  # of odometry after which a goal begins anew, as after a reset; of one that jumps for ever, no more
LONGEST_GAP = 2.0  # control periods between two steps; what is longer is time in which the server could not drive


@dataclass(frozen=True)
class Ending:
    """How a goal ended, with an explanation."""

    outcome: Outcome
    text: str

    @property
    def message(self) -> str:
        """The result's message: the outcome's name, then the explanation."""
        return f"{self.outcome.value}: {self.text}"


class GoalExecution:
    """The state of one accepted goal. Times are ROS times [s] unless marked wall."""

    def __init__(self, message: GoToPositionGoal, tuning: Tuning, inputs: Inputs) -> None:
        x, y, self.z = (float(value) for value in ros_numpy.numpify(message.position))
        self.goal = Goal(x, y)
        self.outcome: Optional[Outcome] = None  # set by the goal's owner when the goal has ended
        self.twist = STANDSTILL  # of the newest control period
        self._tuning = tuning
        self._inputs = inputs
        self._accepted = time.monotonic()  # [s, wall]
        self._started: Optional[float] = None
        self._last: Optional[float] = None  # time of the previous step
        self._stalled = 0.0  # [s] in which no step ran, as on a machine without time for it: no lack of progress
        self._progress: Optional[Progress] = None
        self._errors: Optional[Errors] = None  # of the previous step
        self._jumps = 0
        self._turning = Turning()

    def refusal(self) -> Optional[Ending]:
        """The ending of a goal that is not a position in reach; None for a valid goal."""
        if abs(self.goal.x) <= FARTHEST and abs(self.goal.y) <= FARTHEST:  # false for NaN
            return None
        return Ending(
            Outcome.BAD_GOAL,
            f"position x {self.goal.x} y {self.goal.y}: expected finite numbers in metres, at most {FARTHEST:g}",
        )

    def step(self, tick_ns: int) -> Tuple[Optional[GoToPositionFeedback], Optional[Ending]]:
        """Run one control period, at time `tick_ns`: sets `twist`.

        Returns feedback, None without recent odometry and scan, and the goal's ending, None to go on.
        """
        p, now = self._tuning.params, tick_ns / NANOSECONDS
        if self._started is None or self._last is None or now <= self._last:  # first period, or the clock was set back
            self._started, self._progress, self._last, self._turning = now, None, None, Turning()
            self._errors, self._jumps = None, 0
            self.twist = STANDSTILL
        gap = 0.0 if self._last is None else now - self._last
        self._stalled += max(0.0, gap - LONGEST_GAP / p.control_rate)
        self._last = now
        missing = self._inputs.missing(now, self._started, self._accepted)
        if missing is not None:
            return None, Ending(*missing)
        inputs = self._inputs.read()
        if inputs is None:
            return None, None
        pose, clearance = inputs
        errors = goto.errors_to(self.goal, pose)
        if self._errors is not None and self._jumps < MOST_JUMPS and goto.has_jumped(self._errors, errors, p):
            self._jumps, self._progress, self._turning = self._jumps + 1, None, Turning()
        self._errors = errors
        decision = goto.decide(pose, clearance, self.goal, p, self._turning)
        turning = self._turning.after(decision)
        if turning.limit(p) < self._turning.limit(p):  # a new attempt, which gets its own time
            self._progress = None
        self._turning, driven = turning, now - self._stalled
        self._progress = goto.track_progress(self._progress, errors, driven, p.stuck_distance, p.stuck_angle)
        self.twist = goto.limit_acceleration(self.twist, decision, 1.0 / p.control_rate, p)
        feedback = GoToPositionFeedback(errors.position, errors.angle, describe(decision))
        elapsed, idle = now - self._started, driven - self._progress.since
        return feedback, self._ending(p, decision, clearance, elapsed, idle)

    def _ending(
        self, p: GotoParams, decision: Decision, clearance: float, elapsed: float, idle: float
    ) -> Optional[Ending]:
        """The ending that follows from this decision, the time without progress or the time since the start."""
        where = f"{decision.errors.position:.3f} m from the goal {self.where()} after {elapsed:.1f} s"
        if isinstance(decision, End) and decision.outcome is Outcome.REACHED:
            return Ending(Outcome.REACHED, where)
        if isinstance(decision, End):
            obstacle = f"obstacle {clearance:.3f} m ahead (limit {p.obstacle_distance:g} m)"
            return Ending(decision.outcome, f"{obstacle}; {where}")
        if idle > p.stuck_timeout:
            return Ending(Outcome.STUCK, f"no progress for {idle:.1f} s; {where}")
        if 0.0 < p.goal_timeout < elapsed:
            return Ending(Outcome.TIMEOUT, f"not reached within {p.goal_timeout:g} s; {where}")
        return None

    def stopped_early(self, outcome: Outcome, reason: str) -> Ending:
        """The ending of a goal that a client or a shutdown stops."""
        elapsed = 0.0 if self._started is None else max(0.0, rospy.get_rostime().to_sec() - self._started)
        return Ending(outcome, f"goal {self.where()} stopped after {elapsed:.1f} s: {reason}")

    def where(self) -> str:
        """The goal's position in words, with its frame, the one of odometry, once that is known."""
        x, y, odom = self.goal.x, self.goal.y, self._inputs.odom
        return f"x {x:.2f} y {y:.2f}" if odom is None else place(x, y, odom.message.header.frame_id)


def describe(decision: Decision) -> str:
    """The feedback's message."""
    if isinstance(decision, Rotate):
        return f"rotating, {decision.errors.angle:.2f} rad to go"
    if isinstance(decision, MoveForward):
        return f"driving, {decision.errors.position:.2f} m to go"
    return decision.outcome.value.lower()
