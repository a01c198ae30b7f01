"""A ROS master inside of the launcher's process.

roslaunch would start one as a process of its own, which takes as long to start as a node, and outlives a launcher that
is killed. It has imported rosmaster in any case, and uses a master that answers.
"""

import contextlib
import threading
from typing import Iterator

import rosgraph
from rosgraph.xmlrpc import XmlRpcNode
from rosmaster.master_api import NUM_WORKERS, ROSMasterHandler

from ...bootstrap import master
from ...errors import MasterError

POLL = 0.001  # [s, wall]


@contextlib.contextmanager
def inner_master(uri: str) -> Iterator[bool]:
    """Whether there is a master at this address for the block: not if one answers there or it is not this machine's.

    Then, or if another process has the port, roslaunch uses that master, or says why it can't.
    """
    host, port = rosgraph.network.parse_http_host_and_port(uri)
    if not rosgraph.network.is_local_address(host) or _is_taken(uri):
        yield False
        return
    failed = threading.Event()
    node = XmlRpcNode(port, ROSMasterHandler(NUM_WORKERS), on_run_error=lambda _: failed.set())
    node.start()
    while node.uri is None and not failed.wait(POLL):
        pass
    try:
        yield not failed.is_set()
    finally:
        node.shutdown("the launcher ends")


def _is_taken(uri: str) -> bool:
    """Whether a master answers there, or something else."""
    try:
        return master.master_answers(uri)
    except MasterError:
        return True
