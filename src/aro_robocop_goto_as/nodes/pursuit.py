"""One accepted goal on its way: tick by tick a velocity with feedback, in the end an ending."""

import threading
from dataclasses import dataclass
from typing import Optional

import ros_numpy
import rospy

from aro_robocop_goto_as.msg import GoToPositionFeedback, GoToPositionGoal

from .. import goto
from ..geometry import STANDSTILL
from ..goto import Decision, Drive, End, Goal, Outcome, Progress, Rotate
from ..params import GotoParams
from ..simtime import NANOSECONDS
from .senses import Senses

FARTHEST = 1e6  # [m] a goal beyond it is a mistake; feedback is in single precision


@dataclass(frozen=True)
class Ending:
    """How a goal ended, with the sentence for a person."""

    outcome: Outcome
    text: str

    @property
    def message(self) -> str:
        """The stable word, then the sentence."""
        return f"{self.outcome.value}: {self.text}"


class Pursuit:
    """The lab's loop for one goal, one iteration a call. Times are ROS times."""

    def __init__(self, message: GoToPositionGoal, p: GotoParams, senses: Senses) -> None:
        x, y, self.z = (float(value) for value in ros_numpy.numpify(message.position))
        self.goal = Goal(x, y)
        self.p = p
        self.senses = senses
        self.started: Optional[float] = None
        self.progress: Optional[Progress] = None
        self.twist = STANDSTILL
        self.feedback: Optional[GoToPositionFeedback] = None
        self.ending: Optional[Ending] = None
        self.ended = threading.Event()  # set by the control loop
        self.reported = threading.Event()  # set once the client has been told

    def refusal(self) -> Optional[Ending]:
        """The ending of a goal that can't even be begun."""
        if abs(self.goal.x) <= FARTHEST and abs(self.goal.y) <= FARTHEST:  # not so for NaN
            return None
        return Ending(Outcome.BAD_GOAL, f"position x {self.goal.x} y {self.goal.y}: expected finite numbers in metres, "
                                        f"{FARTHEST:g} at the most")

    def step(self, tick_ns: int) -> Optional[Ending]:
        """One iteration at a tick: an ending, or None with the velocity to command and the feedback to give."""
        self.feedback = None
        now = tick_ns / NANOSECONDS
        if self.started is None or now < self.started:  # just begun, or the clock was set back
            self.started, self.progress = now, None
        missing = self.senses.missing(now, self.started)
        if missing is not None:
            return Ending(*missing)
        sensed = self.senses.read()
        if sensed is None:
            return None
        pose, clearance = sensed
        decision = goto.decide(pose, clearance, self.goal, self.p)
        self.progress = goto.watch(self.progress, decision.errors, now, self.p)
        self.feedback = GoToPositionFeedback(decision.errors.position, decision.errors.angle, describe(decision))
        self.twist = goto.smoothed(self.twist, decision, 1.0 / self.p.control_rate, self.p)
        return self._ending(decision, clearance, now, self.started, self.progress)

    def _ending(self, decision: Decision, clearance: float, now: float, started: float,
                progress: Progress) -> Optional[Ending]:
        """The ending that this decision, the stuck watch or the goal's time-out calls for."""
        errors, elapsed = decision.errors, now - started
        short = f"{errors.position:.3f} m from the goal x {self.goal.x:.2f} y {self.goal.y:.2f} after {elapsed:.1f} s"
        if isinstance(decision, End) and decision.outcome is Outcome.REACHED:
            return Ending(Outcome.REACHED, short)
        if isinstance(decision, End):
            limit = f"limit {self.p.obstacle_distance:g} m"
            return Ending(decision.outcome, f"something is {clearance:.3f} m ahead, {limit}; {short}")
        if now - progress.since > self.p.stuck_timeout:
            return Ending(Outcome.STUCK, f"no nearer and not turned for {now - progress.since:.1f} s; {short}")
        if 0.0 < self.p.goal_timeout < elapsed:
            return Ending(Outcome.TIMEOUT, f"limit {self.p.goal_timeout:g} s; {short}")
        return None

    def given_up(self, outcome: Outcome, reason: str) -> Ending:
        """The ending of a goal that is not pursued any further."""
        elapsed = 0.0 if self.started is None else max(0.0, rospy.get_rostime().to_sec() - self.started)
        return Ending(outcome, f"goal x {self.goal.x:.2f} y {self.goal.y:.2f} given up after {elapsed:.1f} s, {reason}")


def describe(decision: Decision) -> str:
    """What the robot does now, for a person."""
    if isinstance(decision, Rotate):
        return f"rotating, {decision.errors.angle:.2f} rad to go"
    if isinstance(decision, Drive):
        return f"driving, {decision.errors.position:.2f} m to go"
    return decision.outcome.value.lower()
