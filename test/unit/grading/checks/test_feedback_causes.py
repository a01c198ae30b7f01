"""The formula that a server's feedback comes from is named as the cause of its wrong errors."""

import math
from dataclasses import replace

import pytest
from grading_records import GOAL, PLAN, RIGHT

from aro_robocop_goto_as.geometry import Pose2D, compose, inverse
from robocop_grading.judge import judge

MIRRORED = tuple(
    replace(at, y=-at.y, yaw=-at.yaw, world_y=-15.0 - at.world_y, world_yaw=at.world_yaw - 2.0 * at.yaw)
    for at in RIGHT.samples
)
DRIVES = {  # scenario: how the robot drives, and where its goal is
    "left": (RIGHT.samples, 1.0, 1.0),
    "right": (MIRRORED, 1.3, -0.9),
    "behind": (MIRRORED, -1.0, 0.3),
    "far": (RIGHT.samples, -0.7, -1.2),
}


class Seen:
    """What a server calculates its errors from."""

    def __init__(self, at, goal):
        self.at, self.goal, self.yaw = at, goal, at.yaw
        self.dx, self.dy = goal.x - at.x, goal.y - at.y
        self.direction = math.atan2(self.dy, self.dx)
        self.distance, self.angle = goal.errors_at(at)


def wrap(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


def fed_back(samples, goal, name, formula):
    """The feedback of a server with a wrong formula of one error."""
    seen = [Seen(at, goal) for at in samples]
    right = (replace(it, position_error=s.distance, angle_error=s.angle) for it, s in zip(RIGHT.feedback, seen))
    return [replace(it, **{name: formula(s)}) for it, s in zip(right, seen)]


POSITION = [
    (lambda s: s.dx**2 + s.dy**2, "position_error is the squared distance: the square root is missing"),
    (lambda s: abs(s.dx), "position_error is |dx|: is dy left out?"),
    (lambda s: abs(s.dy), "position_error is |dy|: is dx left out?"),
    (lambda s: math.hypot(s.goal.x, s.goal.y), "from odom's origin: is the robot's position left out"),
    (lambda s: math.hypot(s.goal.x - s.at.world_x, s.goal.y - s.at.world_y), "taken in the world or map frame"),
    (lambda s: math.hypot(s.goal.y - s.at.x, s.goal.x - s.at.y), "The goal's x and y are swapped"),
    (lambda s: s.angle, "position_error is the angle error: are the two swapped?"),
]
ANGLE = [
    (lambda s: s.direction, "is the heading left out, read only at the start, calculated wrongly from the quaternion"),
    (lambda s: wrap(s.direction + s.yaw), "as if it were added instead of subtracted"),
    (lambda s: wrap(s.direction - abs(s.yaw)), "The heading has no sign, as 2 * acos(w) has none"),
    (lambda s: wrap(s.direction - math.sin(s.yaw / 2.0)), "The heading is orientation.z, a part of the quaternion"),
    (lambda s: wrap(math.atan2(s.dx, s.dy) - s.yaw), "that of atan2(dx, dy): it has to be atan2(dy, dx)"),
    (lambda s: wrap(math.atan(s.dy / s.dx) - s.yaw), "A goal behind looks like one ahead: use atan2(dy, dx)"),
    (lambda s: -s.angle, "The sign of angle_error is wrong: it has to be the goal's direction minus the heading"),
    (lambda s: abs(s.angle), "angle_error has no sign: left and right can't be distinguished"),
    (lambda s: math.degrees(s.angle), "degrees"),
    (lambda s: s.direction - s.yaw, "angle_error is not wrapped: 3.2 rad"),
    (lambda s: wrap(math.atan2(s.goal.y, s.goal.x) - s.yaw), "The errors are those from odom's origin"),
]


def judged(feedback, **fields):
    """The results by check of a server that gives this feedback on its drives; `fields` are those of the first one."""
    records = {}
    for name, (samples, x, y) in DRIVES.items():
        goal = replace(GOAL, x=x, y=y)
        told = tuple(feedback(samples, goal))
        records[name] = replace(RIGHT, name=name, goals=(goal,), samples=samples, feedback=told)
    records["left"] = replace(records["left"], **fields)
    return {check.name: check for check in judge("anna", PLAN, {"server": records}, {}).checks}


FORMULAS = [("position", *row) for row in POSITION] + [("angle", *row) for row in ANGLE]


@pytest.mark.parametrize("error, formula, words", FORMULAS, ids=[words for _, _, words in FORMULAS])
def test_cause_of_wrong_errors_is_the_formula_that_leads_to_them(error, formula, words):
    checks = judged(lambda samples, goal: fed_back(samples, goal, f"{error}_error", formula))
    wrong, right = checks[f"feedback_{error}"], checks[f"feedback_{'angle' if error == 'position' else 'position'}"]
    assert wrong.failure is not None and words in wrong.failure.cause
    assert right.failure is None


@pytest.mark.parametrize(
    "shown, age",
    [
        pytest.param(lambda number: number - number % 2, 0.1, id="each sent twice"),
        pytest.param(lambda number: number - number % 4, 0.3, id="each sent four times"),
        pytest.param(lambda number: number - number % 10, 0.9, id="each sent ten times"),
        pytest.param(lambda number: max(0, number - 1), 0.1, id="0.1 s"),
        pytest.param(lambda number: max(0, number - 10), 1.0, id="1 s"),
        pytest.param(lambda number: max(0, number - 20), 2.0, id="2 s"),
    ],
)
def test_errors_of_an_old_pose_are_one_mistake_that_is_named(shown, age):
    def feedback(samples, goal):
        right = fed_back(samples, goal, "position_error", lambda seen: seen.distance)
        return [replace(right[shown(number)], time=it.time) for number, it in enumerate(right)]

    checks = judged(feedback)
    failure, angle = checks["feedback_position"].failure, checks["feedback_angle"]
    assert failure is not None and f"The feedback is old, by up to {age} s" in failure.cause
    assert angle.failure is None or angle.follows == "feedback_position"


def test_pose_counted_from_the_start_of_the_node_is_named():
    started = Pose2D(0.4, 0.1, 0.6)

    def feedback(samples, goal):
        first = started if samples is RIGHT.samples and goal.x == 1.0 else Pose2D()
        poses = [compose(inverse(first), Pose2D(at.x, at.y, at.yaw)) for at in samples]
        errors = [goal.errors_at(pose) for pose in poses]
        return [replace(it, position_error=d, angle_error=a) for it, (d, a) in zip(RIGHT.feedback, errors)]

    checks = judged(feedback, started=started)
    failure = checks["feedback_position"].failure
    assert failure is not None and "counted from where it was when the node started" in failure.cause
    assert checks["feedback_angle"].follows == "feedback_position"
