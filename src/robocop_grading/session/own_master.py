"""A ROS master in this process: as one of its own it takes as long to start as a node, and may outlive this one."""

import threading
from typing import Optional

from rosgraph.xmlrpc import XmlRpcNode
from rosmaster.master_api import NUM_WORKERS, ROSMasterHandler

POLL = 0.001  # [s, wall]


def start_master(port: int) -> Optional[XmlRpcNode]:
    """Start a master at a port of this machine; None if another process has the port."""
    failed = threading.Event()
    master = XmlRpcNode(port, ROSMasterHandler(NUM_WORKERS), on_run_error=lambda _: failed.set())
    master.start()
    while master.uri is None and not failed.wait(POLL):
        pass
    return None if failed.is_set() else master
