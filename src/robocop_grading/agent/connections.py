"""rospy's connections without the network: to the grader, on the wire, and to the node itself. The ROS master, too.

rospy reaches the master and nodes by xmlrpc.client, and topics and services by TCPROSTransport. Both stay: requests
to the master, to the grader and to the node itself are answered here, and an End takes the place of a socket. So
latching, queue_size, _connection_header and the errors of wrong types are rospy's own, and all of this happens in no
simulated time.
"""

import _thread
import errno
import logging
import os
import select
import socket
import xmlrpc.client
from functools import partial
from types import SimpleNamespace
from typing import Any, Callable, Dict, List, Optional
from urllib.parse import urlsplit

from . import files
from .scheduler import NEVER, Waiter, scheduler

CLOCK = "/clock"
# What a node may ask its master: http://wiki.ros.org/ROS/Master_API, http://wiki.ros.org/ROS/Parameter%20Server%20API
MASTER_METHODS = (
    "registerService unregisterService registerSubscriber unregisterSubscriber registerPublisher unregisterPublisher "
    "lookupNode lookupService getPublishedTopics getTopicTypes getSystemState getUri getPid "
    "deleteParam setParam getParam searchParam subscribeParam unsubscribeParam hasParam getParamNames"
).split()
DELAY_STEP_NS = 250_000_000  # [ns] in which delays of messages are told; shorter ones are not
PROBES = 1000  # of its services at one time, see Grader
Header = Dict[str, str]  # of a connection, as on TCPROS


class End:
    """One end of a connection, in place of a socket: what has arrived, and where goes what is sent."""

    def __init__(self, send: Callable[[bytes], object], sends_header: bool = True) -> None:
        """Of what rospy sends, the first thing is the connection's header."""
        self._send, self._sends = send, sends_header
        self._data = bytearray()
        self._reader: Optional[Waiter] = None
        self.on_close: Callable[[], object] = lambda: None
        self.is_open = True
        self._since_ns = 0  # when what is not read yet began to arrive

    @property
    def waiting_ns(self) -> int:
        """How long the first of what is not read yet has waited."""
        return scheduler.now_ns - self._since_ns if self._data and self.is_open else 0

    def feed(self, data: bytes) -> None:
        """Something arrives."""
        with scheduler.guard:
            self._since_ns = self._since_ns if self._data else scheduler.now_ns
            self._data += data
            self._wake()

    def end(self) -> None:
        """Nothing else will arrive, and nobody hears what is sent."""
        with scheduler.guard:
            self.is_open = False
            self._wake()

    def _wake(self) -> None:
        if self._reader is not None and not self._reader.awake:
            scheduler.wake(self._reader)

    # -- what rospy uses of a socket --

    def recv(self, size: int) -> bytes:
        while True:
            with scheduler.guard:
                if self._data or not self.is_open:
                    data = bytes(self._data[:size])
                    del self._data[:size]
                    return data
                waiter = self._reader = scheduler.this_thread()
                scheduler.park(waiter, NEVER)
            scheduler.wait(waiter)

    def sendall(self, data: bytes) -> None:
        if not self.is_open:
            raise OSError(errno.EPIPE, os.strerror(errno.EPIPE))
        if self._sends:
            self._send(bytes(data))
        self._sends = True

    def fileno(self) -> None:
        """rospy polls for the ends of connections that have a number."""

    def getsockname(self) -> Any:
        return "localhost", 0

    def setblocking(self, *_: object) -> None:
        pass

    setsockopt = setblocking

    def close(self) -> None:
        if self.is_open:
            self.end()
            self.on_close()


class _AtOnce:
    """In place of the master's thread pool, whose threads look for work every 0.1 s."""

    def queue_task(self, _node: str, task: Callable[..., Any], arguments: Any) -> None:
        _thread.start_new_thread(task, arguments)


class Grader:
    """The node /robocop_sim, as rospy sees it: its API, its topics and its services.

    Its address is a port of which only rospy.wait_for_service() makes connections, and asks no more of them.
    """

    def __init__(
        self, publish: Callable[[str, bytes], object], call: Callable[[str, bytes], bytes], connections: List[Header]
    ) -> None:
        """`publish`: send what a topic's subscriber gets; `call`: a service's answer; `connections`: that it offers."""
        from rosmaster.master_api import ROSMasterHandler

        logging.getLogger("rosmaster.master").setLevel(logging.CRITICAL)  # it logs each call
        self._publish, self._call = publish, call
        self._port = socket.create_server(("localhost", 0), backlog=PROBES)
        self.port = self._port.getsockname()[1]
        self._uri = f"http://localhost:{self.port}/"
        self._master_host = urlsplit(os.environ["ROS_MASTER_URI"]).netloc
        master = ROSMasterHandler(0)
        master.thread_pool = master.reg_manager.thread_pool = _AtOnce()
        self.master: Any = SimpleNamespace(**{name: getattr(master, name) for name in MASTER_METHODS})
        self.node: Any = None  # rospy's handler of requests to the node itself
        self.tell_of_child: Callable[[], object] = lambda: None
        self.has_news = False  # the node has told the master something
        self.delays: Dict[str, float] = {}  # [s] by topic, of its messages until the node read them
        self._offered: Dict[str, Header] = {}  # topics that it publishes and services, by name
        self._wanted: Dict[str, Header] = {}  # topics that it subscribes to
        self._latched: Dict[str, bytes] = {}
        self._ends: Dict[str, List[End]] = {}  # of the node's subscriptions
        self._heard: Dict[str, End] = {}  # of the node's publications
        for header in connections:
            self.offer(header)

    def end_probes(self) -> None:
        """Close the connections that rospy.wait_for_service() has made, so that there is room for others."""
        while files.wait([(self._port.fileno(), select.POLLIN)], 0.0):
            self._port.accept()[0].close()

    def note_delays(self) -> None:
        """Note of which topics the messages wait longer than before."""
        for topic, ends in self._ends.items():
            steps = max((end.waiting_ns for end in ends), default=0) // DELAY_STEP_NS
            if steps * DELAY_STEP_NS > 1e9 * self.delays.get(topic, 0.0):
                self.delays[topic], self.has_news = steps * DELAY_STEP_NS / 1e9, True

    def offer(self, header: Header) -> None:
        """The grader publishes a topic, subscribes to it, or offers a service."""
        if "service" in header:
            self._offered[header["service"]] = header
            address = f"rosrpc://localhost:{self.port}"
            self.master.registerService(header["callerid"], header["service"], address, self._uri)
            return
        publishes = "latching" in header
        (self._offered if publishes else self._wanted)[header["topic"]] = header
        register = self.master.registerPublisher if publishes else self.master.registerSubscriber
        _, _, nodes = register(header["callerid"], header["topic"], header["type"], self._uri)
        if not publishes:
            self._heard.pop(header["topic"], None)  # a node that it has stopped to listen to is connected anew
            self.publisherUpdate("/master", header["topic"], nodes)

    def feed(self, topic: str, data: bytes) -> None:
        """It publishes a message."""
        if self._offered.get(topic, {}).get("latching") == "1":
            self._latched[topic] = data
        ends = self._ends.get(topic, [])
        ends[:] = [end for end in ends if end.is_open]
        for end in ends:
            end.feed(data)

    # -- its API, as the master and rospy call it --

    def publisherUpdate(self, _caller: str, topic: str, nodes: List[str]) -> Any:
        heard = self._heard.get(topic)
        if self.node is not None and self.node.uri in nodes and not (heard and heard.is_open):
            self._heard[topic] = End(partial(self._publish, topic), sends_header=False)
            self._heard[topic].feed(_encoded(self._wanted[topic]))
            _accept(self._heard[topic])
        return 1, "", 0

    def requestTopic(self, _caller: str, _topic: str, _protocols: object) -> Any:
        return 1, "", ["TCPROS", "localhost", self.port]

    # -- in place of the network --

    def api(self, host: str) -> Any:
        """What answers requests to an address; None if it is not known here."""
        if self.node is not None and host == urlsplit(self.node.uri or "").netloc:
            return self.node
        return {self._master_host: self.master, f"localhost:{self.port}": self}.get(host)

    def connect(self, protocol: Any) -> End:
        """The node's end of a connection to one of the grader's topics or services."""
        name, kind = protocol.resolved_name, getattr(protocol, "service_class", protocol.recv_data_class)
        header = self._offered.get(name, {"error": f"/robocop_sim does not publish {name}"})
        if header.get("md5sum", "*") != kind._md5sum != "*":
            header = {"error": f"types do not match: [{kind._type}] vs. [{header['type']}] of {name}"}
        end = End(lambda request: end.feed(self._call(name, request)), sends_header=False)
        end.feed(_encoded(header))
        if "topic" in header:
            end.feed(self._latched.get(name, b""))
            self._ends.setdefault(name, []).append(end)
        return end


def _encoded(header: Header) -> bytes:
    from rosgraph.network import encode_ros_handshake_header

    return bytes(encode_ros_handshake_header(header))


def _accept(end: End) -> None:
    """Have the node's server handle a connection, in a thread of its own."""
    from rospy.impl import tcpros_base

    _thread.start_new_thread(tcpros_base._tcpros_server._tcp_server_callback, (end, ("localhost", 0)))


def _to_itself() -> End:
    """The node's end of a connection to one of its own topics or services."""
    mine: End = End(lambda data: theirs.feed(data))
    theirs = End(mine.feed)
    mine.on_close, theirs.on_close = theirs.end, mine.end
    _accept(theirs)
    return mine


def _answer(api: Any, body: Any) -> Any:
    """What xmlrpc.client would get from a server."""
    arguments, method = xmlrpc.client.loads(body)
    function = None if str(method).startswith("_") else getattr(api, str(method), None)
    if function is None:  # as xmlrpc.server; such as system.multicall, by which rospy takes leave of the master
        raise xmlrpc.client.Fault(1, f"<class 'Exception'>:method \"{method}\" is not supported")
    result = function(*arguments)
    return xmlrpc.client.loads(xmlrpc.client.dumps((result,), methodresponse=True))[0]


def install(grader: Grader) -> None:
    """Have rospy use these connections."""
    import rospy
    from rosgraph.network import write_ros_handshake_header
    from rospy.impl import masterslave, tcpros_base

    cls: Any = xmlrpc.client.Transport
    request = cls.request

    def answered(transport: Any, host: Any, path: str, body: bytes, verbose: bool = False) -> Any:
        api = grader.api(host) if isinstance(host, str) else None
        if api is None:
            return request(transport, host, path, body, verbose)
        grader.has_news |= api is grader.master
        return _answer(api, body)

    cls.request = answered

    handler: Any = masterslave.ROSHandler
    make = handler.__init__

    def noted(self: Any, *arguments: Any, **options: Any) -> None:
        make(self, *arguments, **options)
        grader.node = self
        if not scheduler.active:
            grader.tell_of_child()

    handler.__init__ = noted

    transport: Any = tcpros_base.TCPROSTransport
    connect, write_header = transport.connect, transport.write_header

    def connected(self: Any, host: str, port: int, node: str, timeout: Optional[float] = None) -> None:
        if port == grader.port:
            self.socket = grader.connect(self.protocol)
        elif scheduler.active and grader.node is not None and port == tcpros_base.get_tcpros_server_address()[1]:
            self.socket = _to_itself()
        else:
            connect(self, host, port, node, timeout)
            return
        self.endpoint_id, self.dest_address = node, (host, port)
        self.write_header()
        self.read_header()

    def written(self: Any) -> None:
        if isinstance(self.socket, End):  # rospy polls until it can be written to
            self.stat_bytes += write_ros_handshake_header(self.socket, self.protocol.get_header_fields())
        else:
            write_header(self)

    transport.connect, transport.write_header = connected, written
    # A topic with a queue would have a thread for each subscriber, and drop messages if that is not scheduled in time.
    rospy.topics.QueuedConnection = lambda connection, _size: connection


def topics(grader: Grader) -> Dict[str, Any]:
    """What the node publishes and subscribes to: name, checksum and name of the type; nothing before init_node().

    Without rospy's locks, which a waiting thread may hold.
    """
    from rospy.topics import get_topic_manager

    manager = get_topic_manager()
    found = [
        [[name, it.data_class._md5sum, it.data_class._type] for name, it in list(topics.items()) if it.data_class]
        for topics in ((manager.pubs, manager.subs) if grader.node is not None else ({}, {}))
    ]
    return {"published": found[0], "subscribed": found[1]}
