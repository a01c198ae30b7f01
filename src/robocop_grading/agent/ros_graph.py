"""The ROS graph as the node sees it: the node /robocop_sim, with its topics and services, and the ROS master."""

import _thread
import logging
import os
import select
import socket
from functools import partial
from types import SimpleNamespace
from typing import Any, Callable, Dict, List
from urllib.parse import urlsplit

from . import files
from .memory_socket import Header, MemorySocket, accept, encoded

CLOCK = "/clock"
# What a node may ask its master: http://wiki.ros.org/ROS/Master_API, http://wiki.ros.org/ROS/Parameter%20Server%20API
MASTER_METHODS = (
    "registerService unregisterService registerSubscriber unregisterSubscriber registerPublisher unregisterPublisher "
    "lookupNode lookupService getPublishedTopics getTopicTypes getSystemState getUri getPid "
    "deleteParam setParam getParam searchParam subscribeParam unsubscribeParam hasParam getParamNames"
).split()
DELAY_STEP_NS = 250_000_000  # [ns] in which delays of messages are told; shorter ones are not
MAX_PROBES = 1000  # connections of rospy.wait_for_service() between two answers


class _AtOnce:
    """In place of the master's thread pool, whose threads look for work every 0.1 s."""

    def queue_task(self, _node: str, task: Callable[..., Any], arguments: Any) -> None:
        _thread.start_new_thread(task, arguments)


class SimulatorProxy:
    """Stands for the node /robocop_sim in the node's process: its API, its topics and its services, as rospy sees them.

    Only rospy.wait_for_service() connects to its port; it sends nothing.
    """

    def __init__(
        self, publish: Callable[[str, bytes], object], call: Callable[[str, bytes], bytes], connections: List[Header]
    ) -> None:
        """`publish` sends a topic's message, `call` returns a service's answer; `connections`: their headers."""
        from rosmaster.master_api import ROSMasterHandler

        logging.getLogger("rosmaster.master").setLevel(logging.CRITICAL)  # it logs each call
        self._publish, self._call = publish, call
        self._port = socket.create_server(("localhost", 0), backlog=MAX_PROBES)
        self.port = self._port.getsockname()[1]
        self._uri = f"http://localhost:{self.port}/"
        self._master_host = urlsplit(os.environ["ROS_MASTER_URI"]).netloc
        master = ROSMasterHandler(0)
        master.thread_pool = master.reg_manager.thread_pool = _AtOnce()
        self.master: Any = SimpleNamespace(**{name: getattr(master, name) for name in MASTER_METHODS})
        self.node: Any = None  # rospy's handler of requests to the node itself
        self.has_news = False  # the node has told the master something
        self.delays: Dict[str, float] = {}  # [s] by topic, of its messages until the node read them
        self._offered: Dict[str, Header] = {}  # topics that it publishes and services, by name
        self._wanted: Dict[str, Header] = {}  # topics that it subscribes to
        self._latched: Dict[str, bytes] = {}
        self._ends: Dict[str, List[MemorySocket]] = {}  # of the node's subscriptions
        self._heard: Dict[str, MemorySocket] = {}  # of the node's publications
        for header in connections:
            self.offer(header)

    def end_probes(self) -> None:
        """Close the connections that rospy.wait_for_service() has made, so that there is room for others."""
        while files.wait([(self._port.fileno(), select.POLLIN)], 0.0):
            self._port.accept()[0].close()

    def note_delays(self) -> None:
        """Note the topics whose messages have waited longer than ever before."""
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
            self._heard.pop(header["topic"], None)  # forget the old connection, so that a new one is made
            self.publisherUpdate("/master", header["topic"], nodes)

    def feed(self, topic: str, data: bytes) -> None:
        """The grader publishes a message."""
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
            self._heard[topic] = MemorySocket(partial(self._publish, topic), sends_header=False)
            self._heard[topic].feed(encoded(self._wanted[topic]))
            accept(self._heard[topic])
        return 1, "", 0

    def requestTopic(self, _caller: str, _topic: str, _protocols: object) -> Any:
        return 1, "", ["TCPROS", "localhost", self.port]

    # -- in place of the network --

    def api(self, host: str) -> Any:
        """The object that answers requests to an address; None if the address is not known here."""
        if self.node is not None and host == urlsplit(self.node.uri or "").netloc:
            return self.node
        return {self._master_host: self.master, f"localhost:{self.port}": self}.get(host)

    def connect(self, protocol: Any) -> MemorySocket:
        """The node's end of a connection to one of the grader's topics or services."""
        name, kind = protocol.resolved_name, getattr(protocol, "service_class", protocol.recv_data_class)
        header = self._offered.get(name, {"error": f"/robocop_sim does not publish {name}"})
        if header.get("md5sum", "*") != kind._md5sum != "*":
            header = {"error": f"types do not match: [{kind._type}] vs. [{header['type']}] of {name}"}
        end = MemorySocket(lambda request: end.feed(self._call(name, request)), sends_header=False)
        end.feed(encoded(header))
        if "topic" in header:
            end.feed(self._latched.get(name, b""))
            self._ends.setdefault(name, []).append(end)
        return end
