"""Checks of the robot's motion: turn towards the goal, drive straight, arrive."""

import math
from dataclasses import replace
from typing import Any, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from ..handout import GOAL_RADIUS, HEADING_TOLERANCE, Limits
from ..record import (
    SUCCEEDED,
    Command,
    Goal,
    Record,
    Sample,
    active_until,
    errors_at,
    feedback_of,
    samples_between,
    wrapped,
)
from ..texts import text
from .consequences import (
    AT_FIRST,
    ENDING,
    EXCEPTION,
    ITERATION,
    MISLED,
    MOVES_FIRST,
    SUCCESS_LATE,
    alike,
    died_before,
    nothing_came,
)
from .endings import of_goals, success_too_far, wrong_ending
from .topic_types import wrong_type
from .verdict import PASSED, After, Failed, NotReached, Verdict, check

WINDOW = 0.45  # [s] the angle error has to stay within a range for this long before a command is judged by it
NEAR = 0.2  # [m] closer than this, the direction to the goal changes fast
MAX_WRONG = 0.1  # share of wrong commands that is allowed for transitions
LONG_IDLE = 10  # commands that neither turn nor drive near the right heading; more are wrong whatever the threshold
ENOUGH = 4  # fewer commands are not judged
LATE = 0.22  # [s] from the true arrival to the success: a loop's period, one of odometry and one of the recording
LATE_AT_REST = 1.0  # [s] likewise of a robot that stands at the goal meanwhile
LARGE_TURN = 0.5  # [rad] of a robot at the goal
MIN_SPEED = 1e-3  # [m/s], [rad/s] slower commands are none
AT_ONCE = 2.0  # [s] from a goal that is reached already to its success
LONG_TURN = "a long turn"
TURN = f"{HEADING_TOLERANCE:g} rad"
NOT_DRIVING = f"linear.x 0 while angle_error is beyond {TURN}"


class Situation(NamedTuple):
    """The command in force at a sample's time, and the true angle error [rad]."""

    command: Command
    angle: float


def _in_force(record: Record) -> Iterator[Command]:
    """For each sample the newest command before it: /cmd_vel stays in force until the next message."""
    number, newest = 0, None
    for sample in record.samples:
        while number < len(record.commands) and record.commands[number].time <= sample.time + 1e-6:
            newest = record.commands[number]
            number += 1
        if newest is not None:
            yield replace(newest, time=sample.time)


def _situations(record: Record, goal: Goal, low: float, high: float) -> List[Situation]:
    """Commands sent far from the goal, after |angle error| was within [low, high] for a WINDOW."""
    end = active_until(record, goal) - 1e-6
    situations = []
    for command in _in_force(record):
        if not goal.time + WINDOW < command.time < end:
            continue
        errors = [errors_at(sample, goal) for sample in samples_between(record, command.time - WINDOW, command.time)]
        if len(errors) >= 4 and all(low <= abs(angle) <= high and distance > NEAR for distance, angle in errors):
            situations.append(Situation(command, errors[-1][1]))
    return situations


NO_NODE = After("stays_alive", died_before)


@check(
    "speeds",
    after=(EXCEPTION, MISLED, After("reaches_goal", nothing_came), AT_FIRST, NO_NODE),
    needs=("reaches_goal",),
)
def turns_to_goal(record: Record, limits: Limits) -> Verdict:
    """While angle_error is beyond 0.1 rad the robot turns towards the goal without driving."""
    judged = False
    for goal in record.goals:
        situations = _situations(record, goal, limits.turn_beyond, math.pi)
        problem = _never_turned(record, goal, limits)
        if problem is None and len(situations) >= ENOUGH:
            judged = True
            problem = _moves_first(record, goal, situations, limits) or _wrong_turn(
                situations, limits, _aligned_before(record, goal, limits)
            )
        if problem is not None:
            return replace(problem, goal=goal)
    return PASSED if judged else NotReached("no command was given while angle_error was large")


def _moves_first(record: Record, goal: Goal, situations: Sequence[Situation], limits: Limits) -> Optional[Failed]:
    """A robot that drives off when the goal comes, and then turns as it should."""
    first = next((command for command in record.commands if command.time >= goal.time - 1e-6), None)
    driving = [abs(it.command.v) > limits.driving for it in situations]
    at_first = driving.index(False) if False in driving else len(driving)
    if first is None or abs(first.v) <= limits.driving or not 0 < at_first < len(driving) or any(driving[at_first:]):
        return None
    seen = f"linear.x {first.v:.2f} at {situations[0].angle:.2f} rad"
    return Failed(NOT_DRIVING, seen, first.time, text("moves_first"), MOVES_FIRST)


def _aligned_before(record: Record, goal: Goal, limits: Limits) -> float:
    """Since when [s] the robot has once headed for the goal; infinity if it has not."""
    errors = ((sample.time, errors_at(sample, goal)[1]) for sample in samples_between(record, goal.time, math.inf))
    return next((time for time, angle in errors if abs(angle) < limits.turn_beyond), math.inf)


def _wrong_turn(situations: Sequence[Situation], limits: Limits, aligned: float) -> Optional[Failed]:
    driving = [it for it in situations if abs(it.command.v) > limits.driving]
    if len(driving) > MAX_WRONG * len(situations):
        command, angle = driving[0]
        cause = text("drives_while_turning")
        if sum(abs(it.command.w) < 1e-3 for it in driving) > 0.5 * len(driving):
            cause = text("no_correction" if command.time > aligned else "drives_straight_at", angle, TURN)
        seen = f"linear.x {command.v:.2f} at {angle:.2f} rad"
        return Failed(NOT_DRIVING, seen, command.time, cause)
    still = [it for it in situations if abs(it.command.w) < 1e-3]
    if len(still) > 0.5 * len(situations):
        command, angle = still[0]
        cause = text("never_turned", angle, "angular.z stayed 0")
        if len(still) < len(situations):
            cause = text("stands_before_turn", angle)
        return Failed("angular.z towards the goal", "angular.z 0", command.time, cause)
    wrong = [it for it in situations if it.command.w * it.angle < 0.0]
    away = [it for it in wrong if abs(it.angle) < math.pi - 0.2]  # beyond, a right command may be of the other side
    if len(away) > 0.15 * len(situations) or len(wrong) > 0.5 * len(situations):
        command, angle = (away or wrong)[0]
        wanted = "angular.z above 0" if angle > 0 else "angular.z below 0"
        cause = text("turns_away_behind" if abs(angle) > math.pi / 2.0 else "turns_away", angle)
        return Failed(wanted, f"angular.z {command.w:.2f}", command.time, cause)
    return None


def _never_turned(record: Record, goal: Goal, limits: Limits) -> Optional[Failed]:
    """A robot that did not head for the goal and got no command to turn."""
    end = active_until(record, goal)
    start = samples_between(record, goal.time, goal.time)
    if not start or end - goal.time < 1.0:
        return None
    distance, angle = errors_at(start[-1], goal)
    commands = [command for command in record.commands if goal.time <= command.time <= end]
    if distance > NEAR and abs(angle) > limits.turn_beyond and not any(abs(command.w) > 1e-3 for command in commands):
        reason = "angular.z stayed 0" if commands else "nothing was published on /cmd_vel"
        cause = wrong_type(record, "/cmd_vel") or text("never_turned", angle, reason)
        return Failed("angular.z towards the goal", "no command to turn", goal.time, cause, "unturned")
    return None


@check("speeds", after=(MISLED,), needs=("turns_to_goal", "reaches_goal"))
def drives_straight(record: Record, limits: Limits) -> Verdict:
    """While angle_error is within 0.1 rad the robot drives straight ahead."""
    judged = False
    for goal in record.goals:
        aligned = _situations(record, goal, 0.0, limits.straight_within)
        nearly = _situations(record, goal, 0.0, limits.turn_beyond)
        moving = [it for it in nearly if abs(it.command.v) > MIN_SPEED]
        driving = [it for it in moving if abs(it.command.v) > limits.driving] or moving
        idle = [it for it in nearly if abs(it.command.v) <= MIN_SPEED and abs(it.command.w) <= MIN_SPEED]
        if max(len(aligned), len(driving), len(idle) - LONG_IDLE) < ENOUGH:
            continue
        judged = True
        problem = _not_forward(aligned if len(idle) < LONG_IDLE else idle, driving) or _curves(driving, limits)
        if problem is not None:
            return replace(problem, goal=goal)
    return PASSED if judged else NotReached("the robot did not head for the goal for long enough")


def _not_forward(aligned: Sequence[Situation], driving: Sequence[Situation]) -> Optional[Failed]:
    """A robot that drives backward, or does not move although it faces the goal."""
    backward = [it for it in driving if it.command.v < 0.0]
    standing = [it for it in aligned if abs(it.command.v) <= 1e-3]
    for wrong, situations, seen, cause in (
        (backward, driving, "below 0", text("drives_backward")),
        (standing, aligned, "0", text("stands", TURN)),
    ):
        if len(situations) >= ENOUGH and len(wrong) > 0.3 * len(situations):
            command, angle = wrong[0]
            return Failed("linear.x above 0", f"linear.x {seen} at {angle:.2f} rad", command.time, cause)
    return None


def _curves(driving: Sequence[Situation], limits: Limits) -> Optional[Failed]:
    """A robot that drives along a curve; gentle corrections towards the goal are allowed."""
    curves = [
        it
        for it in driving
        if abs(it.command.w) > limits.straight_turn
        or (abs(it.command.w) > 0.1 and it.command.w * it.angle < 0.0 and abs(it.angle) > 0.03)
    ]
    if len(driving) < ENOUGH or len(curves) <= 0.2 * len(driving):
        return None
    command, angle = curves[0]
    seen = f"angular.z {command.w:.2f} at {angle:.2f} rad"
    return Failed("angular.z near 0", seen, command.time, text("curves"))


@check("track", after=ENDING, needs=("reaches_goal", "stays_alive"))
def reaches_goal(record: Record, limits: Limits) -> Verdict:
    """The goal succeeds when the robot is closer than 0.1 m, and not before."""
    return of_goals(
        record, lambda goal: _wrong_success(record, goal, limits) or _success_too_late(record, goal, limits)
    )


def _wrong_success(record: Record, goal: Goal, limits: Limits) -> Optional[Failed]:
    """What went wrong with a goal that did not succeed, or not at its position."""
    return wrong_ending(record, goal, SUCCEEDED, limits) or success_too_far(record, goal, limits)


def _success_too_late(record: Record, goal: Goal, limits: Limits) -> Optional[Failed]:
    """A robot that drives on although it has come close enough for success."""
    end = active_until(record, goal)
    way = [(sample.time, errors_at(sample, goal)[0]) for sample in samples_between(record, goal.time, end)]
    for (before, far), (after, near) in zip(way, way[1:]):
        if near < GOAL_RADIUS <= far:
            reached = before + (after - before) * (far - GOAL_RADIUS) / (far - near)
            name, *values = _lateness(record, goal, samples_between(record, reached + LATE, end), limits)
            least = min(distance for _, distance in way)
            exact = name in ("waits_at_goal", "turns_at_goal") or least < 2.0 * GOAL_RADIUS - limits.reached
            if end - reached <= (LATE_AT_REST if name == "waits_at_goal" else LATE) or not exact:
                return None
            seen = f"success {end - reached:.2f} s later, {least:.2f} m from the goal"
            return Failed(f"success at {GOAL_RADIUS:g} m", seen, reached, text(name, *values), SUCCESS_LATE, goal)
    return None


def _lateness(record: Record, goal: Goal, samples: Sequence[Sample], limits: Limits) -> Tuple[Any, ...]:
    """What the robot does meanwhile, and what the server has reported: a text's name and its values."""
    begin, end = (samples[0].time, samples[-1].time) if samples else (0.0, 0.0)
    drives = any(abs(command.v) > MIN_SPEED for command in record.commands if begin <= command.time < end)
    if not drives and all(abs(sample.v) < limits.standing_v for sample in samples):
        turn = sum(abs(wrapped(after.yaw - before.yaw)) for before, after in zip(samples, samples[1:]))
        return "turns_at_goal" if turn > LARGE_TURN else "waits_at_goal", GOAL_RADIUS
    own = [it.position_error for it in feedback_of(record, goal) if it.time < end - ITERATION]
    if own and min(own) >= GOAL_RADIUS:
        return "unaware_of_goal", GOAL_RADIUS, own[-1]
    return "goes_on", GOAL_RADIUS


SWERVES = After("drives_straight", kind=LONG_TURN)
OTHER_TURN = After("turns_to_goal", kind=LONG_TURN)


@check("track", after=(*ENDING, SWERVES, OTHER_TURN, After("next_goal", alike)), needs=("reaches_goal", "stays_alive"))
def goal_behind(record: Record, limits: Limits) -> Verdict:
    """Goals behind the robot are reached by the shorter turn, even where the heading wraps from pi to -pi."""
    verdict = of_goals(record, lambda goal: _wrong_success(record, goal, limits) or _long_turn(record, goal))
    alone = len(record.goals) < 2 and not isinstance(verdict, Failed)
    return NotReached("the first goal did not end") if alone else verdict


def _long_turn(record: Record, goal: Goal) -> Optional[Failed]:
    """A robot that turned by much more than it needed to, until it came to the goal."""
    samples = samples_between(record, goal.time, active_until(record, goal))
    there = next((number for number, it in enumerate(samples) if errors_at(it, goal)[0] < GOAL_RADIUS), len(samples))
    samples = samples[:there]
    total = sum(abs(wrapped(after.yaw - before.yaw)) for before, after in zip(samples, samples[1:]))
    needed = abs(errors_at(samples[0], goal)[1]) if samples else 0.0
    if total <= needed + 2.0:
        return None
    wanted, seen = f"a turn of about {needed:.1f} rad", f"{total:.1f} rad"
    return Failed(wanted, seen, goal.time, text("long_turn"), LONG_TURN, goal)


@check("track", after=ENDING, needs=("reaches_goal", "stays_alive"))
def far_goal(record: Record, limits: Limits) -> Verdict:
    """A goal several metres away is reached."""
    return reaches_goal(record, limits)


@check("track", after=ENDING, needs=("reaches_goal", "stays_alive"))
def already_there(record: Record, limits: Limits) -> Verdict:
    """A goal closer than 0.1 m succeeds at once, and the robot stays where it is."""
    return of_goals(
        record, lambda goal: wrong_ending(record, goal, SUCCEEDED, limits) or _not_at_once(record, goal, limits)
    )


def _not_at_once(record: Record, goal: Goal, limits: Limits) -> Optional[Failed]:
    """A robot that takes long or moves although it is at the goal."""
    end = active_until(record, goal)
    samples = samples_between(record, goal.time, end + limits.stop_within)
    moved = max((math.hypot(s.x - samples[0].x, s.y - samples[0].y) for s in samples), default=0.0)
    if end - goal.time <= AT_ONCE and moved <= 0.05:
        return None
    seen = f"a result after {end - goal.time:.1f} s and {moved:.2f} m of motion"
    if moved <= 0.05:
        return Failed("success at once", seen, goal.time, text("waits_at_goal", GOAL_RADIUS), SUCCESS_LATE, goal)
    return Failed("success at once", seen, goal.time, text("check_before_moving", GOAL_RADIUS))
