"""One goal from its acceptance to its end: the handout's rule, and all other reasons why a goal can end."""

import time
from dataclasses import dataclass
from typing import Optional

import ros_numpy

from aro_robocop_goto_as.msg import GoToPositionFeedback, GoToPositionGoal

from ...geometry import MAX_COORDINATE, Pose2D, Twist2D
from ...goto.params import GotoParams
from ...goto.rule import Decision, EndGoal, Goal, MoveForward, Outcome, Pursuit, Rotate, step
from ...names import position_text
from .inputs import Inputs


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
    """The state of a goal from one control period to the next. Times are ROS times [s] unless marked wall."""

    def __init__(self, message: GoToPositionGoal, inputs: Inputs) -> None:
        x, y, _ = (float(value) for value in ros_numpy.numpify(message.position))
        self.goal = Goal(x, y)
        self.outcome: Optional[Outcome] = None  # once the goal has ended
        self.accepted = time.monotonic()  # [s, wall]
        self.started: Optional[float] = None  # time of the first control period
        self._inputs = inputs
        self._now = 0.0  # time of the newest control period
        self._pursuit = Pursuit()

    def refusal(self) -> Optional[Ending]:
        """The ending of a goal that is not a position in reach; None for a valid goal."""
        if abs(self.goal.x) <= MAX_COORDINATE and abs(self.goal.y) <= MAX_COORDINATE:  # false for NaN
            return None
        return Ending(
            Outcome.BAD_GOAL,
            f"position x {self.goal.x} y {self.goal.y}: expected finite numbers in metres, at most {MAX_COORDINATE:g}",
        )

    def begin_period(self, now: float) -> float:
        """Note that a control period begins; returns when the first one began."""
        if self.started is None:
            self.started = now
        self._now = now
        return self.started

    @property
    def twist(self) -> Twist2D:
        """The velocity to command in this control period."""
        return self._pursuit.twist

    def decide(self, pose: Pose2D, clearance: float, p: GotoParams) -> Decision:
        """Rotate, drive or end: sets `twist`."""
        decision, self._pursuit = step(self._pursuit, pose, clearance, self.goal, self._now, p)
        return decision

    def ending(self, decision: Decision, clearance: float, p: GotoParams) -> Optional[Ending]:
        """How the goal ends by the decision, without progress, or at its timeout; None to go on."""
        elapsed = self._elapsed()
        without_progress = self._pursuit.without_progress(self._now)
        where = f"{decision.errors.position:.3f} m from the goal {self.where()} after {elapsed:.1f} s"
        if isinstance(decision, EndGoal) and decision.outcome is Outcome.REACHED:
            return Ending(Outcome.REACHED, where)
        if isinstance(decision, EndGoal):
            obstacle = f"obstacle {clearance:.3f} m ahead (limit {p.obstacle_distance:g} m)"
            return Ending(decision.outcome, f"{obstacle}; {where}")
        if without_progress > p.stuck_timeout:
            return Ending(Outcome.STUCK, f"no progress for {without_progress:.1f} s; {where}")
        if 0.0 < p.goal_timeout < elapsed:
            return Ending(Outcome.TIMEOUT, f"not reached within {p.goal_timeout:g} s; {where}")
        return None

    def stopped_early(self, outcome: Outcome, reason: str) -> Ending:
        """The ending of a goal that a client or a shutdown stops."""
        return Ending(outcome, f"goal {self.where()} stopped after {self._elapsed():.1f} s: {reason}")

    def _elapsed(self) -> float:
        return 0.0 if self.started is None else self._now - self.started

    def where(self) -> str:
        """The goal's position in words, with odometry's frame once that is known."""
        x, y, odom = self.goal.x, self.goal.y, self._inputs.odom
        return f"x {x:.2f} y {y:.2f}" if odom is None else position_text(x, y, odom.message.header.frame_id)


def feedback_of(decision: Decision) -> GoToPositionFeedback:
    """The handout's feedback: the two errors, and what the robot does in words."""
    errors = decision.errors
    if isinstance(decision, Rotate):
        text = f"rotating, {errors.angle:.2f} rad to go"
    elif isinstance(decision, MoveForward):
        text = f"driving, {errors.position:.2f} m to go"
    else:
        text = decision.outcome.value.lower()
    return GoToPositionFeedback(errors.position, errors.angle, text)
