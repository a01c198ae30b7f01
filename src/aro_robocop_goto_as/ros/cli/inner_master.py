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
def inner_master(uri: str) -> Iterator[None]:
    """A master at this address for the block, unless one answers there or it is not this machine's.

    Then, or if another process has the port, roslaunch uses that master, or says why it can't.
    """
    host, port = rosgraph.network.parse_http_host_and_port(uri)
    with contextlib.suppress(MasterError):
        if rosgraph.network.is_local_address(host) and not master.master_answers(uri):
            failed = threading.Event()
            node = XmlRpcNode(port, ROSMasterHandler(NUM_WORKERS), on_run_error=lambda _: failed.set())
            node.start()
            while node.uri is None and not failed.wait(POLL):
                pass
            try:
                yield
            finally:
                node.shutdown("the launcher ends")
            return
    yield
