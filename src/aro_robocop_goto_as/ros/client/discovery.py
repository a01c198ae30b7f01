"""Whether a go-to action server is up, and why it may not be found."""

import time

import actionlib
import rosgraph
import rospy

from .. import graph, private_api
from ..action import ACTION_TYPE
from ..ticker import wait_until

is_up = private_api.connected_to_server


def absence(action: str) -> str:
    """Status text while the server `action` is missing; names other servers of the same action type."""
    return f"waiting for {action}{_hint(action)}"


def _hint(action: str) -> str:
    """Why a server may be missing, as the end of a sentence; empty if nothing is known."""
    wanted = rospy.resolve_name(action)
    try:
        servers = graph.action_servers()
    except (OSError, rosgraph.MasterException):
        return "; the ROS master does not answer"
    others = [name for name, type_ in servers.items() if type_ == ACTION_TYPE and name != wanted]
    if not others:
        return ""
    same_base_name = any(name.endswith("/" + wanted.rpartition("/")[2]) for name in others)
    question = "which robot is meant?" if same_base_name else "a misspelt name?"
    return f"; there is {' and '.join(map(repr, others))} of the same type: {question}"


def advice() -> str:
    """What to do about a server that stays away, for a user of this namespace."""
    namespace = rospy.get_namespace().rstrip("/")
    setting = f"env ROS_NAMESPACE={namespace} " if namespace else ""
    command = f"./robocop shell {setting}rosrun aro_robocop_goto_as robocop_goto_as.py"
    return f"the server's output may say why it ended; to start it again, in another terminal: {command}"


def wait_or_explain(client: actionlib.ActionClient, action: str, timeout: float) -> str:
    """Wait up to `timeout` [s, wall] for the server; an empty string, or why it may be missing and what to do."""
    started = time.monotonic()
    if wait_until(lambda: is_up(client), timeout):
        return ""
    hint = _hint(action) or "; the terminal in which the system was started shows why its server ended, if it did"
    return f"no answer from {action} for {time.monotonic() - started:.0f} s{hint}"
