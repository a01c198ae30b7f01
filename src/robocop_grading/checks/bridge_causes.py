"""Why a click did not become the goal that it should: causes of the bridge's failures, in sentences."""

import math
import re
from typing import Dict, Sequence

from aro_robocop_goto_as.geometry import Pose2D, compose, inverse
from robocop_hosting.node_errors import NOT_IMPORTED

from ..handout import ACTION, CLICK_TOPIC
from ..record import Cancel, Click, Record, SentGoal
from .node_lifetime import closest
from .output import UNKNOWN_TYPE, logged
from .topic_use import wrong_type

POSITION_TOLERANCE = 0.02  # [m] of a goal that needs no transform
FRAME_TOLERANCE = 0.1  # [m] of a transformed goal: the robot moves between two odometry messages
TOO_EARLY = re.compile("extrapolation.{1,40}into the future")  # in tf2's words
ACTION_TOPICS = tuple(f"{ACTION}/{topic}" for topic in ("goal", "status", "result", "feedback"))
MAX_ID = 80  # characters that are shown of a goal's id
NOTHING_SENT = (
    "No goal was sent: does the callback call send_goal()? Does a bridge that is started before the server wait for "
    "it, with wait_for_server() without a timeout?"
)
NO_NEWER_GOAL = (
    "The newer goal was never sent: does the callback wait for the older goal, or not send one while another is "
    "active? While it waits, for instance in wait_for_result(), it is not called again"
)
CANCELLED_ONLY = "The older goal is cancelled, but the newer one is never sent: the same callback has to send it"
OLDER_POSITION = (
    "The newer goal has the position of the older click: fill the goal from the message that has just come, then "
    "send it"
)
NOT_FORWARDED = "The click was not forwarded"
OTHER_FRAME_IGNORED = (
    f"{NOT_FORWARDED}, although clicks in odom are: does the callback ignore other frames, or catch an exception of "
    "tf2 without logging it?"
)
OWN_SERVER = "The bridge has an action server robocop_goto_as of its own, so its client never waits for the real one"
TARGET_FIRST = "odom is the target frame, the first argument of lookup_transform()"
BOTH = "tf2's transform() does both"
FROM_HEADER = "take its frame from header.frame_id"
WAITS_FOR_NO_SERVER = (
    "A bridge that starts before the server has to connect to it later: call wait_for_server() without a timeout"
)
REPORTS_STOP = (
    "its reports stop while a goal is PENDING, which means that the server has not accepted it yet; with a server that "
    "takes longer for that than the handout's, it reports nothing"
)
NO_OLDER_GOAL_SEEN = (
    "it does not cancel an older goal that is PENDING, which means that the server has not accepted it yet, and may do "
    "so later"
)


def distance(goal: SentGoal, x: float, y: float) -> float:
    return math.hypot(goal.x - x, goal.y - y)


def other_position(click: Click, goal: SentGoal) -> str:
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
        if distance(goal, *there) <= POSITION_TOLERANCE:
            return f"{cause}: set goal.position = msg.pose.position"
    return "The goal does not have the message's position: set goal.position = msg.pose.position"


def has_client(record: Record) -> bool:
    """Return whether its action client connected to the server."""
    return bool(record.marks.get("clients", 1.0))


def missing_connection(record: Record) -> str:
    """Name the missing connection, if any."""
    if not has_client(record):  # first: a bridge waiting for a misspelt server has no subscriber either
        return unconnected(record)
    if not record.marks.get("listeners", 1.0):
        other = wrong_type(record, CLICK_TOPIC, *ACTION_TOPICS)  # the latter: it may wait for the server before
        if other:
            return other
        similar = closest(CLICK_TOPIC, record.unpublished)
        but = f" but to {similar}" if similar else ""
        return f"The node does not subscribe to {CLICK_TOPIC}{but}: is the name right?"
    return NOT_IMPORTED if logged(record, UNKNOWN_TYPE) else NOTHING_SENT


def unconnected(record: Record) -> str:
    """Why no action client connected to the server."""
    other = wrong_type(record, *ACTION_TOPICS)
    if other:
        return other
    name, others = ACTION[1:], [server.lstrip("/") for server in record.servers]
    if not others or name in others:
        return f"No action client connected to {name}: is one created?"
    return f"The action client looks for {closest(name, others) or others[0]}; the handout says {name}"


def newer_cancelled(record: Record, newer: SentGoal) -> str:
    """Why the newer goal is cancelled."""
    by_stamp = [cancel for cancel in record.cancels if not cancel.id and cancel.stamp > 0.0]
    by_id = any(cancel.id == newer.id for cancel in record.cancels)
    if by_stamp and not by_id:
        return (
            "The cancel request is for all goals up to a time, and the newer goal has no later time stamp, as "
            "simulated time goes on in steps: use cancel_goal()"
        )
    return "The newer goal is cancelled, too: cancel before send_goal(), not after it"


def not_cancelled(requests: Sequence[Cancel], older: SentGoal) -> str:
    """Why the older goal is not cancelled."""
    if not requests:
        return (
            "No cancel request was sent: is cancel_goal() or cancel_all_goals() called before the newer goal is sent, "
            "and cancel_goal() on the client that has sent the older one? send_goal() alone does not cancel, and a new "
            "client does not know the goals of others"
        )
    if requests[-1].id:
        return (
            f'The cancel request is for a goal with the id "{requests[-1].id[:MAX_ID]}", but the older goal\'s id is '
            f'"{older.id[:MAX_ID]}": cancel_goal() of the client that has sent it knows the id'
        )
    return (
        f"The cancel request is for goals sent up to {requests[-1].stamp:.1f} s, and the older goal was sent later: "
        "use cancel_goal()"
    )


def looks_up_too_early(record: Record) -> bool:
    """Return whether tf2 refused a transform because the newest transform was older than the requested time."""
    return logged(record, TOO_EARLY)


def wrong_transform(record: Record, click: Click, goal: SentGoal) -> str:
    """Which mistake explains where a click in another frame than odom has become a goal."""
    if distance(goal, click.x, click.y) < POSITION_TOLERANCE:
        return (
            f"Coordinates in {click.frame} were passed on as if they were in odom: use tf2 to transform them from "
            "header.frame_id to odom"
        )
    frames, frame = _frames(record, click.time), click.frame
    there = frames.pop(frame, Pose2D())
    for cause, odom_from_frame in (
        (f"The transform is applied the wrong way round, as from odom to {frame}: {TARGET_FIRST}", inverse(there)),
        (f"The click is only shifted from {frame} to odom, not turned: {BOTH}", there._replace(yaw=0.0)),
        (f"The click is only turned from {frame} to odom, not shifted: {BOTH}", Pose2D(yaw=there.yaw)),
        *(
            (f"The click in {frame} is transformed as if it were in {other}: {FROM_HEADER}", pose)
            for other, pose in frames.items()
        ),
    ):
        point = compose(odom_from_frame, Pose2D(click.x, click.y))
        if distance(goal, point.x, point.y) <= FRAME_TOLERANCE:
            return cause
    return "The transform is wrong"


def _frames(record: Record, time: float) -> Dict[str, Pose2D]:
    """By frame, odom_from_frame at a time [s]; map is the world."""
    now = max((it for it in record.samples if it.time <= time + 1e-6), key=lambda it: it.time, default=None)
    if now is None:
        return {}
    robot, in_world = Pose2D(now.x, now.y, now.yaw), Pose2D(now.world_x, now.world_y, now.world_yaw)
    return {"base_footprint": robot, "map": compose(robot, inverse(in_world))}
