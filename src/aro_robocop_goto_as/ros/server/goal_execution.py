"""The lab's loop for one goal: in each control period a velocity and feedback, at the end an outcome."""

import time
from dataclasses import dataclass
from typing import Optional

import ros_numpy
import rospy

from aro_robocop_goto_as.msg import GoToPositionFeedback, GoToPositionGoal

from ... import goto
from ...geometry import FARTHEST, STANDSTILL, Twist2D
from ...goto import Decision, End, Goal, MoveForward, Outcome, Progress, Rotate
from ...params import GotoParams
from ...simulation.clock import NANOSECONDS
from .inputs import Inputs

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


@dataclass(frozen=True)
class Step:
    """What one control period brought: a velocity to command and feedback, or an ending, or all three."""

    twist: Twist2D = STANDSTILL
    feedback: Optional[GoToPositionFeedback] = None  # None without recent odometry and scan
    ending: Optional[Ending] = None


class GoalExecution:
    """The state of one accepted goal. Times are ROS times unless marked wall."""

    def __init__(self, message: GoToPositionGoal, p: GotoParams, inputs: Inputs) -> None:
        x, y, self.z = (float(value) for value in ros_numpy.numpify(message.position))
        self.goal = Goal(x, y)
        self.p = p
        self.inputs = inputs
        self.accepted = time.monotonic()  # [s, wall]
        self.started: Optional[float] = None
        self.last: Optional[float] = None  # time of the previous step
        self.stalled = 0.0  # [s] in which no step ran, as on a machine without time for it: no lack of progress
        self.progress: Optional[Progress] = None
        self.twist = STANDSTILL

    def refusal(self) -> Optional[Ending]:
        """The ending of a goal that is not a position in reach; None for a valid goal."""
        if abs(self.goal.x) <= FARTHEST and abs(self.goal.y) <= FARTHEST:  # false for NaN
            return None
        return Ending(
            Outcome.BAD_GOAL,
            f"position x {self.goal.x} y {self.goal.y}: expected finite numbers in metres, at most {FARTHEST:g}",
        )

    def step(self, tick_ns: int) -> Step:
        """Run one control period, at time `tick_ns`."""
        now = tick_ns / NANOSECONDS
        if self.started is None or now < self.started:  # first period, or the clock was set back
            self.started, self.progress, self.last = now, None, None
        gap = 0.0 if self.last is None else now - self.last
        self.stalled += max(0.0, gap - LONGEST_GAP / self.p.control_rate)
        self.last = now
        missing = self.inputs.missing(now, self.started, self.accepted)
        if missing is not None:
            return Step(ending=Ending(*missing))
        inputs = self.inputs.read()
        if inputs is None:
            return Step()
        pose, clearance = inputs
        decision = goto.decide(pose, clearance, self.goal, self.p)
        self.progress = goto.track_progress(
            self.progress, decision.errors, now - self.stalled, self.p.stuck_distance, self.p.stuck_angle
        )
        self.twist = goto.limit_acceleration(self.twist, decision, 1.0 / self.p.control_rate, self.p)
        feedback = GoToPositionFeedback(decision.errors.position, decision.errors.angle, describe(decision))
        return Step(self.twist, feedback, self._ending(decision, clearance, now, self.started, self.progress))

    def _ending(
        self, decision: Decision, clearance: float, now: float, started: float, progress: Progress
    ) -> Optional[Ending]:
        """The ending required by this decision, by lack of progress or by the goal's time limit; None to go on."""
        errors, elapsed = decision.errors, now - started
        where = f"{errors.position:.3f} m from the goal x {self.goal.x:.2f} y {self.goal.y:.2f} after {elapsed:.1f} s"
        if isinstance(decision, End) and decision.outcome is Outcome.REACHED:
            return Ending(Outcome.REACHED, where)
        if isinstance(decision, End):
            limit = f"limit {self.p.obstacle_distance:g} m"
            return Ending(decision.outcome, f"something is {clearance:.3f} m ahead, {limit}; {where}")
        idle = now - self.stalled - progress.since
        if idle > self.p.stuck_timeout:
            return Ending(Outcome.STUCK, f"no progress for {idle:.1f} s; {where}")
        if 0.0 < self.p.goal_timeout < elapsed:
            return Ending(Outcome.TIMEOUT, f"limit {self.p.goal_timeout:g} s; {where}")
        return None

    def stopped_early(self, outcome: Outcome, reason: str) -> Ending:
        """The ending of a goal that a client or a shutdown stops."""
        elapsed = 0.0 if self.started is None else max(0.0, rospy.get_rostime().to_sec() - self.started)
        return Ending(outcome, f"goal x {self.goal.x:.2f} y {self.goal.y:.2f} stopped after {elapsed:.1f} s: {reason}")


def describe(decision: Decision) -> str:
    """The feedback's message."""
    if isinstance(decision, Rotate):
        return f"rotating, {decision.errors.angle:.2f} rad to go"
    if isinstance(decision, MoveForward):
        return f"driving, {decision.errors.position:.2f} m to go"
    return decision.outcome.value.lower()
