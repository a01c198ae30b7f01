"""Why a click did not become the goal that it should: causes of the bridge's failures, in sentences."""

import math
import re

from ..handout import ACTION, CLICK_TOPIC
from ..record import Click, Record, SentGoal
from .node_lifetime import closest
from .output import logged
from .topic_use import wrong_type

POSITION_TOLERANCE = 0.02  # [m] of a goal that needs no transform
FRAME_TOLERANCE = 0.1  # [m] of a transformed goal: the robot moves between two odometry messages
TOO_EARLY = re.compile("extrapolation.{1,40}into the future")  # in tf2's words
ACTION_TOPICS = tuple(f"{ACTION}/{topic}" for topic in ("goal", "status", "result", "feedback"))
NOTHING_SENT = (
    "No goal was sent: does the callback call send_goal()? Does a bridge that is started before the server wait for "
    "it, with wait_for_server() without a timeout?"
)
NOT_CANCELLED = (
    "The older goal is not cancelled: is cancel_goal() or cancel_all_goals() called before the newer goal is sent, and "
    "cancel_goal() on the client that has sent the older one? send_goal() alone does not cancel, and a new client does "
    "not know the goals of others"
)
NEWER_CANCELLED = "The newer goal is cancelled, too"
UNASKED_GOAL = "The bridge sends a goal without a click"
UNASKED_CANCEL = "The bridge cancels a goal although no newer click has come"
OLDER_POSITION = (
    "The newer goal has the position of the older click: fill the goal from the message that has just come, then "
    "send it"
)
NOT_FORWARDED = (
    "The click was not forwarded: does the subscriber or its callback end, or is a flag never cleared that says that a "
    "goal has been sent?"
)
OTHER_POSITION = (
    "The goal does not have the click's position in odom: goal.position is msg.pose.position, transformed to odom from "
    "the frame in header.frame_id"
)
OWN_SERVER = "The bridge has an action server robocop_goto_as of its own, so its client never waits for the real one"


def distance(goal: SentGoal, x: float, y: float) -> float:
    return math.hypot(goal.x - x, goal.y - y)


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
    return NOTHING_SENT


def unconnected(record: Record) -> str:
    """Why no action client connected to the server."""
    other = wrong_type(record, *ACTION_TOPICS)
    if other:
        return other
    name, others = ACTION[1:], [server.lstrip("/") for server in record.servers]
    if not others or name in others:
        return f"No action client connected to {name}: is one created?"
    return f"The action client looks for {closest(name, others) or others[0]}; the handout says {name}"


def looks_up_too_early(record: Record) -> bool:
    """Return whether tf2 refused a transform because the newest transform was older than the requested time."""
    return logged(record, TOO_EARLY)


def other_position(record: Record, click: Click, goal: SentGoal) -> str:
    """Why a goal is elsewhere than its click: the position of an older click, or coordinates of another frame."""
    older = [it for it in record.clicks if it.time < click.time and it.frame == "odom"]
    if any(distance(goal, it.x, it.y) <= POSITION_TOLERANCE for it in older):
        return OLDER_POSITION
    if distance(goal, click.x, click.y) <= POSITION_TOLERANCE:
        return (
            f"Coordinates in {click.frame} were passed on as if they were in odom: use tf2 to transform them from "
            "header.frame_id to odom"
        )
    return OTHER_POSITION
