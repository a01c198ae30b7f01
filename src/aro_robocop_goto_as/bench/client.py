"""The client of a measurement: a thread that reads topics, in which drain.c counts the messages.

It costs far less than rospy. Like roscpp, it registers with the master, which announces publishers, and requests a TCP
connection from each. https://wiki.ros.org/ROS/Master_API, https://wiki.ros.org/ROS/Slave_API
"""

import contextlib
import ctypes
import os
import select
import socket
import struct
import threading
import time
from typing import Any, Dict, Iterator, List, Mapping, Set, Tuple
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer

import rosgraph
from rosgraph.network import decode_ros_handshake_header, write_ros_handshake_header

from .. import compiled
from ..errors import BenchError
from ..simulation.schedule import NANOSECONDS

VERSION = 1  # of drain.c
CALLER = f"/robocop_bench_client_{os.getpid()}"
TIMEOUT = 10  # [s, wall] for a publisher to answer
PAUSE = 1_000_000  # [ns, wall] between two rounds of reading
POLL = 0.02  # [s, wall]
LARGEST_FD = 4096
ROUNDING = 2  # [ns]


class Link(ctypes.Structure):
    """A connection, as in drain.c: its number of messages, the stamps [ns] of the first and the last, ..."""

    _fields_ = [
        *((name, ctypes.c_int64) for name in ("messages", "first_ns", "last_ns", "first_at", "left")),
        ("head", ctypes.c_uint32 * 4),
        *((name, ctypes.c_uint32) for name in ("filled", "open")),
    ]


class Client:
    """Reads its connections, one for each topic, in a thread that runs within the `with` block."""

    def __init__(self) -> None:
        compiled.load("drain", VERSION)
        drain = ctypes.CDLL(compiled.find("drain")).aro_drain  # unlike PyDLL's, its calls let other threads run
        drain.argtypes = [ctypes.c_int32, ctypes.c_int32, ctypes.c_void_p, ctypes.c_int64]
        self.links: Dict[str, Link] = {}  # by topic
        self._links = (Link * LARGEST_FD)()  # by the sockets' file descriptors
        self._sockets: List[socket.socket] = []  # not closed before the end, so that no descriptor is reused
        self._epoll = select.epoll()
        self._stop = socket.socketpair()
        self._epoll.register(self._stop[0], select.EPOLLIN)
        arguments = (self._epoll.fileno(), self._stop[0].fileno(), self._links, PAUSE)
        self._thread = threading.Thread(target=drain, args=arguments, daemon=True)

    def __enter__(self) -> "Client":
        self._thread.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._stop[1].close()
        self._thread.join()
        for link in [self._stop[0], *self._sockets]:
            link.close()
        self._epoll.close()

    def add(self, topic: str, connection: socket.socket) -> None:
        """Count the messages of this connection from now on."""
        link = self._links[connection.fileno()]
        link.open = 1
        self._sockets.append(connection)
        self.links[topic] = link
        self._epoll.register(connection, select.EPOLLIN)

    @property
    def cpu(self) -> float:
        """Processor time [s] of its thread."""
        assert self._thread.ident is not None
        return time.clock_gettime(time.pthread_getcpuclockid(self._thread.ident))

    @property
    def newest_ns(self) -> int:
        """The latest stamp [ns] of any topic; 0 if there is none. BenchError on a message too short for a header."""
        links = self.links.copy()  # a publisher may be announced meanwhile
        if any(link.left < 0 for link in links.values()):
            raise BenchError("a message is too short for a header")
        return max((link.last_ns for link in links.values()), default=0)

    def first_at(self) -> Dict[str, float]:
        """When the first message of each topic had arrived [s] on the monotonic clock; without silent topics."""
        return {topic: link.first_at / NANOSECONDS for topic, link in self.links.copy().items() if link.first_at}

    def deliveries(self, rates: Mapping[str, int]) -> Tuple[int, int]:
        """Numbers of messages expected and delivered on topics with these rates [Hz], from each first to the newest.

        Call it when all publishers have ended. Messages with the newest stamp are not counted: the simulator may have
        been ended while it sent them.
        """
        while any(link.open for link in self.links.values()):  # what they have sent waits in the sockets
            time.sleep(POLL)
        newest = self.newest_ns
        links = {topic: link for topic, link in self.links.items() if link.messages}
        # Stamps are rounded down to nanoseconds: one that seems ROUNDING too early is the newest itself.
        spans = {topic: newest - link.first_ns - ROUNDING for topic, link in links.items()}
        expected = sum(max(0, -(-span * rates[topic] // NANOSECONDS)) for topic, span in spans.items())
        return expected, sum(link.messages - (link.last_ns == newest) for link in links.values())


def connect(publisher: str, topic: str) -> socket.socket:
    """Connect to a topic of the node at this URI and exchange headers; BenchError if the node refuses."""
    answer: Any = ServerProxy(publisher).requestTopic(CALLER, topic, [["TCPROS"]])
    code, message, protocol = answer
    if code != 1:
        raise BenchError(f"{publisher} refuses {topic}: {message}")
    link = socket.create_connection((protocol[1], protocol[2]))
    link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, struct.pack("ll", TIMEOUT, 0))
    write_ros_handshake_header(link, {"callerid": CALLER, "topic": topic, "type": "*", "md5sum": "*"})
    length = link.recv(4, socket.MSG_WAITALL)
    (size,) = struct.unpack("<I", length)
    header = decode_ros_handshake_header(length + link.recv(size, socket.MSG_WAITALL))
    if "error" in header:
        link.close()
        raise BenchError(f"{publisher} refuses {topic}: {header['error']}")
    return link


@contextlib.contextmanager
def subscribed(topics: List[str]) -> Iterator[Client]:
    """A client that connects to every publisher of the topics, as the master announces them."""
    known: Set[Tuple[str, str]] = set()

    def publisher_update(_caller: str, topic: str, publishers: List[str]) -> Tuple[int, str, int]:
        for publisher in publishers:
            if (topic, publisher) not in known:
                known.add((topic, publisher))
                with contextlib.suppress(ConnectionRefusedError):  # a node that died without unregistering
                    client.add(topic, connect(publisher, topic))
        return 1, "", 0

    master = rosgraph.Master(CALLER)
    with Client() as client, SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as server:
        server.register_function(publisher_update, "publisherUpdate")  # type: ignore[arg-type]
        uri = f"http://127.0.0.1:{server.server_address[1]}/"
        for topic in topics:
            publisher_update("", topic, master.registerSubscriber(topic, "*", uri))
        threading.Thread(target=server.serve_forever, args=(POLL,), daemon=True).start()
        try:
            yield client
        finally:
            for topic in topics:
                master.unregisterSubscriber(topic, uri)
            server.shutdown()
