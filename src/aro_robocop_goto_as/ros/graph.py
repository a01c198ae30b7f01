"""The ROS graph by rosgraph: whether the master and nodes answer, and published topics."""

import http.client
import socket
import xml.parsers.expat
import xmlrpc.client
from dataclasses import dataclass
from typing import Any, Dict, List, Tuple

import rosgraph

from ..errors import MasterError
from ..names import robocop

CALLER = "/robocop"
TIMEOUT = 5.0  # [s, wall] without data, for each request; a healthy master answers in milliseconds
# What rosgraph raises if the answer is not that of a ROS master or node.
FOREIGN = (http.client.HTTPException, xml.parsers.expat.ExpatError, xmlrpc.client.Error, TypeError, ValueError)


@dataclass(frozen=True)
class Topic:
    """A topic with its message type ("" when the master does not know it) and the names of its publishers."""

    name: str
    type: str
    publishers: Tuple[str, ...]


def _ask(uri: str, method: str, *arguments: str) -> Any:
    """What a master or node answers; OSError if there is none, rosgraph.MasterException if its answer is an error.

    MasterError if something else answers, or nothing within TIMEOUT.
    """
    before = socket.getdefaulttimeout()
    socket.setdefaulttimeout(TIMEOUT)  # as rosnode does; rosgraph has no timeout
    try:
        return getattr(rosgraph.Master(CALLER, uri), method)(*arguments)
    except (socket.timeout, TimeoutError):  # one class from Python 3.10 on
        problem = f"did not answer within {TIMEOUT:g} s"
    except FOREIGN:
        problem = "does not answer as a ROS master does"
    finally:
        socket.setdefaulttimeout(before)
    raise MasterError(
        f"{uri} {problem}: stop the process that uses this port (a hanging roscore?), or set another ROS_MASTER_URI"
    )


def master_answers() -> bool:
    """Return whether there is a ROS master; MasterError if another kind of program has the master's port."""
    try:
        return bool(_ask(rosgraph.get_master_uri(), "getPid"))
    except (OSError, rosgraph.MasterException):
        return False


def running_node(name: str, kind: str = "a node of this name") -> str:
    """A description of the node of this name, empty if there is none; MasterError as above.

    The master also lists nodes that were killed, or that ended after reading a cached parameter (rospy's rosout does
    that), so the node itself is asked.
    """
    node = ""
    try:
        node = _ask(rosgraph.get_master_uri(), "lookupNode", name)
        _ask(node, "getPid")
    except (OSError, rosgraph.MasterException):
        return ""
    except MasterError:
        if not node:
            raise
        remedy = f"{robocop()} shell rosnode cleanup removes it if it has ended"
        return f"{kind} that does not respond ({name} at {node}; {remedy}) is registered"
    return f"{kind} is already running"


def published_topics() -> List[Topic]:
    """All topics that have a publisher, by name; OSError or rosgraph.MasterException when the master does not answer.

    The master also lists nodes that were killed and could not unregister.
    """
    master = rosgraph.Master(CALLER)
    types = dict(master.getTopicTypes())
    publishers, _, _ = master.getSystemState()
    return sorted(
        (Topic(name, types.get(name, ""), tuple(nodes)) for name, nodes in publishers if nodes),
        key=lambda topic: topic.name,
    )


def running_publishers(*names: str) -> Dict[str, List[str]]:
    """The running nodes that publish these topics, in any namespace; errors as those of the two above."""
    found = {
        topic.name: [node for node in topic.publishers if running_node(node)]
        for topic in published_topics()
        if topic.name.rpartition("/")[2] in names
    }
    return {topic: nodes for topic, nodes in found.items() if nodes}


def no_simulator() -> str:
    """A message that no simulator runs; empty if one does, if a robot publishes odometry, or if no master answers.

    Odometry alone is not enough where /use_sim_time is set: without /clock, time stands still for the robot's nodes.
    """
    try:
        found = running_publishers("clock", "odom")
        master = rosgraph.Master(CALLER)
        stands = master.hasParam("/use_sim_time") and master.getParam("/use_sim_time") is True
    except (OSError, rosgraph.MasterException, MasterError):
        return ""
    if "/clock" in found or (found and not stands):
        return ""
    remedy = "; /use_sim_time is set, so time stands still without one (rosparam set /use_sim_time false ends that)"
    return f"no simulator is running: {robocop()} run starts one{remedy if stands else ''}"
