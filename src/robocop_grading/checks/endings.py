"""Checks of a goal's terminal state and result."""

import math
from dataclasses import replace
from typing import Callable, Optional

from ..handout import GOAL_RADIUS, STOP_DISTANCE, Limits
from ..record import ABORTED, AT_END, PREEMPTED, SUCCEEDED, TERMINAL, Record, Result, SentGoal, status_name
from ..texts import sentences
from .output import NO_STATE, NO_STATE_LOGGED, TWO_STATES_LOGGED, logged_cause
from .topic_use import wrong_type
from .verdict import PASSED, Failed, Kind, NotReached, Verdict, check, kind_of_wrong_state

TWO_STATES = "The goal got two terminal states"
NARROW = 0.5  # [m] obstacles that are wider fill the cone ahead
TOO_SOON = 0.3  # [s] a goal that ends within this time was not driven to
LOOK = 0.15  # [s] in which the robot has to stand still, once it has to
ON_ITS_WAY = 0.3  # [s] after a result, in which a command may still arrive that was sent before it
UNNOTICED = f"The goal was not aborted when the obstacle ahead was nearer than {STOP_DISTANCE:g} m"
TOO_FAR = (
    f"The goal succeeds before position_error is below {GOAL_RADIUS:g} m: is the threshold wrong, is the wrong "
    "quantity compared, or does something else end the goal?"
)
UNASKED = "The robot is commanded to move although no goal is active"
EMPTY_RESULT = (
    "No result or an empty one was sent: fill in success and message, pass it to set_succeeded or set_aborted"
)


def wrong_ending(record: Record, goal: SentGoal, wanted: int, limits: Limits) -> Optional[Failed]:
    """What went wrong with a goal that did not end in the wanted state; None if it did."""
    results = record.results_of(goal)
    if not results:
        last = record.samples[-1].time if record.samples else goal.time
        problem = record.problem or "the goal got no terminal state and no result"
        other_type = wrong_type(record, "/odom", "/scan", "/cmd_vel")
        told = problem[:1].upper() + problem[1:], other_type or _unmoved(record, goal)
        cause = sentences(_collision(record, goal, last), *told)
        return Failed(status_name(wanted), "no result", last, cause, Kind.NO_RESULT, goal)
    result = results[0]
    if result.status == wanted:
        return None
    collision = _collision(record, goal, result.time)
    at_end = record.samples_between(result.time - AT_END, result.time)
    stopped = any(sample.ahead <= limits.abort_farthest for sample in at_end)  # where an obstacle has to end the goal
    if (wanted, result.status) == (ABORTED, SUCCEEDED) and not collision and not stopped:
        early = success_too_far(record, goal, limits)
        if early is not None:
            return replace(early, expected=status_name(wanted))
    cause = _wrong_state(record, goal, result.status, wanted)
    if collision and (wanted, result.status) == (ABORTED, SUCCEEDED):  # odometry continued to advance
        cause = wrong_type(record, "/scan") or narrow_obstacle(record) or UNNOTICED
    seen = status_name(result.status) + (f": {result.message}" if result.message else "")
    return Failed(
        status_name(wanted), seen, result.time, sentences(collision, cause), kind_of_wrong_state(result.status), goal
    )


def _unmoved(record: Record, goal: SentGoal) -> str:
    """What is seen of a robot that was not driven to a goal: topics without a publisher, commands."""
    if record.unpublished:
        return f"The node subscribes to {', '.join(record.unpublished)}, which nobody publishes"
    commands = [command.v for command in record.commands if command.time >= goal.time]
    if not commands:
        return "Nothing was published on /cmd_vel"
    return "" if max(commands) > 0.0 else "linear.x on /cmd_vel was never above 0"


def wrong_success(record: Record, goal: SentGoal, limits: Limits) -> Optional[Failed]:
    """What went wrong with a goal that did not succeed, or not at its position."""
    return wrong_ending(record, goal, SUCCEEDED, limits) or success_too_far(record, goal, limits)


def of_goals(record: Record, problem: Callable[[SentGoal], Optional[Failed]]) -> Verdict:
    """The first problem that a goal has."""
    if not record.goals:
        return NotReached("no goal was sent")
    return next(filter(None, map(problem, record.goals)), PASSED)


def narrow_obstacle(record: Record) -> str:
    """What a server that reacts to walls has done wrong at a narrow obstacle; nothing for a wide obstacle."""
    across = [outline[1::2] for outline in record.obstacles[:1]]
    if not across or max(across[0]) - min(across[0]) > NARROW:
        return ""
    side = "left" if sum(across[0]) > 0.0 else "right"
    return (
        f"A narrow obstacle a little to the {side} was missed or noticed too late, although a wall is noticed. Do the "
        "beams on both sides of straight ahead count, as far as the robot is wide, and does the nearest of them decide?"
    )


def _collision(record: Record, goal: SentGoal, end: float) -> str:
    """A sentence about the first contact with an obstacle, if there was one."""
    contacts = [sample for sample in record.samples_between(goal.time, end) if sample.touching]
    return f"The robot ran into an obstacle at {contacts[0].time:.1f} s" if contacts else ""


def _wrong_state(record: Record, goal: SentGoal, status: int, wanted: int) -> str:
    end = record.results_of(goal)[0].time
    told = logged_cause(record, end)
    if told:
        return told
    if status == PREEMPTED and not _asked_to_end(record, goal, end):
        hint = "Is is_preempt_requested() called, with its parentheses?" if at_once(record, goal) else ""
        if any(cancel.time < goal.time for cancel in record.cancels):
            hint = "Does a cancel request that came before this goal end it?"
        return sentences("set_preempted is called although neither a cancel request nor a newer goal has come", hint)
    if wanted == ABORTED and status == SUCCEEDED:
        return "set_succeeded is called although the goal failed: call set_aborted"
    if wanted == SUCCEEDED and status == ABORTED:
        return (
            "set_aborted is called although nothing is in the way: do beams count that are not ahead, is a range of "
            "inf or an earlier scan treated as an obstacle, or does the server have a timeout of its own?"
        )
    if wanted == PREEMPTED:
        return "Call set_preempted for a goal that is cancelled or replaced"
    return "The server set the wrong terminal state"


def _asked_to_end(record: Record, goal: SentGoal, end: float) -> bool:
    """Return whether a cancel request or a newer goal came before a time [s]."""
    cancelled = any(cancel.time <= end and cancel.id in ("", goal.id) for cancel in record.cancels)
    return cancelled or any(goal.time < newer.time <= end for newer in record.goals)


def success_too_far(record: Record, goal: SentGoal, limits: Limits) -> Optional[Failed]:
    """What went wrong with a goal that succeeded away from its position."""
    result = record.results_of(goal)[0]
    at_end = record.samples_between(result.time - AT_END, result.time)
    nearest = min((goal.errors_at(sample)[0] for sample in at_end), default=0.0)
    if nearest <= limits.reached:
        return None
    own = [it.position_error for it in record.feedback_of(goal) if it.time <= result.time]
    kind, cause = Kind.TOO_FAR, TOO_FAR
    if own and own[-1] < GOAL_RADIUS:
        cause = f"The server believes that the robot is at the goal: its own position_error is {own[-1]:.3f} m"
    if at_once(record, goal) and any(_took_longer(record, it) for it in record.goals if it.time < goal.time):
        kind, cause = Kind.NOT_RESET, "What an earlier goal has changed is not reset when a new goal begins"
    seen = f"success {nearest:.2f} m away"
    return Failed(f"success within {GOAL_RADIUS:g} m", seen, result.time, cause, kind, goal)


def at_once(record: Record, goal: SentGoal) -> bool:
    """Return whether a goal has ended too soon to be driven to."""
    return any(result.time - goal.time < TOO_SOON for result in record.results_of(goal)[:1])


def _took_longer(record: Record, goal: SentGoal) -> bool:
    return bool(record.results_of(goal)) and not at_once(record, goal)


@check("server", "left right", plot="states")
def success_result(record: Record, limits: Limits) -> Verdict:
    """The result of a reached goal has success true and a message."""
    return _result(record, SUCCEEDED, True)


@check("server", "obstacle", plot="states")
def failure_result(record: Record, limits: Limits) -> Verdict:
    """The result of an aborted goal has success false and a message."""
    return _result(record, ABORTED, False)


def _result(record: Record, status: int, success: bool) -> Verdict:
    results = [result for goal in record.goals[:1] for result in record.results_of(goal)[:1]]
    if not results or results[0].status != status:
        return NotReached(f"the goal did not end as {status_name(status)}")
    result = results[0]
    if result.success != success:
        cause = "result.success contradicts the terminal state" if result.message else EMPTY_RESULT
        return Failed(f"success {success}", f"success {result.success}", result.time, cause)
    if not result.message:
        cause = logged_cause(record, result.time) or EMPTY_RESULT
        return Failed("a message", "an empty message", result.time, cause, Kind.NO_MESSAGE)
    return PASSED


@check("server", "start left right obstacle cancel cancel_turning newer_goal", plot="speeds")
def stands_at_end(record: Record, limits: Limits) -> Verdict:
    """The robot moves only while a goal is active."""
    judged = False
    begin = min((goal.time for goal in record.goals), default=math.inf)
    for command in record.commands:
        if command.time < begin and (abs(command.v) > limits.standing_v or abs(command.w) > limits.standing_w):
            seen = f"linear.x {command.v:.2f} and angular.z {command.w:.2f} on /cmd_vel"
            return Failed("a robot at rest", seen, command.time, UNASKED, Kind.MOVING)
    for number, goal in enumerate(record.goals):
        for result in record.results_of(goal)[:1]:
            stopped = result.time + limits.stop_within
            after = record.samples_between(stopped, stopped + LOOK)
            replaced = number + 1 < len(record.goals) and record.goals[number + 1].time < stopped + LOOK
            if not after or replaced:
                continue
            judged = True
            for sample in after:
                if abs(sample.v) > limits.standing_v or abs(sample.w) > limits.standing_w:
                    seen = f"{sample.v:.2f} m/s and {sample.w:.2f} rad/s"
                    cause = keeps_moving(record, result, sample.time)
                    return Failed("a robot at rest", seen, sample.time, cause, Kind.MOVING, goal)
    return PASSED if judged else NotReached("no goal ended")


def keeps_moving(record: Record, result: Result, until: float) -> str:
    """Why a robot does not stop between a result and a time [s]: the last command, or further commands."""
    commands = [it for it in record.commands if result.time + ON_ITS_WAY < it.time <= until]
    later = any((it.v, it.w) != (0.0, 0.0) for it in commands)
    state = status_name(result.status)
    if later:
        return (
            f"The robot is still commanded to move after the result ({state}): does a loop, a timer or a thread go on? "
            "Publish a zero Twist at every ending, and nothing after it"
        )
    return (
        f"The robot kept moving after the result ({state}): publish a zero Twist at every ending, because the last "
        "/cmd_vel stays in force"
    )


@check("server", "left behind obstacle cancel newer_goal", plot="states")
def one_ending(record: Record, limits: Limits) -> Verdict:
    """Each goal gets exactly one terminal state, set by the server's own code."""
    judged = False
    for goal in record.goals:
        results = record.results_of(goal)
        if len(results) > 1:
            return Failed("one result", f"{len(results)} results", results[1].time, TWO_STATES)
        judged = judged or bool(results)
    for line in record.lines:
        refused = TWO_STATES_LOGGED.search(line.text)
        if refused:
            state = int(refused[1])
            cause = f"A goal that was {status_name(state)} got a terminal state: it has to be accepted before"
            if state in TERMINAL:
                cause = (
                    f"{TWO_STATES}, as in the handout's example after a cancel: return at once after set_succeeded(), "
                    "set_aborted() and set_preempted()"
                )
            kind = Kind.TWO_STATES if state in TERMINAL else Kind.NOT_ACCEPTED
            return Failed("one terminal state", line.text[:160], line.time, cause, kind)
        if NO_STATE_LOGGED.search(line.text):
            return Failed("a terminal state", "none was set", line.time, NO_STATE)
    for goal in record.goals:
        changes = [change for change in record.statuses if change.id == goal.id and change.status in TERMINAL]
        if len({change.status for change in changes}) > 1:
            states = " then ".join(status_name(change.status) for change in changes)
            return Failed("one terminal state", states, changes[1].time, TWO_STATES)
    return PASSED if judged else NotReached("no goal ended")
