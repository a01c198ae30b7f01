"""Checks of the robot's motion: turn towards the goal, drive straight, arrive."""

import math
from dataclasses import replace
from typing import Iterator, List, NamedTuple, Optional, Sequence

from ..check_limits import Limits
from ..handout import GOAL_RADIUS, HEADING_TOLERANCE
from ..record import SUCCEEDED, Command, Goal, Record, errors_at, results_of, samples_between, wrapped
from .consequences import misled, silenced_by
from .endings import success_too_far, wrong_ending
from .verdict import Earlier, Failed, NotReached, Passed, Verdict, check

WINDOW = 0.45  # [s] the angle error has to stay within a range for this long before a command is judged by it
NEAR = 0.2  # [m] closer than this, the direction to the goal changes fast
MOST_WRONG = 0.1  # share of wrong commands that is allowed for transitions
LONG_IDLE = 10  # commands that neither turn nor drive near the right heading; more are wrong whatever the threshold
ENOUGH = 4  # fewer commands are not judged
LATE = 0.18  # [s] a server that checks in each iteration reports one position_error that is small enough, at most two
TURN = f"{HEADING_TOLERANCE:g} rad"


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


def _end(record: Record, goal: Goal) -> float:
    results = results_of(record, goal)
    return results[0].time if results else math.inf


def _situations(record: Record, goal: Goal, low: float, high: float) -> List[Situation]:
    """Commands sent far from the goal, after |angle error| was within [low, high] for a WINDOW."""
    end = _end(record, goal) - 1e-6
    situations = []
    for command in _in_force(record):
        if not goal.time + WINDOW < command.time < end:
            continue
        errors = [errors_at(sample, goal) for sample in samples_between(record, command.time - WINDOW, command.time)]
        if len(errors) >= 4 and all(low <= abs(angle) <= high and distance > NEAR for distance, angle in errors):
            situations.append(Situation(command, errors[-1][1]))
    return situations


@check("speeds")
def turns_to_goal(record: Record, limits: Limits) -> Verdict:
    """While angle_error is beyond 0.1 rad the robot turns towards the goal without driving."""
    judged = False
    for goal in record.goals:
        situations = _situations(record, goal, limits.turn_beyond, math.pi)
        problem = _never_turned(record, goal, limits)
        if problem is None and len(situations) >= ENOUGH:
            judged = True
            problem = _wrong_turn(situations, limits)
            if problem is not None:
                problem = replace(problem, follows=misled(record, goal))
        if problem is not None:
            return problem
    return Passed() if judged else NotReached("no command was given while angle_error was large")


def _wrong_turn(situations: Sequence[Situation], limits: Limits) -> Optional[Failed]:
    driving = [it for it in situations if abs(it.command.v) > limits.driving]
    if len(driving) > MOST_WRONG * len(situations):
        command, angle = driving[0]
        wanted = f"linear.x 0 while angle_error is beyond {TURN}"
        cause = "The robot drives while it turns; the handout wants one or the other"
        if sum(abs(it.command.w) < 1e-3 for it in driving) > 0.5 * len(driving):
            cause = f"The robot drives straight at {angle:.2f} rad: the threshold of angle_error is not {TURN}"
        return Failed(wanted, f"linear.x {command.v:.2f} at {angle:.2f} rad", command.time, cause)
    still = [it for it in situations if abs(it.command.w) < 1e-3]
    if len(still) > 0.5 * len(situations):
        command, angle = still[0]
        cause = f"The robot never turned: angle_error is {angle:.2f} rad but angular.z stayed 0"
        return Failed("angular.z towards the goal", "angular.z 0", command.time, cause)
    away = [it for it in situations if it.command.w * it.angle < 0.0 and abs(it.angle) < math.pi - 0.2]
    if len(away) > 0.15 * len(situations):
        command, angle = away[0]
        cause = (
            f"The robot turns away from the goal: angle_error is {angle:.2f} rad, so angular.z needs the same sign for "
            "the shorter turn"
        )
        wanted = f"angular.z {'above' if angle > 0 else 'below'} 0"
        return Failed(wanted, f"angular.z {command.w:.2f}", command.time, cause)
    return None


def _never_turned(record: Record, goal: Goal, limits: Limits) -> Optional[Failed]:
    """A robot that did not head for the goal and got no command to turn."""
    end = _end(record, goal)
    start = samples_between(record, goal.time, goal.time)
    if not start or end - goal.time < 1.0:
        return None
    distance, angle = errors_at(start[-1], goal)
    commands = [command for command in record.commands if goal.time <= command.time <= end]
    if distance > NEAR and abs(angle) > limits.turn_beyond and not any(abs(command.w) > 1e-3 for command in commands):
        reason = "angular.z stayed 0" if commands else "nothing was published on /cmd_vel"
        cause = f"The robot never turned: angle_error is {angle:.2f} rad but {reason}"
        follows = silenced_by(record, goal) or misled(record, goal)
        return Failed("angular.z towards the goal", "no command to turn", goal.time, cause, follows)
    return None


@check("speeds")
def drives_straight(record: Record, limits: Limits) -> Verdict:
    """While angle_error is within 0.1 rad the robot drives straight ahead."""
    judged = False
    for goal in record.goals:
        aligned = _situations(record, goal, 0.0, limits.straight_within)
        nearly = _situations(record, goal, 0.0, limits.turn_beyond)
        driving = [it for it in nearly if abs(it.command.v) > limits.driving]
        idle = [it for it in nearly if abs(it.command.v) <= 1e-3 and abs(it.command.w) <= 1e-3]
        if max(len(aligned), len(driving), len(idle) - LONG_IDLE) < ENOUGH:
            continue
        judged = True
        problem = _not_forward(aligned if len(idle) < LONG_IDLE else idle, driving) or _curves(driving, limits)
        if problem is not None:
            return replace(problem, follows=misled(record, goal))
    return Passed() if judged else NotReached("the robot never headed for the goal")


def _not_forward(aligned: Sequence[Situation], driving: Sequence[Situation]) -> Optional[Failed]:
    """A robot that drives backward, or does not move although it faces the goal."""
    backward = [it for it in driving if it.command.v < 0.0]
    standing = [it for it in aligned if abs(it.command.v) <= 1e-3]
    for wrong, situations, seen, cause in (
        (backward, driving, "below 0", "The robot drives backward: linear.x has to be positive"),
        (
            standing,
            aligned,
            "0",
            f"The robot heads for the goal but does not drive: linear.x stayed 0 within {TURN}",
        ),
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
    cause = "The robot keeps turning while it drives: driving straight means angular.z = 0"
    return Failed("angular.z near 0", f"angular.z {command.w:.2f} at {angle:.2f} rad", command.time, cause)


@check("track")
def reaches_goal(record: Record, limits: Limits) -> Verdict:
    """The goal succeeds when the robot is closer than 0.1 m, and not before."""
    for goal in record.goals:
        problem = (
            wrong_ending(record, goal, SUCCEEDED, limits)
            or success_too_far(record, goal, limits)
            or _success_too_late(record, goal)
        )
        if problem is not None:
            return problem
    return Passed() if record.goals else NotReached("no goal was sent")


def _success_too_late(record: Record, goal: Goal) -> Optional[Failed]:
    """A robot that drives on although the server's own position_error is small enough for success."""
    own = [message for message in record.feedback if message.id == goal.id]
    near = [message for message in own if message.position_error < GOAL_RADIUS]
    if not near or near[-1].time - near[0].time < LATE:
        return None
    least = min(message.position_error for message in near)
    cause = f"The goal goes on although position_error is below {GOAL_RADIUS:g} m: the threshold is another one"
    seen = f"no success until position_error was {least:.2f} m"
    return Failed(f"success below {GOAL_RADIUS:g} m", seen, near[0].time, cause, (Earlier("feedback_position"),))


@check("track")
def goal_behind(record: Record, limits: Limits) -> Verdict:
    """Goals behind the robot are reached by the shorter turn, even where the heading wraps from pi to -pi."""
    for goal in record.goals:
        problem = (
            wrong_ending(record, goal, SUCCEEDED, limits)
            or success_too_far(record, goal, limits)
            or _long_turn(record, goal)
        )
        if problem is not None:
            return problem
    return Passed() if len(record.goals) > 1 else NotReached("the first goal did not end")


def _long_turn(record: Record, goal: Goal) -> Optional[Failed]:
    """A robot that turned by much more than it needed to."""
    samples = samples_between(record, goal.time, _end(record, goal))
    total = sum(abs(wrapped(after.yaw - before.yaw)) for before, after in zip(samples, samples[1:]))
    needed = abs(errors_at(samples[0], goal)[1]) if samples else 0.0
    if total <= needed + 2.0:
        return None
    cause = "angle_error is not wrapped, so that the robot takes the longer turn, or the robot oscillates"
    follows = misled(record, goal)
    return Failed(f"a turn of about {needed:.1f} rad", f"{total:.1f} rad", goal.time, cause, follows)


@check("track")
def far_goal(record: Record, limits: Limits) -> Verdict:
    """A goal several metres away is reached."""
    return reaches_goal(record, limits)


@check("track")
def already_there(record: Record, limits: Limits) -> Verdict:
    """A goal closer than 0.1 m succeeds at once, and the robot stays where it is."""
    for goal in record.goals:
        problem = wrong_ending(record, goal, SUCCEEDED, limits)
        if problem is not None:
            return problem
        end = _end(record, goal)
        samples = samples_between(record, goal.time, end + limits.stop_within)
        moved = max((math.hypot(s.x - samples[0].x, s.y - samples[0].y) for s in samples), default=0.0)
        if end - goal.time > 2.0 or moved > 0.05:
            seen = f"a result after {end - goal.time:.1f} s and {moved:.2f} m of motion"
            cause = f"position_error is below {GOAL_RADIUS:g} m from the start: check it before moving"
            return Failed("success at once", seen, goal.time, cause)
    return Passed() if record.goals else NotReached("no goal was sent")
