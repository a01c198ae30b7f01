"""What a server with one mistake in its errors would report: each cause predicts the values of its feedback."""

import math
import re
from dataclasses import replace
from typing import Callable, List, NamedTuple, Tuple

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


class Cause(NamedTuple):
    """A mistake in words, and the values of position_error and of angle_error to which it may lead.

    `of_position`: the robot's or the goal's position is wrong, which explains both errors. `unchanged`: the errors are
    those of a pose that does not change.
    """

    sentence: str
    position: Tuple[Formula, ...] = ()
    angle: Tuple[Formula, ...] = ()
    of_position: bool = False
    unchanged: bool = False


def _misplaced(sentence: str, *poses: Callable[[Pair], Tuple[float, float]], unchanged: bool = False) -> Cause:
    """A pose of the goal or the robot that is mistaken for another, which leads to these errors."""

    def formulas(index: int) -> Tuple[Formula, ...]:
        return tuple(lambda pair, of=of: of(pair)[index] for of in poses)

    return Cause(sentence, formulas(POSITION), formulas(ANGLE), of_position=True, unchanged=unchanged)


POSE_OF_START = _misplaced(
    "The errors stay those of where the robot is when the goal comes: is the newest pose taken in each iteration, and "
    "does the callback of /odom store each pose at once?",
    lambda p: p.goal.errors_at(p.start),
    unchanged=True,
)
FROM_ORIGIN = Cause(
    "The goal's direction is that from odom's origin: is the robot's position left out, or read only at the start?",
    angle=(lambda p: math.atan2(p.goal.y, p.goal.x) - p.now.yaw,),
    of_position=True,
)
IN_DEGREES = Cause("The heading is in degrees, and is subtracted from an angle in radians")  # told by its changes
CAUSES = (
    _misplaced("The goal's x and y are swapped", lambda p: replace(p.goal, x=p.goal.y, y=p.goal.x).errors_at(p.now)),
    POSE_OF_START,
    _misplaced(
        "The goal is taken relative to the robot, where it is when the goal comes; goals are in odom",
        lambda p: p.misread(p.start.yaw),
        lambda p: p.misread(0.0),
    ),
    _misplaced(
        "The robot's pose is counted from where it was when the node started; goals are in odom: use the pose in /odom "
        "as it is",
        lambda p: p.counted(compose(inverse(p.started), Pose2D(p.now.x, p.now.y, p.now.yaw))),
        lambda p: p.counted(Pose2D(p.now.x - p.started.x, p.now.y - p.started.y, p.now.yaw - p.started.yaw)),
    ),
    _misplaced(
        "The robot's pose is taken in the world or map frame; goals are in odom",
        lambda p: p.goal.errors_at(Pose2D(p.now.world_x, p.now.world_y, p.now.world_yaw)),
    ),
    # Of position_error alone.
    Cause(
        "position_error is the goal's distance from odom's origin: is the robot's position left out, read only at the "
        "start, or not stored at once by the callback of /odom?",
        position=(lambda p: math.hypot(p.goal.x, p.goal.y),),
        of_position=True,
        unchanged=True,
    ),
    Cause(
        "position_error is the squared distance: the square root is missing",
        position=(lambda p: sum(d * d for d in p.way),),
    ),
    Cause("position_error is |dx|: is dy left out?", position=(lambda p: abs(p.way[0]),)),
    Cause("position_error is |dy|: is dx left out?", position=(lambda p: abs(p.way[1]),)),
    Cause("position_error is the angle error: are the two swapped?", position=(lambda p: p.truth[ANGLE],)),
    # Of angle_error alone.
    FROM_ORIGIN,
    Cause(
        "angle_error is the goal's direction in odom, as if the heading stayed 0: is the heading left out, read only "
        "at the start, calculated wrongly from the quaternion, whose order is x, y, z, w, or not stored at once by the"
        " callback of /odom?",
        angle=(lambda p: p.direction,),
        unchanged=True,
    ),
    Cause(
        "The goal's direction is that from where the robot is when the goal comes, or from odom's origin: calculate it"
        " in each iteration from the newest position",
        angle=(lambda p: wrapped(p.goal.errors_at(p.start)[ANGLE] + p.start.yaw - p.now.yaw),),
    ),
    Cause(
        "angle_error is in degrees; the handout wants radians",
        angle=(lambda p: math.degrees(p.truth[ANGLE]),),
    ),
    Cause(
        "angle_error has no sign: left and right can't be distinguished",
        angle=(lambda p: abs(p.truth[ANGLE]),),
    ),
    Cause(
        "The sign of angle_error is wrong: it has to be the goal's direction minus the heading",
        angle=(lambda p: -p.truth[ANGLE],),
    ),
    Cause(
        "The heading has no sign, as 2 * acos(w) has none: calculate it with atan2",
        angle=(lambda p: p.direction - abs(p.now.yaw),),
    ),
    Cause(
        "The sign of the heading is wrong, as if it were added instead of subtracted",
        angle=(lambda p: p.direction + p.now.yaw,),
    ),
    Cause(
        "The heading is as large as orientation.z, which is a component of the quaternion and not an angle",
        angle=(lambda p: p.direction - math.sin(wrapped(p.now.yaw) / 2.0),),
    ),
    Cause(
        "The goal's direction is that of atan2(dx, dy): it has to be atan2(dy, dx)",
        angle=(lambda p: math.atan2(*p.way) - p.now.yaw,),
    ),
    Cause(
        "A goal behind looks like one ahead, as with atan(dy / dx): atan2(dy, dx) is needed",
        angle=(lambda p: math.atan(p.way[1] / (p.way[0] or 1e-9)) - p.now.yaw,),
    ),
    Cause("angle_error is the distance: are the two swapped?", angle=(lambda p: p.truth[POSITION],)),
)
