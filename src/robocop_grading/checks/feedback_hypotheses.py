"""What a server with one mistake in its errors would report: each cause predicts the values of its feedback."""

import itertools
import math
import re
from dataclasses import replace
from typing import Callable, Dict, List, NamedTuple, Tuple

from aro_robocop_goto_as.geometry import Pose2D, compose, inverse

from ..record import Feedback, Sample, SentGoal, wrapped

POSITION, ANGLE = range(2)  # indices of ERRORS
UNSURE = 0.3  # [m] nearer to where the goal is taken to be, an inexact position turns its direction too much
POSE_TOPIC = re.compile("odom|pose|truth|position")  # in the name of a topic


class Pair(NamedTuple):
    """A feedback message, the samples that it may be based on, its goal, and the sample when the goal was sent.

    `started`: odom_from_footprint when the node was started.
    """

    feedback: Feedback
    samples: List[Sample]
    goal: SentGoal
    start: Sample
    started: Pose2D = Pose2D()

    @property
    def now(self) -> Sample:
        """The newest sample."""
        return self.samples[-1]

    @property
    def truth(self) -> Tuple[float, float]:
        """Both true errors."""
        return self.goal.errors_at(self.now)

    @property
    def way(self) -> Tuple[float, float]:
        """From the robot to the goal, in odom [m]."""
        return self.goal.x - self.now.x, self.goal.y - self.now.y

    @property
    def yaw(self) -> float:
        """The heading in odom [rad], within +-pi."""
        return wrapped(self.now.yaw)

    @property
    def direction(self) -> float:
        """The goal's direction in odom [rad]."""
        return math.atan2(self.way[1], self.way[0])

    def misread(self, yaw: float) -> Tuple[float, float]:
        """Both errors for a goal that is taken relative to the robot, in a frame turned by `yaw`, when it was sent."""
        there = compose(Pose2D(self.start.x, self.start.y, yaw), Pose2D(self.goal.x, self.goal.y))
        return replace(self.goal, x=there.x, y=there.y).errors_at(self.now)

    def counted(self, pose: Pose2D) -> Tuple[float, float]:
        """Both errors at a pose that is counted from where the node was started."""
        distance, angle = self.goal.errors_at(pose)
        return distance, self.feedback.angle_error if distance < UNSURE else angle


Formula = Callable[[Pair], float]
Errors = Callable[[Pair], Tuple[float, float]]


class Cause(NamedTuple):
    """A mistake in words, and the values of position_error or angle_error, as `of` says, to which it leads.

    `unchanged`: the errors are those of a pose that does not change.
    """

    sentence: str
    of: int  # POSITION or ANGLE
    formula: Formula
    unchanged: bool = False


def _misplaced(sentence: str, *poses: Errors, unchanged: bool = False) -> List[Cause]:
    """Of poses of the goal or the robot that are mistaken for others, each of which leads to both errors."""

    def error(index: int, errors: Errors) -> Formula:
        return lambda pair: errors(pair)[index]

    both = itertools.product((POSITION, ANGLE), poses)
    return [Cause(sentence, index, error(index, errors), unchanged) for index, errors in both]


POSE_OF_START = (
    "The errors stay those of where the robot is when the goal comes: is the newest pose taken in each iteration, and "
    "does the callback of /odom store each pose at once?"
)
POSITION_LEFT_OUT = (
    "The errors are those from odom's origin: is the robot's position left out, read only at the start, or not stored "
    "at once by the callback of /odom?"
)
DIRECTION_ONCE = (
    "The goal's direction is that from where the robot is when the goal comes: calculate it in each iteration from the "
    "newest position"
)
NO_HEADING = (
    "angle_error is the goal's direction in odom, as if the heading stayed 0: is the heading left out, read only at "
    "the start, calculated wrongly from the quaternion, whose order is x, y, z, w, or not stored at once by the "
    "callback of /odom?"
)
OF_POSITION: Dict[str, Formula] = {
    "position_error is the squared distance: the square root is missing": lambda p: sum(d * d for d in p.way),
    "position_error is |dx|: is dy left out?": lambda p: abs(p.way[0]),
    "position_error is |dy|: is dx left out?": lambda p: abs(p.way[1]),
    "position_error is the angle error: are the two swapped?": lambda p: p.truth[ANGLE],
}
OF_ANGLE: Dict[str, Formula] = {
    "angle_error is the distance: are the two swapped?": lambda p: p.truth[POSITION],
    "angle_error is in degrees; the handout wants radians": lambda p: math.degrees(p.truth[ANGLE]),
    "angle_error has no sign: left and right can't be distinguished": lambda p: abs(p.truth[ANGLE]),
    "The sign of angle_error is wrong: it has to be the goal's direction minus the heading": lambda p: -p.truth[ANGLE],
    "The heading has no sign, as 2 * acos(w) has none: calculate it with atan2": lambda p: p.direction - abs(p.yaw),
    "The sign of the heading is wrong, as if it were added instead of subtracted": lambda p: p.direction + p.yaw,
    "The heading is orientation.z, a part of the quaternion": lambda p: p.direction - math.sin(p.yaw / 2.0),
    "The goal's direction is that of atan2(dx, dy): it has to be atan2(dy, dx)": lambda p: math.atan2(*p.way) - p.yaw,
    "A goal behind looks like one ahead: use atan2(dy, dx), not atan(dy / dx)": lambda p: _half_turned(p) - p.yaw,
}


def _half_turned(pair: Pair) -> float:
    return math.atan(pair.way[1] / (pair.way[0] or 1e-9))


CAUSES: Tuple[Cause, ...] = (
    *_misplaced("The goal's x and y are swapped", lambda p: replace(p.goal, x=p.goal.y, y=p.goal.x).errors_at(p.now)),
    *_misplaced(POSE_OF_START, lambda p: p.goal.errors_at(p.start), unchanged=True),
    *_misplaced(
        "The goal is taken relative to the robot, where it is when the goal comes; goals are in odom",
        lambda p: p.misread(p.start.yaw),
        lambda p: p.misread(0.0),
    ),
    *_misplaced(
        "The robot's pose is counted from where it was when the node started; goals are in odom: use the pose in /odom "
        "as it is",
        lambda p: p.counted(compose(inverse(p.started), Pose2D(p.now.x, p.now.y, p.now.yaw))),
        lambda p: p.counted(Pose2D(p.now.x - p.started.x, p.now.y - p.started.y, p.now.yaw - p.started.yaw)),
    ),
    *_misplaced(
        "The robot's pose is taken in the world or map frame; goals are in odom",
        lambda p: p.goal.errors_at(Pose2D(p.now.world_x, p.now.world_y, p.now.world_yaw)),
    ),
    *_misplaced(POSITION_LEFT_OUT, lambda p: p.goal.errors_at(Pose2D(0.0, 0.0, p.yaw)), unchanged=True),
    Cause(DIRECTION_ONCE, ANGLE, lambda p: p.goal.errors_at(p.start)[ANGLE] + p.start.yaw - p.yaw),
    Cause(NO_HEADING, ANGLE, lambda p: p.direction, unchanged=True),
    *(Cause(sentence, POSITION, formula) for sentence, formula in OF_POSITION.items()),
    *(Cause(sentence, ANGLE, formula) for sentence, formula in OF_ANGLE.items()),
)
