"""Topics -> connections to their publishers, by ROS's protocol but without rospy, which would cost more CPU time.

As in roscpp: it registers with the master, which announces publishers, and requests a TCP connection from each.
https://wiki.ros.org/ROS/Master_API, https://wiki.ros.org/ROS/Slave_API
"""

import contextlib
import os
import socket
import struct
import threading
from typing import Any, Callable, Dict, List, Set, Tuple
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer

from ..errors import BenchError

CALLER = f"/robocop_bench_client_{os.getpid()}"
TIMEOUT = 10.0  # [s, wall] for a publisher to answer
POLL = 0.05  # [s, wall]
Answer = Tuple[int, str, int]  # of every call of ROS's API: 1 for success, a message, a value


def encode_header(fields: Dict[str, str]) -> bytes:
    """A connection header: its length, then for each field a length and NAME=VALUE."""
    body = b""
    for name, value in fields.items():
        entry = f"{name}={value}".encode()
        body += struct.pack("<I", len(entry)) + entry
    return struct.pack("<I", len(body)) + body


def decode_header(body: bytes) -> Dict[str, str]:
    """The fields of a connection header without its leading length."""
    fields, at = {}, 0
    while at < len(body):
        (length,) = struct.unpack_from("<I", body, at)
        name, _, value = body[at + 4 : at + 4 + length].decode().partition("=")
        fields[name] = value
        at += 4 + length
    return fields


def connect(publisher: str, topic: str) -> socket.socket:
    """Connect to a topic of the node at this URI and exchange headers; BenchError if the node refuses."""
    answer: Any = ServerProxy(publisher).requestTopic(CALLER, topic, [["TCPROS"]])
    code, message, protocol = answer
    if code != 1:
        raise BenchError(f"{publisher} refuses {topic}: {message}")
    link = socket.create_connection((protocol[1], protocol[2]), TIMEOUT)
    try:
        link.sendall(encode_header({"callerid": CALLER, "topic": topic, "type": "*", "md5sum": "*"}))
        (length,) = struct.unpack("<I", _exactly(link, 4))
        answer = decode_header(_exactly(link, length))
    except BaseException:
        link.close()
        raise
    if "error" in answer:
        link.close()
        raise BenchError(f"{publisher} refuses {topic}: {answer['error']}")
    return link


def _exactly(link: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        piece = link.recv(size - len(data))
        if not piece:
            raise BenchError("the publisher closed the connection before the end of its header")
        data += piece
    return data


class Subscription:
    """Calls `on_connection`, in a thread, with a connection to each publisher of the topics, until it is closed."""

    def __init__(self, master: str, topics: List[str], on_connection: Callable[[str, socket.socket], None]) -> None:
        self._master = master
        self._topics = topics
        self._on_connection = on_connection
        self._known: Set[Tuple[str, str]] = set()
        self._server = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
        self._server.register_function(self._publisher_update, "publisherUpdate")  # type: ignore[arg-type]
        self._uri = f"http://127.0.0.1:{self._server.server_address[1]}/"
        for topic in topics:
            answer: Any = ServerProxy(master).registerSubscriber(CALLER, topic, "*", self._uri)
            code, message, publishers = answer
            if code != 1:
                raise BenchError(f"the master refuses {topic}: {message}")
            self._publisher_update("", topic, publishers)
        threading.Thread(target=self._server.serve_forever, args=(POLL,), daemon=True).start()

    def _publisher_update(self, _caller: str, topic: str, publishers: List[str]) -> Answer:
        """Called by the master. Connections to publishers that are gone end by themselves."""
        for publisher in publishers:
            if (topic, publisher) not in self._known:
                self._known.add((topic, publisher))
                with contextlib.suppress(ConnectionRefusedError):  # a node that died without unregistering
                    self._on_connection(topic, connect(publisher, topic))
        return 1, "", 0

    def close(self) -> None:
        """Unregister from the master."""
        self._server.shutdown()
        for topic in self._topics:
            ServerProxy(self._master).unregisterSubscriber(CALLER, topic, self._uri)
