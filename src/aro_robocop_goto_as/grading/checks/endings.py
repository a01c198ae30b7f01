"""Checks of a goal's terminal state and result."""

import os
import re
from dataclasses import replace
from typing import Optional, Sequence

from ..check_limits import Limits
from ..handout import GOAL_RADIUS
from ..record import (
    ABORTED,
    PREEMPTED,
    SUCCEEDED,
    TERMINAL,
    Goal,
    Record,
    errors_at,
    results_of,
    samples_between,
    status_name,
)
from .consequences import EXCEPTION, misled, stopped_by
from .verdict import Earlier, Failed, NotReached, Passed, Verdict, check, sentences

# Parts of the messages that actionlib's SimpleActionServer and rospy log.
NO_STATE_LOGGED = "No terminal", "without setting", "did not set the goal to a terminal status", "user should have"
TWO_STATES_LOGGED = (
    "must be in a preempting or active state",
    "must be in a pending or recalling state",
    "currently in state",
)
EXCEPTION_LOGGED = "xception in your execute callback", "Traceback"
PLACE = re.compile(r'File "([^"]{1,500})", line (\d+)')  # in a traceback
LIBRARY = re.compile(r"^<|/(dist|site)-packages/|/lib/python3|/opt/ros/")  # the path of a file that is not the node's
TRACEBACK = 40  # lines before the error in which its place is looked for
INFORMATION = re.compile(r"(\x1b\[\d*m)*\[ *(INFO|DEBUG)\b")  # as rospy begins such a line, in a terminal or a log
NO_STATE = "execute_cb returned without calling set_succeeded, set_aborted or set_preempted"
TWO_STATES = "The goal got two terminal states"
SETTERS = "set_succeeded(), set_aborted() and set_preempted()"
NO_RESULT = "no result"
SUCCESS = "success"
NARROW = 0.5  # [m] obstacles that are wider fill the cone ahead
AT_ONCE = 0.3  # [s] a goal that ends within this time was not driven to


def logged(record: Record, words: Sequence[str]) -> bool:
    """Whether the node's output contains one of some words."""
    return any(word in line.text for line in record.lines for word in words)


def last_error(record: Record) -> str:
    """The last traceback's last line with the node's own innermost place, or the last line that is not information.

    A place in a library is named only if the traceback has no place outside of libraries.
    """
    lines = [text.strip() for line in record.lines for text in line.text.splitlines() if text.strip()]
    errors = [number for number, line in enumerate(lines) if "Error" in line.split(":")[0] or "Exception:" in line]
    if errors:
        return lines[errors[-1]][:200] + _place(lines[max(0, errors[-1] - TRACEBACK) : errors[-1]])
    others = [line for line in lines if not INFORMATION.match(line)]
    return (others or ["its output names no error"])[-1][:200]


def wrong_ending(record: Record, goal: Goal, wanted: int, limits: Limits) -> Optional[Failed]:
    """What went wrong with a goal that did not end in the wanted state; None if it did."""
    results = results_of(record, goal)
    if not results:
        last = record.samples[-1].time if record.samples else goal.time
        problem = record.problem or "the goal got no terminal state and no result"
        cause = sentences(_collision(record, goal, last), problem[:1].upper() + problem[1:])
        follows = EXCEPTION if logged(record, EXCEPTION_LOGGED) else stopped_by(record, goal)
        return Failed(status_name(wanted), NO_RESULT, last, cause, follows)
    result = results[0]
    if result.status == wanted:
        return None
    collision = _collision(record, goal, result.time)
    if (wanted, result.status) == (ABORTED, SUCCEEDED) and not collision and not _stopped(record, result.time, limits):
        early = success_too_far(record, goal, limits)
        if early is not None:
            return replace(
                early, expected=status_name(wanted), follows=(*early.follows, Earlier("reaches_goal", SUCCESS))
            )
    cause = _wrong_state(record, result.status, wanted)
    if collision and (wanted, result.status) == (ABORTED, SUCCEEDED):
        cause = _unnoticed(record)
    state = status_name(result.status)
    seen = state + (f": {result.message}" if result.message else "")
    follows = EXCEPTION if logged(record, EXCEPTION_LOGGED) else (*misled(record, goal), Earlier("reaches_goal", state))
    return Failed(status_name(wanted), seen, result.time, sentences(collision, cause), follows)


def _stopped(record: Record, end: float, limits: Limits) -> bool:
    """Whether the goal ended where an obstacle has to end it."""
    return any(sample.ahead <= limits.abort_farthest for sample in samples_between(record, end - 0.25, end))


def _unnoticed(record: Record) -> str:
    """The cause of a collision after which the goal succeeded, because odometry continued to advance."""
    return narrow_obstacle(record) or (
        "It was not noticed. Is the distance ahead checked in each iteration, is it that of the beams ahead, and does "
        "the scan's callback return at once?"
    )


def narrow_obstacle(record: Record) -> str:
    """What a server that reacts to a wall has done wrong if the obstacle is narrow; nothing for a wide one."""
    across = [outline[1::2] for outline in record.obstacles[:1]]
    if not across or max(across[0]) - min(across[0]) > NARROW:
        return ""
    side = "left" if sum(across[0]) > 0.0 else "right"
    return (
        f"A narrow obstacle a little to the {side} was missed or noticed too late, although a wall is noticed. Do the "
        "beams on both sides of straight ahead count, and does the nearest of them decide?"
    )


def _collision(record: Record, goal: Goal, end: float) -> str:
    """A sentence about the first contact with an obstacle, if there was one."""
    contacts = [sample for sample in samples_between(record, goal.time, end) if sample.touching]
    return f"The robot ran into an obstacle at {contacts[0].time:.1f} s" if contacts else ""


def _wrong_state(record: Record, status: int, wanted: int) -> str:
    if logged(record, EXCEPTION_LOGGED):
        return "The goal's callback raised an exception: " + last_error(record)
    if logged(record, NO_STATE_LOGGED):
        return NO_STATE
    if wanted == ABORTED and status == SUCCEEDED:
        return "set_succeeded is called although the goal failed: call set_aborted"
    if wanted == SUCCEEDED and status == ABORTED:
        if not record.obstacles:
            return (
                "set_aborted is called although there is no obstacle at all: does the server have a timeout of its "
                "own, or is a range of inf treated as an obstacle?"
            )
        return (
            "set_aborted is called although nothing is in the way: which beams count as ahead, or does the server have "
            "a timeout of its own?"
        )
    if wanted == PREEMPTED:
        return "Call set_preempted for a goal that is cancelled or replaced"
    return "The server set the wrong terminal state"


def success_too_far(record: Record, goal: Goal, limits: Limits) -> Optional[Failed]:
    """What went wrong with a goal that succeeded away from its position."""
    result = results_of(record, goal)[0]
    at_end = samples_between(record, result.time - 0.2, result.time)
    nearest = min((errors_at(sample, goal)[0] for sample in at_end), default=0.0)
    if nearest <= limits.reached:
        return None
    cause = f"The threshold of position_error is not {GOAL_RADIUS:g} m, or it is compared with another quantity"
    if result.time - goal.time < AT_ONCE:
        cause += ", or what an earlier goal has changed is not reset when a goal begins"
    own = [message.position_error for message in record.feedback if message.id == goal.id][-1:]
    follows = (Earlier("feedback_position"),) if own and own[0] <= limits.reached else ()
    return Failed(f"success within {GOAL_RADIUS:g} m", f"{SUCCESS} {nearest:.2f} m away", result.time, cause, follows)


@check("states")
def success_result(record: Record, limits: Limits) -> Verdict:
    """The result of a reached goal has success true and a message."""
    return _result(record, SUCCEEDED, True)


@check("states")
def failure_result(record: Record, limits: Limits) -> Verdict:
    """The result of an aborted goal has success false and a message."""
    return _result(record, ABORTED, False)


def _result(record: Record, status: int, success: bool) -> Verdict:
    results = [result for goal in record.goals[:1] for result in results_of(record, goal)[:1]]
    if not results or results[0].status != status:
        return NotReached(f"the goal did not end as {status_name(status)}")
    result = results[0]
    if result.success != success:
        cause = "result.success contradicts the terminal state"
        if not result.message:
            cause = "The result is missing from the call: set_succeeded(result), set_aborted(result)"
        return Failed(f"success {success}", f"success {result.success}", result.time, cause)
    if not result.message and logged(record, EXCEPTION_LOGGED):
        cause = "The goal's callback raised an exception: " + last_error(record)
        return Failed("a message", "an empty message", result.time, cause, EXCEPTION)
    if not result.message and logged(record, NO_STATE_LOGGED):
        return Failed("a message", "an empty message", result.time, NO_STATE, (Earlier("one_ending"),))
    if not result.message:
        cause = (
            "No result or an empty one was sent: fill in success and message, pass it to set_succeeded or set_aborted"
        )
        return Failed("a message", "an empty message", result.time, cause)
    return Passed()


@check("speeds")
def stands_at_end(record: Record, limits: Limits) -> Verdict:
    """The robot stands still after a goal has ended, in any state."""
    judged = False
    for number, goal in enumerate(record.goals):
        for result in results_of(record, goal)[:1]:
            stopped = result.time + limits.stop_within
            after = samples_between(record, stopped, stopped + 0.15)
            replaced = number + 1 < len(record.goals) and record.goals[number + 1].time < stopped
            if not after or replaced:
                continue
            judged = True
            for sample in after:
                if abs(sample.v) > limits.standing_v or abs(sample.w) > limits.standing_w:
                    return Failed(
                        "a robot at rest",
                        f"{sample.v:.2f} m/s and {sample.w:.2f} rad/s",
                        sample.time,
                        f"The robot kept moving after the result ({status_name(result.status)}): publish a zero Twist "
                        "at every ending, because the last /cmd_vel stays in force",
                    )
    return Passed() if judged else NotReached("no goal ended")


def _place(lines: Sequence[str]) -> str:
    """File, line and code of the last traceback in these lines, " (FILE, line N: CODE)"; empty without any."""
    begins = [number for number, line in enumerate(lines) if "Traceback" in line]
    lines = [*lines[begins[-1] if begins else 0 :], ""]
    places = [(found, code) for found, code in zip(map(PLACE.search, lines), lines[1:]) if found]
    own = [(found, code) for found, code in places if not LIBRARY.search(found[1])]
    for found, code in (own or places)[-1:]:
        quoted = "" if not code or PLACE.search(code) else f": {code[:120]}"
        return f" ({os.path.basename(found[1])}, line {found[2]}{quoted})"
    return ""


@check("states")
def one_ending(record: Record, limits: Limits) -> Verdict:
    """Each goal gets exactly one terminal state, set by the server's own code."""
    judged = False
    for goal in record.goals:
        results = results_of(record, goal)
        if len(results) > 1:
            return Failed("one result", f"{len(results)} results", results[1].time, TWO_STATES)
        judged = judged or bool(results)
    for line in record.lines:
        if any(word in line.text for word in TWO_STATES_LOGGED):
            cause = f"{TWO_STATES}, as in the handout's example after a cancel: return at once after {SETTERS}"
            return Failed("one terminal state", line.text[:160], line.time, cause)
        if any(word in line.text for word in NO_STATE_LOGGED):
            return Failed("a terminal state", "none was set", line.time, NO_STATE)
    for goal in record.goals:
        changes = [change for change in record.statuses if change.id == goal.id and change.status in TERMINAL]
        if len({change.status for change in changes}) > 1:
            states = " then ".join(status_name(change.status) for change in changes)
            return Failed("one terminal state", states, changes[1].time, TWO_STATES)
    return Passed() if judged else NotReached("no goal ended")
