"""Checks of the commands: turn towards the goal, then drive straight."""

import math
from dataclasses import replace
from typing import Iterator, List, NamedTuple, Optional, Sequence

from ..handout import HEADING_TOLERANCE, Limits
from ..record import Command, Record, SentGoal
from .verdict import PASSED, Failed, Kind, NotReached, Verdict, check

WINDOW = 0.45  # [s] the angle error has to stay within a range for this long before a command is judged by it
NEAR = 0.2  # [m] closer than this, the direction to the goal changes fast
MAX_WRONG = 0.1  # share of wrong commands that is allowed for transitions
LONG_IDLE = 10  # commands that neither turn nor drive near the right heading; more are wrong whatever the threshold
ENOUGH = 4  # fewer commands are not judged
MIN_SPEED = 1e-3  # [m/s], [rad/s] slower commands are none
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


def _situations(record: Record, goal: SentGoal, low: float, high: float) -> List[Situation]:
    """Commands sent far from the goal, after |angle error| was within [low, high] for a WINDOW."""
    end = record.active_until(goal) - 1e-6
    situations = []
    for command in _in_force(record):
        if not goal.time + WINDOW < command.time < end:
            continue
        errors = [goal.errors_at(sample) for sample in record.samples_between(command.time - WINDOW, command.time)]
        if len(errors) >= 4 and all(low <= abs(angle) <= high and distance > NEAR for distance, angle in errors):
            situations.append(Situation(command, errors[-1][1]))
    return situations


@check("server", "left right behind far", plot="speeds")
def turns_to_goal(record: Record, limits: Limits) -> Verdict:
    """While angle_error is beyond 0.1 rad the robot turns towards the goal without driving."""
    judged = False
    for goal in record.goals:
        situations = _situations(record, goal, limits.turn_beyond, math.pi)
        if len(situations) < ENOUGH:
            continue
        judged = True
        aligned = _aligned_before(record, goal, limits)
        problem = _moves_first(record, goal, situations, limits) or _wrong_turn(situations, limits, aligned)
        if problem is not None:
            return replace(problem, goal=goal)
    return PASSED if judged else NotReached("no command was given while angle_error was large")


def _moves_first(record: Record, goal: SentGoal, situations: Sequence[Situation], limits: Limits) -> Optional[Failed]:
    """The failure of a robot that drives off when the goal comes, and then turns as it should."""
    first = next((command for command in record.commands if command.time >= goal.time - 1e-6), None)
    driving = [abs(it.command.v) > limits.driving for it in situations]
    at_first = driving.index(False) if False in driving else len(driving)
    if first is None or abs(first.v) <= limits.driving or not 0 < at_first < len(driving) or any(driving[at_first:]):
        return None
    seen = f"linear.x {first.v:.2f} at {situations[0].angle:.2f} rad"
    cause = (
        "The robot drives when the goal comes, and turns only then: calculate the errors first, and let them decide "
        "what it does"
    )
    return Failed(NOT_DRIVING, seen, first.time, cause, Kind.MOVES_FIRST)


def _aligned_before(record: Record, goal: SentGoal, limits: Limits) -> float:
    """The first time [s] at which the robot faced the goal; infinity if it never did."""
    errors = ((sample.time, goal.errors_at(sample)[1]) for sample in record.samples_between(goal.time, math.inf))
    return next((time for time, angle in errors if abs(angle) < limits.turn_beyond), math.inf)


def _wrong_turn(situations: Sequence[Situation], limits: Limits, aligned: float) -> Optional[Failed]:
    driving = [it for it in situations if abs(it.command.v) > limits.driving]
    if len(driving) > MAX_WRONG * len(situations):
        command, angle = driving[0]
        cause = "The robot drives while it turns; the handout wants one or the other"
        if sum(abs(it.command.w) < MIN_SPEED for it in driving) > 0.5 * len(driving):
            cause = (
                f"Once it has turned to the goal, the robot drives on at {angle:.2f} rad without turning again: "
                f"compare angle_error with {TURN} in each iteration, because the heading changes while it drives"
                if command.time > aligned
                else f"The robot drives straight, with linear.x {command.v:.2f}, at an angle_error of {angle:.2f} rad: "
                f"beyond {TURN} it has to turn first"
            )
        seen = f"linear.x {command.v:.2f} at {angle:.2f} rad"
        return Failed(NOT_DRIVING, seen, command.time, cause)
    still = [it for it in situations if abs(it.command.w) < MIN_SPEED]
    if len(still) > 0.5 * len(situations):
        command, angle = still[0]
        cause = f"The robot does not turn although angle_error is {angle:.2f} rad: angular.z is 0"
        return Failed("angular.z towards the goal", "angular.z 0", command.time, cause)
    wrong = [it for it in situations if it.command.w * it.angle < 0.0]
    away = [it for it in wrong if abs(it.angle) < math.pi - 0.2]  # beyond, a right command may be of the other side
    if len(away) > 0.15 * len(situations) or len(wrong) > 0.5 * len(situations):
        command, angle = (away or wrong)[0]
        wanted = "angular.z above 0" if angle > 0 else "angular.z below 0"
        cause = (
            f"The robot turns away from the goal: angle_error is {angle:.2f} rad, so angular.z needs the same sign, "
            "also for large angles"
        )
        return Failed(wanted, f"angular.z {command.w:.2f}", command.time, cause)
    return None


@check("server", "left right far", plot="speeds")
def drives_straight(record: Record, limits: Limits) -> Verdict:
    """While angle_error is within 0.1 rad the robot drives straight ahead."""
    judged = False
    for goal in record.goals:
        aligned = _situations(record, goal, 0.0, limits.straight_within)
        nearly = _situations(record, goal, 0.0, limits.turn_beyond)
        moving = [it for it in nearly if abs(it.command.v) > MIN_SPEED]
        driving = [it for it in moving if abs(it.command.v) > limits.driving] or moving
        drove = max((it.command.time for it in moving), default=-math.inf)  # it may stand still before
        idle = [it for it in nearly if _is_idle(it.command) and it.command.time > drove]
        aligned = [it for it in aligned if not _is_idle(it.command) or it.command.time > drove]
        if max(len(aligned), len(driving), len(idle) - LONG_IDLE) < ENOUGH:
            continue
        judged = True
        problem = _not_forward(aligned if len(idle) < LONG_IDLE else idle, driving) or _curves(driving, limits)
        if problem is not None:
            return replace(problem, goal=goal)
    return PASSED if judged else NotReached("the robot did not head for the goal for long enough")


def _is_idle(command: Command) -> bool:
    return abs(command.v) <= MIN_SPEED and abs(command.w) <= MIN_SPEED


def _not_forward(aligned: Sequence[Situation], driving: Sequence[Situation]) -> Optional[Failed]:
    """The failure of a robot that drives backward, or does not move although it faces the goal."""
    backward = [it for it in driving if it.command.v < 0.0]
    standing = [it for it in aligned if abs(it.command.v) <= 1e-3]
    for wrong, situations, seen, cause in (
        (backward, driving, "below 0", "The robot drives backward: linear.x has to be positive"),
        (standing, aligned, "0", f"The robot heads for the goal but does not drive: linear.x is 0 within {TURN}"),
    ):
        if len(situations) >= ENOUGH and len(wrong) > 0.3 * len(situations):
            command, angle = wrong[0]
            return Failed("linear.x above 0", f"linear.x {seen} at {angle:.2f} rad", command.time, cause)
    return None


def _curves(driving: Sequence[Situation], limits: Limits) -> Optional[Failed]:
    """The failure of a robot that drives along a curve; gentle corrections towards the goal are allowed."""
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
    cause = "The robot keeps turning while it drives: driving straight means angular.z = 0"
    return Failed("angular.z near 0", seen, command.time, cause)
