"""Checks that goals are reached: near, behind, far away, and where the robot already is."""

import math
from typing import Optional, Sequence

from ..handout import GOAL_RADIUS, Limits
from ..record import SUCCEEDED, Record, Sample, SentGoal, wrapped
from .endings import of_goals, wrong_ending, wrong_success
from .turning import MIN_SPEED
from .verdict import Failed, Kind, NotReached, Verdict, check

LATE = 0.22  # [s] from the true arrival to the success: a loop's period, one of odometry and one of the recording
LATE_AT_REST = 1.0  # [s] likewise of a robot that stands at the goal meanwhile
LARGE_TURN = 0.5  # [rad] of a robot at the goal
MAX_TIME_AT_GOAL = 2.0  # [s] from a goal that is reached already to its success
END_THERE = f"end the goal as soon as position_error is below {GOAL_RADIUS:g} m"
WAITS = f"The robot stands at the goal, but the result comes later: {END_THERE}"
TURNS = f"The robot turns at the goal: {END_THERE}"


@check("server", "left right", plot="track")
def reaches_goal(record: Record, limits: Limits) -> Verdict:
    """The goal succeeds when the robot is closer than 0.1 m, and not before."""
    return of_goals(record, lambda goal: wrong_success(record, goal, limits) or _success_too_late(record, goal, limits))


def _success_too_late(record: Record, goal: SentGoal, limits: Limits) -> Optional[Failed]:
    """The failure of a robot that drives on although it is close enough for success."""
    end = record.active_until(goal)
    way = [(sample.time, goal.errors_at(sample)[0]) for sample in record.samples_between(goal.time, end)]
    for (before, far), (after, near) in zip(way, way[1:]):
        if near < GOAL_RADIUS <= far:
            reached = before + (after - before) * (far - GOAL_RADIUS) / (far - near)
            cause = _lateness(record, record.samples_between(reached + LATE, end), limits)
            least = min(distance for _, distance in way)
            exact = cause in (WAITS, TURNS) or least < 2.0 * GOAL_RADIUS - limits.reached
            if end - reached <= (LATE_AT_REST if cause == WAITS else LATE) or not exact:
                return None
            seen = f"success {end - reached:.2f} s later, {least:.2f} m from the goal"
            return Failed(f"success at {GOAL_RADIUS:g} m", seen, reached, cause, Kind.SUCCESS_LATE, goal)
    return None


def _turned(samples: Sequence[Sample]) -> float:
    """By how much [rad] the robot has turned, to either side."""
    return sum(abs(wrapped(after.yaw - before.yaw)) for before, after in zip(samples, samples[1:]))


def _lateness(record: Record, samples: Sequence[Sample], limits: Limits) -> str:
    """Why success is late, by what the robot does meanwhile."""
    begin, end = (samples[0].time, samples[-1].time) if samples else (0.0, 0.0)
    drives = any(abs(command.v) > MIN_SPEED for command in record.commands if begin <= command.time < end)
    if not drives and all(abs(sample.v) < limits.standing_v for sample in samples):
        return TURNS if _turned(samples) > LARGE_TURN else WAITS
    return (
        f"The goal goes on although the robot is within {GOAL_RADIUS:g} m: is position_error calculated in each "
        "iteration, ten times a second, from the newest pose of /odom, and compared with this threshold?"
    )


@check("server", "behind", plot="track")
def goal_behind(record: Record, limits: Limits) -> Verdict:
    """Goals behind the robot are reached by the shorter turn, even where the heading wraps from pi to -pi."""
    verdict = of_goals(record, lambda goal: wrong_success(record, goal, limits) or _long_turn(record, goal))
    alone = len(record.goals) < 2 and not isinstance(verdict, Failed)
    return NotReached("the first goal did not end") if alone else verdict


def _long_turn(record: Record, goal: SentGoal) -> Optional[Failed]:
    """The failure of a robot that turned by much more than needed on its way to the goal."""
    samples = record.samples_between(goal.time, record.active_until(goal))
    there = next((number for number, it in enumerate(samples) if goal.errors_at(it)[0] < GOAL_RADIUS), len(samples))
    samples = samples[:there]
    total = _turned(samples)
    needed = abs(goal.errors_at(samples[0])[1]) if samples else 0.0
    if total <= needed + 2.0:
        return None
    wanted, seen = f"a turn of about {needed:.1f} rad", f"{total:.1f} rad"
    cause = (
        "The robot turns much more than it needs to: does it turn by the sign of a wrapped angle_error, and does "
        "it stop turning in time?"
    )
    return Failed(wanted, seen, goal.time, cause, Kind.LONG_TURN, goal)


@check("server", "far", plot="track")
def far_goal(record: Record, limits: Limits) -> Verdict:
    """A goal several metres away is reached."""
    return reaches_goal(record, limits)


@check("server", "already_there", plot="track")
def already_there(record: Record, limits: Limits) -> Verdict:
    """A goal closer than 0.1 m succeeds at once, and the robot stays where it is."""
    return of_goals(
        record, lambda goal: wrong_ending(record, goal, SUCCEEDED, limits) or _not_at_once(record, goal, limits)
    )


def _not_at_once(record: Record, goal: SentGoal, limits: Limits) -> Optional[Failed]:
    """The failure of a robot that takes long or moves although it is at the goal."""
    end = record.active_until(goal)
    samples = record.samples_between(goal.time, end + limits.stop_within)
    moved = max((math.hypot(s.x - samples[0].x, s.y - samples[0].y) for s in samples), default=0.0)
    turn = _turned(samples)
    if end - goal.time <= MAX_TIME_AT_GOAL and moved <= 0.05 and turn <= LARGE_TURN:
        return None
    seen = f"a result after {end - goal.time:.1f} s, {moved:.2f} m of motion and a turn of {turn:.1f} rad"
    if moved <= 0.05:
        return Failed(
            "success at once", seen, goal.time, TURNS if turn > LARGE_TURN else WAITS, Kind.SUCCESS_LATE, goal
        )
    cause = f"position_error is below {GOAL_RADIUS:g} m from the start: check it before moving"
    return Failed("success at once", seen, goal.time, cause, Kind.MOVES_FIRST, goal)
