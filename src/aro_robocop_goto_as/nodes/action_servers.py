"""Which GoToPosition action servers there are, whatever they are called."""

import time
from typing import List

import actionlib
import rosgraph
import rospy

from .ticker import wait_until

RESULT_TYPE = "aro_robocop_goto_as/GoToPositionActionResult"
RESULT_SUFFIX = "/result"


def is_up(client: actionlib.ActionClient) -> bool:
    """Whether the client's server is there with all five topics connected, without waiting.

    actionlib's own wait_for_server measures its time-out in ROS time: on a paused simulator it never returns.
    """
    if client.last_status_msg is None:
        return False
    server = client.last_status_msg._connection_header["callerid"]
    heard = all(any(link.callerid_pub == server for link in subscriber.impl.connections)
                for subscriber in (client.result_sub, client.feedback_sub))
    return heard and all(publisher.impl.has_connection(server) for publisher in (client.pub_goal, client.pub_cancel))


def wait_for(client: actionlib.ActionClient, timeout: float) -> bool:
    """Whether the server came up within `timeout` [s, wall]."""
    return wait_until(lambda: is_up(client), timeout)


def names() -> List[str]:
    """Names of all action servers with this package's action type, as the master knows them."""
    master = rosgraph.Master(rospy.get_name())
    types = dict(master.getTopicTypes())
    publishers, _, _ = master.getSystemState()
    found = [topic[:-len(RESULT_SUFFIX)] for topic, nodes in publishers
             if nodes and topic.endswith(RESULT_SUFFIX) and types.get(topic) == RESULT_TYPE]
    return sorted(found)


def absence(action: str) -> str:
    """What to tell a person while the server `action` is missing, with those of the same type that do exist."""
    wanted = rospy.resolve_name(action)
    try:
        others = [name for name in names() if name != wanted]
    except (OSError, rosgraph.MasterException):
        return f"waiting for {action}; the ROS master does not answer"
    hint = ""
    if others:
        many = [name for name in others if name.endswith("/" + wanted.rpartition("/")[2])]
        hint = "; there is {} of the same type: {}".format(
            " and ".join(map(repr, others)), "which robot is meant?" if many else "a misspelt name?")
    return f"waiting for {action}{hint}"


def wait_or_explain(client: actionlib.ActionClient, action: str, timeout: float) -> str:
    """Empty when the server came up within `timeout` [s, wall]; otherwise why it may be missing."""
    started = time.monotonic()
    if wait_for(client, timeout):
        return ""
    return f"{absence(action)} ({time.monotonic() - started:.0f} s)"
