"""Checks of the bridge: clicks become goals, and the server's status is reported."""

import math
import re
from dataclasses import replace
from typing import Dict, List, Mapping, Optional, Sequence

from aro_robocop_goto_as.geometry import Pose2D, compose, inverse

from ..handout import ACTION, CLICKS, Limits
from ..record import PREEMPTED, Cancel, Click, Goal, Record
from ..texts import text
from .bridge_reports import NO_REPORT, is_silent, untrue, wrong_reports
from .consequences import alike
from .node_lifetime import closest, no_exception, stays_alive
from .output import UNKNOWN_TYPE, logged
from .topic_types import wrong_type
from .verdict import PASSED, After, Failed, NotReached, Verdict, check

POSITION_TOLERANCE = 0.02  # [m] of a goal that needs no transform
FRAME_TOLERANCE = 0.1  # [m] of a transformed goal: the robot moves between two odometry messages
MISSING, POSITION, NOT_CANCELLED = "no goal", "another position", "not cancelled"  # kinds of failures
TOO_EARLY = re.compile("extrapolation.{1,40}into the future")  # in tf2's words
ACTION_TOPICS = tuple(f"{ACTION}/{topic}" for topic in ("goal", "status", "result", "feedback"))
MAX_ID = 80  # characters that are shown of a goal's id
NEEDS = "bridge_alive", "forwards_goal"
NOT_FORWARDED = "The click was not forwarded"
WRONG_WAY_ROUND = (
    "The transform is applied the wrong way round, as from odom to {}: odom is the target frame, the first argument of "
    "lookup_transform()"
)
NOT_TURNED = "The click is only shifted from {} to odom, not turned: use tf2, which does both"
NOT_SHIFTED = "The click is only turned from {} to odom, not shifted: use tf2, which does both"
OTHER_FRAME = "The click in {0} is transformed as if it were in {1}: take its frame from header.frame_id"
OWN_SERVER = "The bridge has an action server robocop_goto_as of its own, so its client never waits for the real one"
CRASH = After("bridge_alive", when=lambda _record, failure, _earlier: failure.kind in (MISSING, NO_REPORT))


def _goals_after(record: Record, click: Click, until: float = math.inf) -> List[Goal]:
    return [goal for goal in record.goals if click.time - 1e-6 <= goal.time <= until]


def _distance(goal: Goal, x: float, y: float) -> float:
    return math.hypot(goal.x - x, goal.y - y)


@check("track", after=(CRASH,))
def forwards_goal(record: Record, limits: Limits) -> Verdict:
    """A 2D Nav Goal is sent to robocop_goto_as exactly once, with the same position."""
    if not record.clicks:
        return NotReached("there was no click")
    click, *later = record.clicks
    goals = _goals_after(record, click, later[0].time - 1e-3 if later else math.inf)
    wanted = f"x {click.x:g} y {click.y:g}"
    if not goals:
        return Failed(f"a goal at {wanted}", "no goal", click.time, _missing_connection(record), MISSING)
    goal = goals[-1]
    if not _distance(goal, click.x, click.y) <= POSITION_TOLERANCE:  # this way round NaN fails, too
        seen = f"x {goal.x:.2f} y {goal.y:.2f}"
        return Failed(wanted, seen, goal.time, _other_position(click, goal), POSITION)
    if len(goals) > 1:
        return Failed("one goal", f"{len(goals)} goals", goals[1].time, "The click is sent more than once")
    return PASSED


def _other_position(click: Click, goal: Goal) -> str:
    """Which mistake explains a goal's position that is not the click's."""
    x, y = click.x, click.y
    for cause, there in (
        ("The goal's position is 0, as if it were not set", (0.0, 0.0)),
        ("x and y are swapped", (y, x)),
        ("The goal's y is not set", (x, 0.0)),
        ("The goal's x is not set", (0.0, y)),
        ("The sign of x is wrong", (-x, y)),
        ("The sign of y is wrong", (x, -y)),
        ("The signs of x and y are wrong", (-x, -y)),
        ("The position is rounded", (round(x, 1), round(y, 1))),
        ("The position is rounded to whole numbers", (round(x), round(y))),
    ):
        if _distance(goal, *there) <= POSITION_TOLERANCE:
            return f"{cause}: set goal.position = msg.pose.position"
    return text("other_position")


def _has_client(record: Record) -> bool:
    """Return whether its action client connected to the server."""
    return bool(record.marks.get("clients", 1.0))


def _missing_connection(record: Record) -> str:
    """Name the missing connection, if any."""
    if not _has_client(record):  # first: a bridge waiting for a misspelt server has no subscriber either
        return _unconnected(record)
    if not record.marks.get("listeners", 1.0):
        other = wrong_type(record, CLICKS, *ACTION_TOPICS)  # the latter: it may wait for the server before
        if other:
            return other
        similar = closest(CLICKS, record.unpublished)
        return text("other_topic", CLICKS, similar) if similar else text("no_subscriber", CLICKS)
    return text("tf2_types" if logged(record, UNKNOWN_TYPE) else "nothing_sent")


def _unconnected(record: Record) -> str:
    """Why no action client connected to the server."""
    other = wrong_type(record, *ACTION_TOPICS)
    if other:
        return other
    name, others = ACTION[1:], [server.lstrip("/") for server in record.servers]
    if not others or name in others:
        return text("unconnected")
    return text("other_action", closest(name, others) or others[0], name)


@check("track", after=(CRASH,), needs=NEEDS)
def reports_status(record: Record, limits: Limits) -> Verdict:
    """A timer reports the status of the action server periodically."""
    if "watching" not in record.marks:
        return NotReached("the bridge did not get this far")
    problem = wrong_reports(record, limits)
    connects = _has_client(record) and not wrong_type(record, *ACTION_TOPICS)
    if problem is not None and problem.kind == NO_REPORT and not connects:
        return NotReached(_unconnected(record))  # it may wait for the server before it creates its timer
    return problem or PASSED


def _explained(records: Mapping[str, Record], names: Sequence[str], failure: Failed) -> Failed:
    """The failure to forward a click; if clicks became goals before it and none after it, with what that means."""
    times = [goal.time for record in records.values() for goal in record.goals]
    number = sum(time < failure.time for time in times)
    if failure.cause != NOT_FORWARDED or not number or any(records[name].goals for name in names):
        return failure
    if number < len(times):  # a later click in odom became a goal
        return replace(failure, cause=text("other_frame_ignored"))
    return replace(failure, cause=text("no_more_goals", "goal" if number == 1 else f"{number} goals"))


@check("track", after=(CRASH, After("forwards_goal", alike)), needs=NEEDS, explain=_explained)
def cancels_older(record: Record, limits: Limits) -> Verdict:
    """A newer 2D Nav Goal cancels the older goal and is then sent itself."""
    if len(record.clicks) < 2:
        return NotReached("there was no newer click")
    before, click = record.clicks[:2]
    goals = _goals_after(record, click)
    old = [goal for goal in _goals_after(record, before) if goal not in goals]
    if not old:
        return Failed(f"a goal at x {before.x:g} y {before.y:g}", "no goal", before.time, NOT_FORWARDED, MISSING)
    older, newer = old[-1], [goal for goal in goals if goal.id != old[-1].id]
    cancelled = {change.id for change in record.statuses if change.status == PREEMPTED}
    if not newer:
        cause = text("cancelled_only" if older.id in cancelled else "no_newer_goal")
        return Failed("the newer goal", "no goal", click.time, cause, MISSING)
    if _distance(older, before.x, before.y) <= POSITION_TOLERANCE < _distance(newer[-1], click.x, click.y):
        x, y = newer[-1].x, newer[-1].y
        same = _distance(older, x, y) <= POSITION_TOLERANCE
        cause = text("older_position") if same else _other_position(click, newer[-1])
        wanted, seen = f"x {click.x:g} y {click.y:g}", f"x {x:.2f} y {y:.2f}"
        return Failed(wanted, seen, newer[-1].time, cause, POSITION)
    if newer[-1].id in cancelled:
        seen = "one for both" if older.id in cancelled else "one for the newer goal"
        wanted = "a cancel request for the older goal only"
        return Failed(wanted, seen, newer[-1].time, _newer_cancelled(record, newer[-1]))
    if older.id not in cancelled:
        wanted = "a cancel request for the older goal"
        requests = [cancel for cancel in record.cancels if cancel.time >= click.time - 1e-6]
        seen = "one for another goal" if requests else "none"
        return Failed(wanted, seen, click.time, _not_cancelled(requests, older), NOT_CANCELLED)
    return PASSED


def _newer_cancelled(record: Record, newer: Goal) -> str:
    """Why the newer goal is cancelled."""
    by_stamp = [cancel for cancel in record.cancels if not cancel.id and cancel.stamp > 0.0]
    by_id = any(cancel.id == newer.id for cancel in record.cancels)
    return text("cancelled_by_stamp") if by_stamp and not by_id else text("cancelled_after")


def _not_cancelled(requests: Sequence[Cancel], older: Goal) -> str:
    """Why the older goal is not cancelled."""
    if not requests:
        return text("cancel_first")
    if requests[-1].id:
        return text("cancel_of_another", requests[-1].id[:MAX_ID], older.id[:MAX_ID])
    return text("cancel_by_early_stamp", requests[-1].stamp)


@check("track", after=(CRASH, After("forwards_goal", alike)), needs=NEEDS)
def waits_for_server(record: Record, limits: Limits) -> Verdict:
    """A bridge that is started before the server waits for it, and then works."""
    if record.name == "no_server":
        if record.marks.get("own_server"):
            return Failed("an action client only", "an action server, too", 0.0, OWN_SERVER)
        return _crash(record, limits) or NotReached("the bridge was not tried with a server")
    if record.clicks and _goals_after(record, record.clicks[0]):
        return PASSED
    if not _has_client(record):
        return NotReached(_unconnected(record))
    clicked, wanted = record.marks.get("clicked", 0.0), "a goal once the server is running"
    return Failed(wanted, "no goal", clicked, text("waits_for_no_server"), MISSING)


@check("track")
def bridge_alive(record: Record, limits: Limits) -> Verdict:
    """The bridge runs to the end without an exception."""
    if record.name == "frame" and _looks_up_too_early(record):
        return PASSED  # goal_frame tells it
    return _crash(record, limits) or PASSED


def _looks_up_too_early(record: Record) -> bool:
    """Return whether tf2 refused a transform because the newest transform was older than the requested time."""
    return logged(record, TOO_EARLY)


def _crash(record: Record, limits: Limits) -> Optional[Failed]:
    for verdict in (stays_alive(record, limits), no_exception(record, limits)):
        if isinstance(verdict, Failed):
            return verdict
    return None


@check(
    "track",
    after=(CRASH, After("forwards_goal", alike), After("cancels_older", alike)),
    needs=NEEDS,
    explain=_explained,
)
def goal_frame(record: Record, limits: Limits) -> Verdict:
    """A goal given in another frame is transformed to odom (the handout's closing question)."""
    if not record.clicks:
        return NotReached("there was no click")
    for number, click in enumerate(record.clicks):
        # What a click causes may come without any simulated time passing.
        until = record.clicks[number + 1].time - 1e-3 if number + 1 < len(record.clicks) else math.inf
        goals = _goals_after(record, click, until)
        if not goals:
            early = _looks_up_too_early(record)
            cause = text("transform_too_early", click.frame) if early else NOT_FORWARDED
            return Failed(f"a goal for the click in {click.frame}", "no goal", click.time, cause, MISSING)
        goal = goals[-1]
        if not _distance(goal, click.odom_x, click.odom_y) <= FRAME_TOLERANCE:
            cause = _wrong_transform(record, click, goal)
            wanted = f"x {click.odom_x:.2f} y {click.odom_y:.2f} in odom"
            return Failed(wanted, f"x {goal.x:.2f} y {goal.y:.2f}", goal.time, cause, POSITION)
    return PASSED


def _wrong_transform(record: Record, click: Click, goal: Goal) -> str:
    """Which mistake explains where a click in another frame than odom has become a goal."""
    if _distance(goal, click.x, click.y) < POSITION_TOLERANCE:
        return text("not_transformed", click.frame)
    frames = _frames(record, click.time)
    there = frames.pop(click.frame, Pose2D())
    for cause, odom_from_frame in (
        (WRONG_WAY_ROUND.format(click.frame), inverse(there)),
        (NOT_TURNED.format(click.frame), there._replace(yaw=0.0)),
        (NOT_SHIFTED.format(click.frame), Pose2D(yaw=there.yaw)),
        *((OTHER_FRAME.format(click.frame, other), pose) for other, pose in frames.items()),
    ):
        point = compose(odom_from_frame, Pose2D(click.x, click.y))
        if _distance(goal, point.x, point.y) <= FRAME_TOLERANCE:
            return cause
    return "The transform is wrong"


def _frames(record: Record, time: float) -> Dict[str, Pose2D]:
    """By frame, odom_from_frame at a time [s]; map is the world."""
    now = max((it for it in record.samples if it.time <= time + 1e-6), key=lambda it: it.time, default=None)
    if now is None:
        return {}
    robot, in_world = Pose2D(now.x, now.y, now.yaw), Pose2D(now.world_x, now.world_y, now.world_yaw)
    return {"base_footprint": robot, "map": compose(robot, inverse(in_world))}


def about_pending(records: Mapping[str, Record], limits: Limits) -> List[str]:
    """Advice for a bridge that works with goals that are accepted at once, but not with PENDING goals."""
    record, found = records.get("pending"), []
    if record is None or any(_crash(it, limits) for it in records.values()):
        return []
    if "click" in records and reports_status(records["click"], limits) is PASSED and "watching" in record.marks:
        wrong = untrue(record)
        found += [text("reports_stop")] if is_silent(record) else [wrong.cause] if wrong else []
    if "replace" in records and cancels_older(records["replace"], limits) is PASSED:
        verdict = cancels_older(record, limits)
        if isinstance(verdict, Failed) and verdict.kind == NOT_CANCELLED:
            found.append(text("no_older_goal_seen"))
    return found
