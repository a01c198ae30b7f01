"""Whether a go-to action server is up, and why it may not be found."""

import time
from typing import Callable

import actionlib
import rosgraph
import rospy

from ...process.peer import Peer, others_want_to_run
from ...suggestions import did_you_mean
from .. import graph
from ..names import ACTION_TYPE
from ..rospy_internals import connections_of, is_connected_to, publishers_of, sender
from ..ticker import wait_until

PATIENCE = 20  # times the timeout


def is_up(client: actionlib.ActionClient) -> bool:
    """Whether all five topics of an action client are connected to its server, without waiting.

    actionlib's wait_for_server measures its timeout in ROS time: on a paused simulator it never returns.
    """
    if client.last_status_msg is None:
        return False
    server = sender(client.last_status_msg)
    return all(server in publishers_of(topic) for topic in (client.result_sub, client.feedback_sub)) and all(
        is_connected_to(topic, server) for topic in (client.pub_goal, client.pub_cancel)
    )


def kept_from_answering(client: actionlib.ActionClient, patience: float) -> Callable[[], bool]:
    """Tells whether the server, or a callback of this process, would go on but waits for a processor.

    Each may use `patience` [s] of processor time from now on.
    """
    servers = [Peer(end, patience) for _, end in connections_of(client.pub_goal)]
    limit = time.process_time() + patience

    def kept() -> bool:
        callbacks = time.process_time() < limit and others_want_to_run()
        return callbacks or any(server.wants_to_run() for server in servers)

    return kept


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
    robot, _, base_name = wanted[1:].rpartition("/")
    named = [name[1:].rpartition("/")[0] for name in others if name.endswith(f"/{base_name}")]
    question = ": which robot is meant?" if named else ": a misspelt name?"
    if robot:
        question = did_you_mean(robot, named) or question
    return f"; there is {' and '.join(map(repr, others))} of the same type{question}"


def advice() -> str:
    """What a user of this namespace can do about a server that is still missing."""
    namespace = rospy.get_namespace().rstrip("/")
    setting = f"env ROS_NAMESPACE={namespace} " if namespace else ""
    command = f"./robocop shell {setting}rosrun aro_robocop_goto_as robocop_goto_as.py"
    return f"the server's output may say why it ended; to start it again, in another terminal: {command}"


def wait_or_explain(client: actionlib.ActionClient, action: str, timeout: float, ended: Callable[[], bool]) -> str:
    """Wait up to `timeout` [s, wall] for the server, or until its system has ended.

    One that exists, but has not connected yet, may be kept from it on a busy machine: it gets PATIENCE times as long.
    An empty string, or why it may be missing and what to do.
    """
    started = time.monotonic()
    for _ in range(PATIENCE):
        if wait_until(lambda: is_up(client) or ended(), timeout):
            break
        if not graph.has_living_publisher(rospy.resolve_name(f"{action}{graph.RESULT}")):
            break
        rospy.loginfo_once("%s is running, but does not answer yet", action)
    if is_up(client) and not ended():
        return ""
    hint = _hint(action) or "; the terminal in which the system was started shows why its server ended, if it did"
    return f"no answer from {action} for {time.monotonic() - started:.0f} s{hint}"
