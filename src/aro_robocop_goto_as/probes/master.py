"""Asks by XML-RPC, with timeouts, whether a ROS master, the simulator and other nodes answer."""

import http.client
import os
import socket
import xml.parsers.expat
import xmlrpc.client
from typing import Any, Dict, List, Optional, cast

from ..errors import MasterError
from ..names import SIMULATOR, absolute, robocop

DEFAULT_URI = "http://localhost:11311"  # roscore's port
TIMEOUT = 5.0  # [s, wall] without data, for each request; a healthy master answers in milliseconds
CALLER = "/robocop"
SUCCESS = 1  # first element of every answer in ROS' master and node API
_TIMEOUTS = (socket.timeout, TimeoutError)  # one class from Python 3.10 on
# What is raised if the answer is not XML-RPC, or not that of a ROS master or node.
_FOREIGN = (
    ConnectionResetError,
    http.client.HTTPException,
    xml.parsers.expat.ExpatError,
    xmlrpc.client.Error,
    TypeError,
    ValueError,
)


class _Transport(xmlrpc.client.Transport):
    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = TIMEOUT
        return connection


def _request(uri: str, method: str, *arguments: str) -> Any:
    """The value that a ROS master or node returns; None if it reports a failure.

    Raises one of _TIMEOUTS, another OSError if there is no connection, or one of _FOREIGN.
    """
    with xmlrpc.client.ServerProxy(uri, transport=_Transport()) as proxy:
        status, _, value = cast(Any, getattr(proxy, method)(CALLER, *arguments))
    return value if status == SUCCESS else None


def ask_master(uri: str, method: str, *arguments: str) -> Any:
    """The value that a ROS master returns for a request of its API; None if it reports a failure.

    OSError if there is no connection; MasterError if one is accepted, but not answered as a ROS master does.
    """
    try:
        return _request(uri, method, *arguments)
    except _TIMEOUTS:
        problem = f"did not answer within {TIMEOUT:g} s"
    except _FOREIGN:
        problem = "does not answer as a ROS master does"
    raise MasterError(
        f"{uri} {problem}: stop the process that uses this port (a hanging roscore?), or set another ROS_MASTER_URI"
    )


def master_uri() -> str:
    """The master that ROS programs started here would use."""
    return os.environ.get("ROS_MASTER_URI") or DEFAULT_URI


def master_answers(uri: str) -> bool:
    """Return whether there is a ROS master; MasterError if another kind of program has the master's port."""
    try:
        return ask_master(uri, "getPid") is not None
    except OSError:
        return False


def running_simulator(uri: str) -> Optional[str]:
    """A description of the simulator on this master, None if there is none; MasterError as above."""
    return running_node(uri, absolute("", SIMULATOR), "a simulator")


def running_node(uri: str, name: str, kind: str = "a node of this name") -> Optional[str]:
    """A description of the node of this name on this master, None if there is none; MasterError as above.

    The master also lists nodes that were killed, or that ended after reading a cached parameter (rospy's rosout does
    that), so the node itself is asked.
    """
    try:
        node = ask_master(uri, "lookupNode", name)
    except OSError:
        return None
    try:
        return None if node is None or _request(node, "getPid") is None else f"{kind} is already running"
    except _TIMEOUTS:
        remedy = f"{robocop()} shell rosnode cleanup removes it if it has ended"
        return f"{kind} that does not respond ({name} at {node}; {remedy}) is registered"
    except (OSError, *_FOREIGN):  # it has ended, or another program has got its port
        return None


def publishers(uri: str, *names: str) -> Dict[str, List[str]]:
    """The running nodes that publish these topics, in any namespace if a name has none; each node is asked.

    Topics without a running publisher are left out.

    OSError and MasterError as ask_master().
    """
    topics = (ask_master(uri, "getSystemState") or [[]])[0]
    found = {
        topic: [node for node in nodes if running_node(uri, node)]
        for topic, nodes in topics
        if topic in names or topic.rpartition("/")[2] in names
    }
    return {topic: nodes for topic, nodes in found.items() if nodes}


def unheard(uri: str, kind: str) -> List[str]:
    """The topics of this message type that have a publisher, but no subscriber.

    OSError and MasterError as ask_master().
    """
    published, subscribed, _ = ask_master(uri, "getSystemState") or ([], [], [])
    kinds = dict(ask_master(uri, "getTopicTypes") or [])
    heard = {topic for topic, _ in subscribed}
    return [topic for topic, _ in published if kinds.get(topic) == kind and topic not in heard]


def no_simulator(uri: str) -> str:
    """A message that no simulator runs; empty if one does, if a robot publishes odometry, or if no master answers.

    Odometry alone is not enough where /use_sim_time is set: without /clock, time stands still for the robot's nodes.
    """
    try:
        found = publishers(uri, "clock", "odom")
        stands = ask_master(uri, "getParam", "/use_sim_time") is True
        if "/clock" in found or (found and not stands):
            return ""
    except (OSError, MasterError):
        return ""
    without = (
        "; /use_sim_time is set, so time stands still without one (rosparam set /use_sim_time false ends that)"
        if stands
        else ""
    )
    return f"no simulator is running: {robocop()} run starts one{without}"
