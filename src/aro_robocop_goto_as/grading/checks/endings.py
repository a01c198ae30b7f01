"""How goals end: with which state, with which result, where, and how often."""

from typing import Optional

from ..plan import Limits
from ..record import (
    ABORTED,
    PREEMPTED,
    RECALLED,
    STATUS_NAMES,
    SUCCEEDED,
    TERMINAL,
    Goal,
    Record,
    end_of,
    errors_at,
    samples_between,
    status_name,
)
from .verdict import Failed, NotReached, Passed, Verdict, check

NO_RESULT = "No terminal", "without setting", "did not set the goal to a terminal status", "user should have"
DOUBLE = "must be in a preempting or active state", "must be in a pending or recalling state", "currently in state"
GONE_ON = ("its wheels went on turning until odometry said that it was there. Is the distance ahead looked at in each "
           "iteration?")
EXCEPTION = "xception in your execute callback", "Traceback"


def _text(record: Record) -> str:
    return "\n".join(line.text for line in record.lines)


def ending(record: Record, goal: Goal, wanted: int, limits: Limits) -> Optional[Failed]:
    """None when a goal ended as it should; else what happened instead."""
    ends = end_of(record, goal)
    name = status_name(wanted)
    if not ends:
        last = record.samples[-1].time if record.samples else goal.time
        cause = record.problem or "the goal got no terminal state and no result"
        return Failed(name, "no result", last, _hit(record, goal, last) + cause)
    end = ends[0]
    if end.status == wanted:
        return None
    hit = _hit(record, goal, end.time)
    why = (GONE_ON if hit and (wanted, end.status) == (ABORTED, SUCCEEDED) else _why(record, end.status, wanted))
    return Failed(name, f"{status_name(end.status)}{': ' + end.message if end.message else ''}", end.time, hit + why)


def _hit(record: Record, goal: Goal, end: float) -> str:
    """Whether the robot met an obstacle on its way: its wheels go on turning there, and odometry with them."""
    touching = [sample for sample in samples_between(record, goal.time, end) if sample.touching]
    return f"the robot ran into an obstacle at {touching[0].time:.1f} s; " if touching else ""


def _why(record: Record, status: int, wanted: int) -> str:
    text = _text(record)
    if any(words in text for words in EXCEPTION):
        return "an exception in the goal's callback: " + last_error(record)
    if any(words in text for words in NO_RESULT):
        return "execute_cb returned without set_succeeded, set_aborted or set_preempted"
    if wanted == ABORTED and status == SUCCEEDED:
        return "set_succeeded is called though the goal failed: it needs set_aborted"
    if wanted == SUCCEEDED and status == ABORTED:
        return "set_aborted is called though nothing is in the way: which beams count as ahead, which ranges as valid?"
    if wanted == PREEMPTED:
        return "a goal that is cancelled or replaced needs set_preempted"
    return "the wrong terminal state was set"


def last_error(record: Record) -> str:
    """The last line of the last traceback, for a person."""
    lines = [line.text.strip() for line in record.lines]
    words = [line for line in lines if "Error" in line.split(":")[0] or "Exception:" in line]
    return (words or [line for line in lines if line] or ["see its output"])[-1].splitlines()[-1][:200]


def too_far(record: Record, goal: Goal, limits: Limits) -> Optional[Failed]:
    """Success away from the goal."""
    result = end_of(record, goal)[0]
    at_end = samples_between(record, result.time - 0.2, result.time)
    nearest = min((errors_at(sample, goal)[0] for sample in at_end), default=0.0)
    if nearest <= limits.reached:
        return None
    return Failed(
        "success within 0.1 m",
        f"success {nearest:.2f} m away",
        result.time,
        "the threshold of position_error is not 0.1 m, or it is compared with something else",
    )


@check("states")
def success_result(record: Record, limits: Limits) -> Verdict:
    """The result of a reached goal says so: success is true, message is filled."""
    return _result(record, SUCCEEDED, True)


@check("states")
def failure_result(record: Record, limits: Limits) -> Verdict:
    """The result of an aborted goal says so: success is false, message is filled."""
    return _result(record, ABORTED, False)


def _result(record: Record, status: int, success: bool) -> Verdict:
    ends = [end for goal in record.goals[:1] for end in end_of(record, goal)[:1] if end.status == status]
    if not ends:
        return NotReached(f"the goal did not end as {status_name(status)}")
    for end in ends:
        if end.success != success:
            return Failed(f"success {success}", f"success {end.success}", end.time,
                          "the result is not sent with the terminal state: set_succeeded(result), set_aborted(result)"
                          if not end.message else "result.success does not fit the outcome")
        if not end.message:
            return Failed("a message", "an empty message", end.time,
                          "no result, or an empty one, was sent: fill in success and message, and give the result to "
                          "set_succeeded or set_aborted")
    return Passed()


@check("distances")
def stops_at_obstacle(record: Record, limits: Limits) -> Verdict:
    """With an obstacle nearer than 0.3 m ahead the goal is aborted, before the robot touches it."""
    if not record.goals:
        return NotReached("no goal was sent")
    return _abort(record, record.goals[0], limits) or Passed()


def _abort(record: Record, goal: Goal, limits: Limits) -> Optional[Failed]:
    problem = ending(record, goal, ABORTED, limits)
    if problem is not None:
        return problem
    end = end_of(record, goal)[0]
    around = samples_between(record, end.time - 0.25, end.time + limits.stop_within)
    if any(sample.touching for sample in around):
        return Failed("standing before the obstacle", "the robot touches it", end.time, "it was seen too late")
    if any(words in _text(record) for words in EXCEPTION):
        return Failed("an abort when 0.3 m are left", "an exception", end.time, _why(record, end.status, ABORTED))
    at_end = [sample.ahead for sample in samples_between(record, end.time - 0.25, end.time)]
    if at_end and min(at_end) > limits.abort_farthest:
        return Failed("an abort when 0.3 m are left", f"aborted with {min(at_end):.2f} m left", end.time,
                      "the threshold is not 0.3 m, or other beams than those ahead count")
    if at_end and at_end[-1] < limits.abort_nearest:
        return Failed("an abort when 0.3 m are left", f"aborted with {at_end[-1]:.2f} m left", end.time,
                      "the threshold is not 0.3 m, or the scan is looked at too seldom")
    return None


@check("distances")
def only_ahead_counts(record: Record, limits: Limits) -> Verdict:
    """Obstacles beside and behind the robot do not end a goal."""
    for goal in record.goals:
        problem = ending(record, goal, SUCCEEDED, limits)
        if problem is not None:
            return problem
    return Passed() if record.goals else NotReached("no goal was sent")


@check("distances")
def odd_scans(record: Record, limits: Limits) -> Verdict:
    """Beams of inf, 0 and NaN are no obstacles, and hide none."""
    if not record.goals:
        return NotReached("no goal was sent")
    goal = record.goals[0]
    wanted = STATUS_NAMES.index(goal.ends)
    problem = ending(record, goal, wanted, limits)
    if problem is None and wanted == ABORTED:
        problem = _abort(record, goal, limits)
    if problem is None:
        return Passed()
    hint = ("0 or NaN is taken for an obstacle" if wanted == SUCCEEDED else "a NaN or 0 among the beams hides the wall")
    return Failed(problem.expected, problem.seen, problem.time,
                  f"{problem.cause}; here {hint}: only range_min < r < range_max is a return")


@check("states")
def cancel(record: Record, limits: Limits) -> Verdict:
    """A cancelled goal ends as PREEMPTED, soon."""
    if not record.cancels:
        return NotReached("the goal ended before it could be cancelled")
    asked = record.cancels[0]
    goal = next(goal for goal in record.goals if goal.id == asked.id)
    return _given_up(record, goal, asked.time, limits, "cancel", "is is_preempt_requested() asked in each iteration?")


@check("states")
def newer_goal(record: Record, limits: Limits) -> Verdict:
    """A newer goal ends the older one as PREEMPTED, and is reached."""
    if len(record.goals) < 2:
        return NotReached("the first goal ended before a newer one could be sent")
    older, newer = record.goals[:2]
    verdict = _given_up(record, older, newer.time, limits, "newer goal",
                        "is_preempt_requested() is true for a newer goal as well: the loop has to end then")
    if not isinstance(verdict, Passed):
        return verdict
    return ending(record, newer, SUCCEEDED, limits) or Passed()


def _given_up(record: Record, goal: Goal, asked: float, limits: Limits, what: str, hint: str) -> Verdict:
    ends = end_of(record, goal)
    if not ends or ends[0].time > asked + limits.preempt_within:
        seen = f"{ends[0].time - asked:.1f} s later" if ends else "never"
        return Failed(f"PREEMPTED within {limits.preempt_within:g} s of the {what}", seen, asked,
                      f"the {what} is not noticed: {hint}")
    if ends[0].status not in (PREEMPTED, RECALLED):
        problem = ending(record, goal, PREEMPTED, limits)
        assert problem is not None
        return problem
    return Passed()


@check("states")
def next_goal(record: Record, limits: Limits) -> Verdict:
    """After a goal has ended, in whatever way, the next one is served."""
    if len(record.goals) < 2 or not end_of(record, record.goals[0]):
        return NotReached("the first goal did not end")
    goal = record.goals[-1]
    heard = {status.id for status in record.statuses} | {result.id for result in record.results}
    if goal.id not in heard:
        return Failed("the second goal is accepted", "nothing", goal.time, "the server no longer takes goals")
    problem = ending(record, goal, SUCCEEDED, limits) or too_far(record, goal, limits)
    if problem is None:
        return Passed()
    return Failed(problem.expected, problem.seen, problem.time,
                  f"after {status_name(end_of(record, record.goals[0])[0].status)} the second goal fails: "
                  f"{problem.cause}; is all that the first one left behind set back?")


@check("speeds")
def stands_at_end(record: Record, limits: Limits) -> Verdict:
    """Once a goal has ended, in whatever way, the robot stands."""
    judged = False
    for number, goal in enumerate(record.goals):
        for end in end_of(record, goal)[:1]:
            after = samples_between(record, end.time + limits.stop_within, end.time + limits.stop_within + 0.15)
            replaced = number + 1 < len(record.goals) and record.goals[number + 1].time < end.time + limits.stop_within
            if not after or replaced:
                continue
            judged = True
            moving = [s for s in after if abs(s.v) > limits.standing_v or abs(s.w) > limits.standing_w]
            if moving:
                return Failed("the robot stands", f"{moving[0].v:.2f} m/s and {moving[0].w:.2f} rad/s", moving[0].time,
                              f"robot kept driving after the result ({status_name(end.status)}): publish a zero Twist "
                              "at every ending; /cmd_vel is held")
    return Passed() if judged else NotReached("no goal ended")


@check("states")
def one_ending(record: Record, limits: Limits) -> Verdict:
    """Each goal gets exactly one terminal state, set by the server's own code."""
    judged = False
    for goal in record.goals:
        ends = end_of(record, goal)
        if len(ends) > 1:
            return Failed("one result", f"{len(ends)} results", ends[1].time, "goal got two terminal states")
        judged = judged or bool(ends)
    for line in record.lines:
        if any(words in line.text for words in DOUBLE):
            return Failed("one terminal state", line.text[:160], line.time,
                          "goal got two terminal states; the handout's example does so after a cancel: return after "
                          "set_preempted()")
        if any(words in line.text for words in NO_RESULT):
            return Failed("a terminal state", "none was set", line.time,
                          "execute_cb returned without set_succeeded, set_aborted or set_preempted")
    changes = [it for it in record.statuses if it.status in TERMINAL]
    for goal in record.goals:
        states = [it for it in changes if it.id == goal.id]
        if len({it.status for it in states}) > 1:
            return Failed("one terminal state", " then ".join(status_name(it.status) for it in states), states[1].time,
                          "goal got two terminal states")
    return Passed() if judged else NotReached("no goal ended")
