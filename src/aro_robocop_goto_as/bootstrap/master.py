"""Whether a ROS master and the simulator answer, asked by XML-RPC with timeouts.

As a program: exit status 1, with the reason on standard output, if no simulator may be started on ROS_MASTER_URI.
"""

import http.client
import os
import socket
import sys
import xml.parsers.expat
import xmlrpc.client
from typing import Any, Optional, cast

from ..errors import MasterError

DEFAULT_URI = "http://localhost:11311"  # roscore's port
TIMEOUT = 5.0  # [s, wall] without data, for each request; a healthy master answers in milliseconds
CALLER = "/robocop"
SIMULATOR = "/robocop_sim"
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
    """Whether there is a ROS master; MasterError if something that does not answer as a master has its port."""
    try:
        return ask_master(uri, "getPid") is not None
    except OSError:
        return False


def running_simulator(uri: str) -> Optional[str]:
    """A description of the simulator on this master, None if there is none; MasterError as above.

    The master also lists nodes that were killed, or that ended after reading a cached parameter (rospy's rosout does
    that), so the node itself is asked.
    """
    try:
        node = ask_master(uri, "lookupNode", SIMULATOR)
    except OSError:
        return None
    try:
        return None if node is None or _request(node, "getPid") is None else "a simulator is already running"
    except _TIMEOUTS:
        return f"a simulator that does not respond ({SIMULATOR} at {node}) is registered"
    except (OSError, *_FOREIGN):  # it has ended, or another program has got its port
        return None


def main() -> None:
    """Refuse a second simulator on the same master: nodes with the same name shut each other down.

    With --answers: exit status 1 if no master answers.
    """
    uri = master_uri()
    try:
        if sys.argv[1:] == ["--answers"]:
            sys.exit(0 if master_answers(uri) else 1)
        simulator = running_simulator(uri)
    except MasterError as error:
        print(error)
        sys.exit(1)
    if simulator:
        print(f"{simulator} on {uri}; stop it, or use another ROS_MASTER_URI")
        sys.exit(1)


if __name__ == "__main__":
    main()
