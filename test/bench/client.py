"""The client of a measurement: a thread that reads topics, in which drain.c counts the messages.

It costs far less than rospy. Like roscpp, it requests a TCP connection from each publisher that the master knows.
https://wiki.ros.org/ROS/Master_API, https://wiki.ros.org/ROS/Slave_API
"""

import contextlib
import ctypes
import os
import select
import socket
import struct
import subprocess
import threading
import time
from pathlib import Path
from typing import Any, Dict, List, Mapping, Tuple
from xmlrpc.client import ServerProxy

import rosgraph
from rosgraph.network import decode_ros_handshake_header, write_ros_handshake_header

from aro_robocop_goto_as.geometry import NANOSECONDS

from . import BenchError

CALLER = f"/robocop_bench_client_{os.getpid()}"
TIMEOUT = 10  # [s, wall] for a publisher to answer
PAUSE = 1_000_000  # [ns, wall] between two rounds of reading
POLL = 0.02  # [s, wall]
MAX_FD = 4096
ROUNDING = 2  # [ns]


class Link(ctypes.Structure):
    """A connection, as in drain.c: its number of messages, the stamps [ns] of the first and the last, ..."""

    _fields_ = [
        *((name, ctypes.c_int64) for name in ("messages", "first_ns", "last_ns", "first_at", "left")),
        ("head", ctypes.c_uint32 * 4),
        *((name, ctypes.c_uint32) for name in ("filled", "open")),
    ]


def _compiled(directory: Path) -> Any:
    """The function of drain.c, compiled in this directory."""
    library, source = directory / "drain.so", Path(__file__).with_name("drain.c")
    if not library.exists():
        subprocess.run(["cc", "-std=c99", "-O2", "-shared", "-fPIC", "-o", str(library), str(source)], check=True)
    drain = ctypes.CDLL(str(library)).aro_drain  # unlike PyDLL's, its calls let other threads run
    drain.argtypes = [ctypes.c_int32, ctypes.c_int32, ctypes.c_void_p, ctypes.c_int64]
    return drain


class Client:
    """Reads its connections, one for each topic, in a thread that runs within the `with` block."""

    def __init__(self, topics: Mapping[str, int], directory: Path, uri: str) -> None:
        """`topics`: their rates [Hz]; none of them has a publisher yet. `uri`: the master's."""
        self.links: Dict[str, Link] = {}  # by topic
        self._rates, self._master = topics, rosgraph.Master(CALLER, uri)
        self._links = (Link * MAX_FD)()  # by the sockets' file descriptors
        self._sockets: List[socket.socket] = []  # not closed before the end, so that no descriptor is reused
        self._epoll = select.epoll()
        self._stop = socket.socketpair()
        self._epoll.register(self._stop[0], select.EPOLLIN)
        arguments = (self._epoll.fileno(), self._stop[0].fileno(), self._links, PAUSE)
        self._thread = threading.Thread(target=_compiled(directory), args=arguments, daemon=True)

    def __enter__(self) -> "Client":
        self._thread.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._stop[1].close()
        self._thread.join()
        for link in [self._stop[0], *self._sockets]:
            link.close()
        self._epoll.close()

    def reads_all(self) -> bool:
        """Connect to publishers that the master has come to know; return whether each topic has had a message."""
        if len(self.links) < len(self._rates):
            for topic, nodes in self._master.getSystemState()[0]:
                if topic in self._rates and topic not in self.links:
                    with contextlib.suppress(ConnectionRefusedError):  # a node that died without unregistering
                        self._add(topic, connect(self._master.lookupNode(nodes[0]), topic))
        return len(self.links) == len(self._rates) and all(link.first_at for link in self.links.values())

    def _add(self, topic: str, connection: socket.socket) -> None:
        link = self.links[topic] = self._links[connection.fileno()]
        link.open = 1
        self._sockets.append(connection)
        self._epoll.register(connection, select.EPOLLIN)

    @property
    def cpu(self) -> float:
        """Processor time [s] of its thread."""
        assert self._thread.ident is not None
        return time.clock_gettime(time.pthread_getcpuclockid(self._thread.ident))

    @property
    def newest_ns(self) -> int:
        """The latest stamp [ns] of any topic; BenchError on a message too short for a header."""
        if any(link.left < 0 for link in self.links.values()):
            raise BenchError("a message is too short for a header")
        return max(link.last_ns for link in self.links.values())

    def first_scan_at(self) -> float:
        """When the first scan had arrived [s] on the monotonic clock."""
        return min(link.first_at for topic, link in self.links.items() if topic.endswith("scan")) / NANOSECONDS

    def deliveries(self) -> Tuple[int, int]:
        """Numbers of messages expected and delivered, from each topic's first to the newest of all.

        Call it when all publishers have ended. Messages with the newest stamp are not counted: the simulator may have
        been ended while it sent them.
        """
        while any(link.open for link in self.links.values()):  # what they have sent waits in the sockets
            time.sleep(POLL)
        newest = self.newest_ns
        # Stamps are rounded down to nanoseconds: one that seems ROUNDING too early is the newest itself.
        spans = {topic: newest - link.first_ns - ROUNDING for topic, link in self.links.items()}
        expected = sum(max(0, -(-span * self._rates[topic] // NANOSECONDS)) for topic, span in spans.items())
        return expected, sum(link.messages - (link.last_ns == newest) for link in self.links.values())


def connect(publisher: str, topic: str) -> socket.socket:
    """Connect to a topic of the node at this URI and exchange headers; BenchError if the node refuses."""
    answer: Any = ServerProxy(publisher).requestTopic(CALLER, topic, [["TCPROS"]])
    code, message, protocol = answer
    if code != 1:
        raise BenchError(f"{publisher} refuses {topic}: {message}")
    link = socket.create_connection((protocol[1], protocol[2]))
    link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, struct.pack("ll", TIMEOUT, 0))
    write_ros_handshake_header(link, {"callerid": CALLER, "topic": topic, "type": "*", "md5sum": "*"})
    try:
        length = link.recv(4, socket.MSG_WAITALL)
        header = decode_ros_handshake_header(length + link.recv(struct.unpack("<I", length)[0], socket.MSG_WAITALL))
    except BlockingIOError as error:
        raise BenchError(f"{publisher} does not answer a subscriber of {topic} within {TIMEOUT} s") from error
    if "error" in header:
        raise BenchError(f"{publisher} refuses {topic}: {header['error']}")
    return link
