"""Whether a go-to action server is up, and why it may not be found."""

from typing import Union

import actionlib
import rosgraph
import rospy

from ...names import ACTION_TYPE, robocop
from ...suggestions import did_you_mean
from .. import graph


def is_up(client: Union[actionlib.ActionClient, actionlib.SimpleActionClient]) -> bool:
    """Return whether the client is connected to its server, without waiting; False while ROS time is still zero.

    The timeout is over at once, also while the simulator is paused and ROS time would never reach a later time.
    """
    return bool(rospy.get_rostime()) and client.wait_for_server(rospy.Duration(nsecs=-1))


def absence(action: str) -> str:
    """Status text while the server `action` is missing; names other servers of the same action type."""
    return f"waiting for {action}{hint(action)}"


def hint(action: str, choice: str = "") -> str:
    """Why a server may be missing, as the end of a sentence; empty if nothing is known.

    choice: how the caller's user chooses one of several robots.
    """
    wanted = rospy.resolve_name(action)
    try:
        servers = graph.action_servers()
    except (OSError, rosgraph.MasterException):
        return "; the ROS master does not answer"
    others = [name for name, type_ in servers.items() if type_ == ACTION_TYPE and name != wanted]
    if not others:
        return ""
    robot, _, base_name = wanted[1:].rpartition("/")
    named = [name[1:].rpartition("/")[0] for name in others if name.endswith(f"/{base_name}")]
    question = f": which robot is meant?{choice}" if named else ": a misspelt name?"
    if robot:
        question = did_you_mean(robot, named) or question
    return f"; there is {' and '.join(map(repr, others))} of the same type{question}"


def advice() -> str:
    """What a user can do about a server that is still missing, whichever system runs."""
    return graph.no_simulator() or (
        "if a server has ended, the terminal of its system may say why: correct that, and start the system again "
        f"({robocop()} run has a server, {robocop()} sim --with the package's own, {robocop()} sim none)"
    )
