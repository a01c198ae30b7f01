"""What a server with one mistake in its errors would report: each hypothesis predicts the values of its feedback."""

import math
import re
from dataclasses import replace
from typing import Callable, List, NamedTuple, Sequence, Tuple

from aro_robocop_goto_as.geometry import Pose2D, compose, inverse

from ..record import Feedback, Sample, SentGoal, wrapped

POSITION, ANGLE = range(2)  # indices of ERRORS
IN_DEGREES = "heading_in_degrees"
UNSURE = 0.3  # [m] nearer to where the goal is taken to be, an inexact position turns its direction too much


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


SENTENCES = {  # of causes, by their names
    "since_start_of_node": (
        "The robot's pose is counted from where it was when the node started; goals are in odom: use the pose in /odom "
        "as it is"
    ),
    "distance_ahead": (
        "position_error is only the part of the way that is along the robot's heading: it is the whole distance, "
        "hypot(dx, dy)"
    ),
    IN_DEGREES: "The heading is in degrees, and is subtracted from an angle in radians",
    "goal_swapped": "The goal's x and y are swapped",
    "goal_x_missing": "The goal's x is taken as 0",
    "goal_y_missing": "The goal's y is taken as 0",
    "position_swapped": "The x and y of the robot's position are swapped",
    "position_x_sign": "The sign of the robot's x is wrong",
    "position_y_sign": "The sign of the robot's y is wrong",
    "pose_of_start": (
        "The errors stay those of where the robot is when the goal comes: is the newest pose taken in each iteration, "
        "and does the callback of /odom store each pose at once?"
    ),
    "relative": "The goal is taken relative to the robot, where it is when the goal comes; goals are in odom",
    "angle_from_origin": (
        "The goal's direction is that from odom's origin: is the robot's position left out, or read only at the start?"
    ),
    "position_in_world": "The robot's position is taken in the world or map frame; goals are in odom",
    "distance_from_origin": (
        "position_error is the goal's distance from odom's origin: is the robot's position left out, read only at the "
        "start, or not stored at once by the callback of /odom?"
    ),
    "distance_squared": "position_error is the squared distance: the square root is missing",
    "distance_x_only": "position_error is |dx|: is dy left out?",
    "distance_y_only": "position_error is |dy|: is dx left out?",
    "distance_manhattan": "position_error is |dx| + |dy| instead of the straight-line distance",
    "distance_larger": "position_error is the larger one of |dx| and |dy| instead of the straight-line distance",
    "distance_sign": "The sign of position_error is wrong",
    "distance_rounded": "position_error is rounded to a whole number",
    "distance_is_angle": "position_error is the angle error: are the two swapped?",
    "angle_in_degrees": "angle_error is in degrees; the handout wants radians",
    "angle_without_sign": "angle_error has no sign: left and right can't be distinguished",
    "angle_sign": "The sign of angle_error is wrong: it has to be the goal's direction minus the heading",
    "angle_without_heading": (
        "angle_error is the goal's direction in odom, as if the heading stayed 0: is the heading left out, read only "
        "at the start, calculated wrongly from the quaternion, whose order is x, y, z, w, or not stored at once by the"
        " callback of /odom?"
    ),
    "heading_without_sign": "The heading has no sign, as 2 * acos(w) has none: calculate it with atan2",
    "heading_added": "The sign of the heading is wrong, as if it were added instead of subtracted",
    "atan2_swapped": "The goal's direction is that of atan2(dx, dy): it has to be atan2(dy, dx)",
    "atan": "A goal behind looks like one ahead, as with atan(dy / dx): atan2(dy, dx) is needed",
    "asin": "The sign of dx has no effect, as with asin(dy / distance): atan2(dy, dx) is needed",
    "modulo_pi": "angle_error is taken modulo pi; a turn is 2 * pi",
    "direction_signs": (
        "The goal's direction is as if a sign were wrong in atan2(dy, dx): dx and dy are the goal's position minus the"
        " robot's"
    ),
    "heading_from_z": (
        "The heading is as large as orientation.z, which is a component of the quaternion and not an angle"
    ),
    "heading_halved": "The heading is half of the true one: its factor 2 is missing",
    "heading_in_world": "The heading is taken in the world or map frame; goals are in odom",
    "angle_rounded": "angle_error is rounded to a whole number",
    "angle_is_distance": "angle_error is the distance: are the two swapped?",
    "direction_once": (
        "The goal's direction is that from where the robot is when the goal comes, or from odom's origin: calculate it"
        " in each iteration from the newest position"
    ),
}

Hypothesis = Tuple[str, Callable[[Pair], float]]  # name of the cause; the value that it would lead to


def _since_start(pair: Pair, index: int, is_turned: bool) -> float:
    """An error for a pose that is counted from where the node was started, also in the heading of then or not."""
    now, first = Pose2D(pair.now.x, pair.now.y, pair.now.yaw), pair.started
    counted = (
        compose(inverse(first), now) if is_turned else Pose2D(now.x - first.x, now.y - first.y, now.yaw - first.yaw)
    )
    errors = pair.goal.errors_at(counted)
    is_unsure = index == ANGLE and errors[POSITION] < UNSURE
    return pair.feedback.angle_error if is_unsure else errors[index]


def _misplaced(index: int) -> Sequence[Hypothesis]:
    """Poses of the goal or the robot that are mistaken for others."""
    return (
        ("goal_swapped", lambda p: replace(p.goal, x=p.goal.y, y=p.goal.x).errors_at(p.now)[index]),
        ("goal_x_missing", lambda p: replace(p.goal, x=0.0).errors_at(p.now)[index]),
        ("goal_y_missing", lambda p: replace(p.goal, y=0.0).errors_at(p.now)[index]),
        ("position_swapped", lambda p: p.goal.errors_at(Pose2D(p.now.y, p.now.x, p.now.yaw))[index]),
        ("position_x_sign", lambda p: p.goal.errors_at(Pose2D(-p.now.x, p.now.y, p.now.yaw))[index]),
        ("position_y_sign", lambda p: p.goal.errors_at(Pose2D(p.now.x, -p.now.y, p.now.yaw))[index]),
        ("pose_of_start", lambda p: p.goal.errors_at(p.start)[index]),
        ("relative", lambda p: p.misread(p.start.yaw)[index]),
        ("relative", lambda p: p.misread(0.0)[index]),
        ("since_start_of_node", lambda p: _since_start(p, index, True)),
        ("since_start_of_node", lambda p: _since_start(p, index, False)),
    )


FROM_ORIGIN = "angle_from_origin"
# Causes that explain both errors: the robot's or the goal's position is wrong.
OF_POSITION = {"distance_from_origin", FROM_ORIGIN, "position_in_world", "heading_in_world"}
OF_POSITION |= {name for name, _ in _misplaced(POSITION)}
# Causes of which the errors are those of a pose that does not change.
UNCHANGED = {"distance_from_origin", "angle_without_heading", "pose_of_start"}
POSE_TOPIC = re.compile("odom|pose|truth|position")  # in the name of a topic
CAUSES: Tuple[Sequence[Hypothesis], ...] = (
    (
        *_misplaced(POSITION),
        ("position_in_world", lambda p: math.hypot(p.goal.x - p.now.world_x, p.goal.y - p.now.world_y)),
        ("distance_from_origin", lambda p: math.hypot(p.goal.x, p.goal.y)),
        ("distance_squared", lambda p: sum(d * d for d in p.way)),
        ("distance_x_only", lambda p: abs(p.way[0])),
        ("distance_y_only", lambda p: abs(p.way[1])),
        ("distance_manhattan", lambda p: sum(abs(d) for d in p.way)),
        ("distance_larger", lambda p: max(abs(d) for d in p.way)),
        ("distance_ahead", lambda p: p.truth[POSITION] * math.cos(p.truth[ANGLE])),
        ("distance_ahead", lambda p: abs(p.truth[POSITION] * math.cos(p.truth[ANGLE]))),
        ("distance_sign", lambda p: -p.truth[POSITION]),
        ("distance_rounded", lambda p: round(p.truth[POSITION])),
        ("distance_rounded", lambda p: int(p.truth[POSITION])),
        ("distance_is_angle", lambda p: p.truth[ANGLE]),
    ),
    (
        *_misplaced(ANGLE),
        ("angle_in_degrees", lambda p: math.degrees(p.truth[ANGLE])),
        ("angle_without_sign", lambda p: abs(p.truth[ANGLE])),
        ("angle_sign", lambda p: -p.truth[ANGLE]),
        ("angle_without_heading", lambda p: p.direction),
        ("heading_without_sign", lambda p: p.direction - abs(p.now.yaw)),
        ("heading_added", lambda p: p.direction + p.now.yaw),
        ("atan2_swapped", lambda p: math.atan2(*p.way) - p.now.yaw),
        ("atan", lambda p: math.atan(p.way[1] / (p.way[0] or 1e-9)) - p.now.yaw),
        ("asin", lambda p: math.atan2(p.way[1], abs(p.way[0])) - p.now.yaw),
        ("modulo_pi", lambda p: (p.truth[ANGLE] + math.pi / 2.0) % math.pi - math.pi / 2.0),
        ("modulo_pi", lambda p: p.truth[ANGLE] % math.pi),
        ("modulo_pi", lambda p: math.fmod(p.direction - wrapped(p.now.yaw), math.pi)),
        ("direction_signs", lambda p: math.atan2(-p.way[1], p.way[0]) - p.now.yaw),
        ("direction_signs", lambda p: math.atan2(p.way[1], -p.way[0]) - p.now.yaw),
        ("direction_signs", lambda p: math.atan2(-p.way[1], -p.way[0]) - p.now.yaw),
        ("heading_from_z", lambda p: p.direction - math.sin(wrapped(p.now.yaw) / 2.0)),
        ("heading_halved", lambda p: p.direction - wrapped(p.now.yaw) / 2.0),
        (
            "heading_in_world",
            lambda p: math.atan2(p.goal.y - p.now.world_y, p.goal.x - p.now.world_x) - p.now.world_yaw,
        ),
        (FROM_ORIGIN, lambda p: math.atan2(p.goal.y, p.goal.x) - p.now.yaw),
        ("angle_rounded", lambda p: round(p.truth[ANGLE])),
        ("angle_rounded", lambda p: int(p.truth[ANGLE])),
        ("angle_is_distance", lambda p: p.truth[POSITION]),
        ("direction_once", lambda p: wrapped(p.goal.errors_at(p.start)[ANGLE] + p.start.yaw - p.now.yaw)),
    ),
)
