"""The client of a measurement: a thread that reads topics and counts the bytes of their messages.

It costs far less than rospy. Like roscpp, it requests a TCP connection from each publisher that the master knows.
https://wiki.ros.org/ROS/Master_API, https://wiki.ros.org/ROS/Slave_API, https://wiki.ros.org/ROS/TCPROS
"""

import contextlib
import io
import os
import selectors
import socket
import struct
import threading
import time
from typing import Any, Dict, Mapping, Tuple
from xmlrpc.client import ServerProxy

import rosgraph
from rosgraph.network import ROSHandshakeException, read_ros_handshake_header, write_ros_handshake_header
from waiting import wait_for

from aro_robocop_goto_as.geometry import NANOSECONDS

from . import BenchError

CALLER = f"/robocop_bench_client_{os.getpid()}"
TIMEOUT = 10  # [s, wall] for a publisher to answer
PAUSE = 0.001  # [s, wall] between two rounds of reading, so that it is not woken for every single message
POLL = 0.02  # [s, wall]
READ_SIZE = 1 << 18  # [bytes] per call
HEAD = struct.Struct("<IIII")  # length, and of the std_msgs/Header: seq, secs, nsecs
ROUNDING = 2  # [ns]


class Link:
    """A connection. All messages of one of its topics have the same length, so their number follows from the bytes."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self.is_open = True
        self.frame = 0  # [bytes] of a message with its length; 0 before the first one
        self.first_ns = 0  # stamp of the first message [ns]
        self.first_at = 0.0  # when it had arrived [s] on the monotonic clock
        self._read = 0, b""  # number of bytes, and the last two frames of them, changed at once

    def read(self) -> None:
        """Read what has arrived."""
        try:
            data = self.connection.recv(READ_SIZE)
        except ConnectionResetError:
            data = b""
        self.is_open = bool(data)
        size, tail = self._read
        self._read = size + len(data), (tail + data)[-2 * self.frame :]
        if not self.frame and len(self._read[1]) >= HEAD.size:
            length, _, secs, nsecs = HEAD.unpack_from(self._read[1])
            self.first_ns, self.first_at = secs * NANOSECONDS + nsecs, time.monotonic()
            self.frame = length + 4

    def newest(self) -> Tuple[int, int]:
        """The number of complete messages and the stamp [ns] of the last one, 0 and 0 before the first."""
        size, tail = self._read
        if not self.frame or size < self.frame:
            return 0, 0
        count, rest = divmod(size, self.frame)
        length, _, secs, nsecs = HEAD.unpack_from(tail, len(tail) - rest - self.frame)
        if length + 4 != self.frame:
            raise BenchError(f"messages of one topic have {self.frame - 4} and {length} bytes")
        return count, secs * NANOSECONDS + nsecs


class Client:
    """Reads its connections, one for each topic, in a thread that runs within the `with` block."""

    def __init__(self, topics: Mapping[str, int], uri: str) -> None:
        """`topics`: their rates [Hz]; none of them has a publisher yet. `uri`: the master's."""
        self.links: Dict[str, Link] = {}  # by topic
        self._rates, self._master = topics, rosgraph.Master(CALLER, uri)
        self._selector = selectors.DefaultSelector()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> "Client":
        self._thread.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._ended.set()
        self._thread.join()
        for link in self.links.values():
            link.connection.close()
        self._selector.close()

    def _run(self) -> None:
        while not self._ended.wait(PAUSE):
            for key, _ in self._selector.select(POLL):
                key.data.read()
                if not key.data.is_open:
                    self._selector.unregister(key.fileobj)

    def reads_all(self) -> bool:
        """Connect to publishers that the master has come to know; return whether each topic has had a message."""
        if len(self.links) < len(self._rates):
            for topic, nodes in self._master.getSystemState()[0]:
                if topic in self._rates and topic not in self.links:
                    with contextlib.suppress(ConnectionRefusedError):  # a node that died without unregistering
                        link = self.links[topic] = Link(connect(self._master.lookupNode(nodes[0]), topic))
                        self._selector.register(link.connection, selectors.EVENT_READ, link)
        return len(self.links) == len(self._rates) and all(link.newest()[0] for link in self.links.values())

    @property
    def cpu(self) -> float:
        """Processor time [s] of its thread."""
        assert self._thread.ident is not None
        return time.clock_gettime(time.pthread_getcpuclockid(self._thread.ident))

    @property
    def newest_ns(self) -> int:
        """The latest stamp [ns] of any topic."""
        return max(link.newest()[1] for link in self.links.values())

    def first_scan_at(self) -> float:
        """When the first scan had arrived [s] on the monotonic clock."""
        return min(link.first_at for topic, link in self.links.items() if topic.endswith("scan"))

    def deliveries(self) -> Tuple[int, int]:
        """Numbers of messages expected and delivered, from each topic's first to the newest of all.

        Call it when all publishers have ended. Messages with the newest stamp are not counted: the simulator may have
        been ended while it sent them.
        """
        what = "the end of all connections"  # what their publishers have sent waits in the sockets
        wait_for(lambda: not any(link.is_open for link in self.links.values()), what, poll=POLL, error=BenchError)
        newest, expected, delivered = self.newest_ns, 0, 0
        for topic, link in self.links.items():
            # Stamps are rounded down to nanoseconds: one that seems ROUNDING too early is the newest itself.
            span = newest - link.first_ns - ROUNDING
            expected += max(0, -(-span * self._rates[topic] // NANOSECONDS))
            count, stamp = link.newest()
            delivered += count - (stamp == newest)
        return expected, delivered


def connect(publisher: str, topic: str) -> socket.socket:
    """Connect to a topic of the node at this URI and exchange headers; BenchError if the node refuses."""
    proxy: Any = ServerProxy(publisher)
    code, message, protocol = proxy.requestTopic(CALLER, topic, [["TCPROS"]])
    if code != 1:
        raise BenchError(f"{publisher} refuses {topic}: {message}")
    link = socket.create_connection(protocol[1:3], TIMEOUT)
    write_ros_handshake_header(link, {"callerid": CALLER, "topic": topic, "type": "*", "md5sum": "*"})
    try:
        header = read_ros_handshake_header(link, io.BytesIO(), 1)  # a byte at a time: the first message follows
    except (socket.timeout, ROSHandshakeException) as error:
        raise BenchError(f"{publisher} does not answer a subscriber of {topic}: {error}") from error
    if "error" in header:
        raise BenchError(f"{publisher} refuses {topic}: {header['error']}")
    return link
