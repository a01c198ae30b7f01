"""How the robot moves on its way: turn towards the goal, drive straight, get there."""

import math
from dataclasses import replace
from typing import Iterator, List, Optional, Tuple

from ..plan import Limits
from ..record import (
    SUCCEEDED,
    Command,
    Goal,
    Record,
    Sample,
    end_of,
    errors_at,
    samples_between,
    wrapped,
)
from .endings import ending, too_far
from .verdict import Failed, NotReached, Passed, Verdict, check

WINDOW = 0.45  # [s] for which a situation has to last before a command is judged by it
NEAR = 0.2  # [m] nearer to the goal its direction changes fast
MOST_WRONG = 0.1  # share of commands that may be off, from one situation to the next
LONG_IDLE = 10  # commands of neither turning nor driving near the heading: whatever the threshold, that is no way to go
ENOUGH = 4  # commands, fewer say nothing

Judged = Tuple[Command, Sample, float]  # command, truth at its time, angle error


def _in_force(record: Record) -> Iterator[Command]:
    """At each sample's time the newest command before it: /cmd_vel is held, so it need not be published again."""
    number, newest = 0, None
    for sample in record.samples:
        while number < len(record.commands) and record.commands[number].time <= sample.time + 1e-6:
            newest = record.commands[number]
            number += 1
        if newest is not None:
            yield replace(newest, time=sample.time)


def _situations(record: Record, goal: Goal, low: float, high: float) -> List[Judged]:
    """Commands in force when the angle error's size had been within [low, high] for a while, not near the goal."""
    ends = end_of(record, goal)
    until = ends[0].time - 1e-6 if ends else math.inf
    found = []
    for command in _in_force(record):
        if not goal.time + WINDOW < command.time < until:
            continue
        around = samples_between(record, command.time - WINDOW, command.time)
        errors = [errors_at(sample, goal) for sample in around]
        if len(around) >= 4 and all(low <= abs(angle) <= high and far > NEAR for far, angle in errors):
            found.append((command, around[-1], errors[-1][1]))
    return found


@check("speeds")
def turns_to_goal(record: Record, limits: Limits) -> Verdict:
    """While angle_error is beyond 0.1 rad the robot turns towards the goal, and does not drive."""
    judged = False
    for goal in record.goals:
        found = _situations(record, goal, limits.turn_beyond, math.pi)
        stood = _never_moved(record, goal, limits)
        if stood is not None:
            return stood
        if len(found) < ENOUGH:
            continue
        judged = True
        drove = [it for it in found if abs(it[0].v) > limits.driving]
        if len(drove) > MOST_WRONG * len(found):
            command, _, angle = drove[0]
            return Failed(
                "linear.x 0 while angle_error is beyond 0.1",
                f"linear.x {command.v:.2f} at {angle:.2f} rad",
                command.time,
                "the robot drives while it turns: the handout wants it to do one or the other",
            )
        still = [it for it in found if abs(it[0].w) < 1e-3]
        if len(still) > 0.5 * len(found):
            command, _, angle = still[0]
            return Failed(
                "angular.z towards the goal",
                "angular.z 0",
                command.time,
                f"never turned: angle_error is {angle:.2f} but angular.z stayed 0",
            )
        away = [it for it in found if it[0].w * it[2] < 0.0 and abs(it[2]) < math.pi - 0.2]
        if len(away) > 0.15 * len(found):
            command, _, angle = away[0]
            return Failed(
                f"angular.z {'above' if angle > 0 else 'below'} 0",
                f"angular.z {command.w:.2f}",
                command.time,
                f"turns away from the goal: angle_error is {angle:.2f}, so angular.z needs the same sign, "
                "and the shorter way round",
            )
    return Passed() if judged else NotReached("no command was given while angle_error was large")


def _never_moved(record: Record, goal: Goal, limits: Limits) -> Optional[Failed]:
    """A robot that was given a goal aside, and no command."""
    ends = end_of(record, goal)
    until = ends[0].time if ends else math.inf
    here = samples_between(record, goal.time, goal.time)
    if not here or until - goal.time < 1.0:
        return None
    far, angle = errors_at(here[-1], goal)
    commands = [it for it in record.commands if goal.time <= it.time <= until]
    if far > NEAR and abs(angle) > limits.turn_beyond and not any(abs(it.w) > 1e-3 for it in commands):
        return Failed(
            "angular.z towards the goal",
            "no command to turn",
            goal.time,
            f"never turned: angle_error is {angle:.2f} but "
            + ("angular.z stayed 0" if commands else "nothing was published on /cmd_vel"),
        )
    return None


@check("speeds")
def drives_straight(record: Record, limits: Limits) -> Verdict:
    """While angle_error is within 0.1 rad the robot drives straight forward."""
    judged = False
    for goal in record.goals:
        aligned = _situations(record, goal, 0.0, limits.straight_within)
        nearly = _situations(record, goal, 0.0, limits.turn_beyond)
        driving = [it for it in nearly if abs(it[0].v) > limits.driving]
        idle = [it for it in nearly if abs(it[0].v) <= 1e-3 and abs(it[0].w) <= 1e-3]
        if max(len(aligned), len(driving), len(idle) - LONG_IDLE) < ENOUGH:
            continue
        judged = True
        problem = _not_forward(aligned if len(idle) < LONG_IDLE else idle, driving) or _bends(driving, limits)
        if problem is not None:
            return problem
    return Passed() if judged else NotReached("the robot never headed for the goal")


def _not_forward(aligned: List[Judged], driving: List[Judged]) -> Optional[Failed]:
    """A robot that stands, or drives backward, though it heads for the goal."""
    for found, wrong, seen, cause in (
        (
            driving,
            [it for it in driving if it[0].v < 0.0],
            "below 0",
            "the robot drives backward: linear.x needs a positive sign",
        ),
        (
            aligned,
            [it for it in aligned if abs(it[0].v) <= 1e-3],
            "0",
            "heads for the goal but does not drive: linear.x stayed 0 within 0.1 rad",
        ),
    ):
        if len(found) >= ENOUGH and len(wrong) > 0.3 * len(found):
            return Failed("linear.x above 0", f"linear.x {seen} at {wrong[0][2]:.2f} rad", wrong[0][0].time, cause)
    return None


def _bends(driving: List[Judged], limits: Limits) -> Optional[Failed]:
    """A robot that drives along a bend; corrections towards the goal are none."""
    bends = [
        it
        for it in driving
        if abs(it[0].w) > limits.straight_turn or abs(it[0].w) > 0.1 and it[0].w * it[2] < 0.0 and abs(it[2]) > 0.03
    ]
    if len(driving) < ENOUGH or len(bends) <= 0.2 * len(driving):
        return None
    command, _, angle = bends[0]
    return Failed(
        "angular.z near 0",
        f"angular.z {command.w:.2f} at {angle:.2f} rad",
        command.time,
        "the robot goes on turning while it drives: straight means angular.z = 0",
    )


@check("track")
def reaches_goal(record: Record, limits: Limits) -> Verdict:
    """The goal ends with success when the robot is nearer than 0.1 m, and not before."""
    for goal in record.goals:
        problem = ending(record, goal, SUCCEEDED, limits) or too_far(record, goal, limits)
        if problem is not None:
            return problem
    return Passed() if record.goals else NotReached("no goal was sent")


@check("track")
def goal_behind(record: Record, limits: Limits) -> Verdict:
    """Goals behind are reached, also where the heading passes from pi to -pi, by the shorter turn."""
    for goal in record.goals:
        problem = ending(record, goal, SUCCEEDED, limits) or too_far(record, goal, limits) or _long_way(record, goal)
        if problem is not None:
            return problem
    return Passed() if len(record.goals) > 1 else NotReached("the first goal did not end")


def _long_way(record: Record, goal: Goal) -> Optional[Failed]:
    """Turned by more than was needed, by most of a turn."""
    result = end_of(record, goal)[0]
    on_way = samples_between(record, goal.time, result.time)
    total = sum(abs(wrapped(after.yaw - before.yaw)) for before, after in zip(on_way, on_way[1:]))
    needed = abs(errors_at(on_way[0], goal)[1]) if on_way else 0.0
    if total <= needed + 2.0:
        return None
    return Failed(
        f"a turn of about {needed:.1f} rad",
        f"turned by {total:.1f} rad",
        goal.time,
        "angle error not wrapped, so the robot takes the long way round; or it swings to and fro",
    )


@check("track")
def far_goal(record: Record, limits: Limits) -> Verdict:
    """A goal some metres away is reached."""
    return reaches_goal(record, limits)


@check("track")
def already_there(record: Record, limits: Limits) -> Verdict:
    """A goal nearer than 0.1 m ends with success at once, and the robot stays where it is."""
    for goal in record.goals:
        problem = ending(record, goal, SUCCEEDED, limits)
        if problem is not None:
            return problem
        result = end_of(record, goal)[0]
        on_way = samples_between(record, goal.time, result.time + limits.stop_within)
        moved = max((math.hypot(s.x - on_way[0].x, s.y - on_way[0].y) for s in on_way), default=0.0)
        if result.time - goal.time > 2.0 or moved > 0.05:
            return Failed(
                "success at once",
                f"after {result.time - goal.time:.1f} s and {moved:.2f} m",
                goal.time,
                "position_error is below 0.1 from the start: look at it before moving",
            )
    return Passed() if record.goals else NotReached("no goal was sent")
