"""Whether a ROS system can run with the master and addresses that the environment names."""

import contextlib
import os
import socket
from typing import List, Tuple
from urllib.parse import urlsplit

import rosgraph

from ..errors import MasterError
from ..names import COMMAND_VARIABLE
from . import graph

MASTER = "ROS_MASTER_URI"
# The address of this machine for other nodes; ROS takes the first one that is set.
OWN_NAMES = ("ROS_HOSTNAME", "ROS_IP")


def problem() -> str:
    """Why no ROS system can be started or used with these settings, and what to do; empty if one can."""
    uri = rosgraph.get_master_uri()
    try:
        host = urlsplit(uri).hostname if urlsplit(uri).port and uri.startswith("http") else None
    except ValueError:  # no such port
        host = None
    if not host:
        return f"{MASTER}={uri} is no address of a ROS master; expected http://HOST:PORT. {_without([MASTER])}"
    named = [(name, os.environ[name]) for name in OWN_NAMES if os.environ.get(name)]
    foreign = [name for name, value in named if not is_own(value)]
    if not is_own(host):
        with_master = _without([MASTER, *foreign])
        if not _answers():
            return f"no ROS master answers at {uri}, which is another machine or an unknown name. {with_master}"
        if named and is_loopback(named[0][1]):
            own = "=".join(named[0])
            return f"{own} can't be reached by {host}, where {MASTER} is: set this machine's address in that network"
    if named and named[0][0] in foreign:
        own = "=".join(named[0])
        return (
            f"{own} is no address of this machine, so nodes that are started here can't be reached. {_without(foreign)}"
        )
    return ""


def _without(names: List[str]) -> str:
    """What to do about variables that were probably set for a real robot."""
    if os.environ.get(COMMAND_VARIABLE):
        return f"For the lab in this container: start it without -e {' and -e '.join(names)}"
    return f"For the lab on this machine: unset {' '.join(names)} (a line in ~/.bashrc may set it again)"


def _answers() -> bool:
    with contextlib.suppress(MasterError):
        return graph.master_answers()
    return False


def _addresses(host: str) -> List[Tuple[socket.AddressFamily, Tuple[object, ...]]]:
    with contextlib.suppress(OSError, UnicodeError):
        return [(entry[0], entry[4]) for entry in socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)]
    return []


def is_own(host: str) -> bool:
    """Return whether a name or address is one of this machine's: a socket can be bound to it."""
    for family, address in _addresses(host):
        with contextlib.suppress(OSError), socket.socket(family, socket.SOCK_STREAM) as probe:
            probe.bind(address)
            return True
    return False


def is_loopback(host: str) -> bool:
    """Return whether a name or address is reached from this machine only."""
    return all(str(address[0]).startswith(("127.", "::1")) for _, address in _addresses(host))
