"""What the grader's process uses of private parts of rospy, rosbag and actionlib, each with the reason."""

import contextlib
import functools
import socket
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, Callable, Dict, Iterator, List, Optional, Set, Tuple

import actionlib
import rospy
from rospy.impl import tcpros_base

Link = Tuple[int, int]  # a TCP connection, by the node's port and this process's
_handled: Dict[Link, int] = {}  # bytes received and made use of
_received: Dict[Link, int] = {}
_updates: "List[Future[Any]]" = []  # calls of nodes by the master that may not have returned yet


def install() -> None:
    """Count what this process receives, and publish nothing from threads: what publish() returns from is sent.

    rospy's own statistics leave out a connection's header, and do not tell when a message's callback has returned.
    """
    receive: Any = socket.socket.recv

    def recv(connection: socket.socket, *arguments: Any) -> bytes:
        try:
            link = (connection.getpeername()[1], connection.getsockname()[1])
        except (OSError, IndexError):  # it is closed, or no TCP connection
            return bytes(receive(connection, *arguments))
        _handled[link] = _received.setdefault(link, 0)  # a thread that asks for more is done with what it had
        data = b""
        try:
            data = receive(connection, *arguments)
            _received[link] = _received.get(link, 0) + len(data)
        finally:
            if not data:  # the other side has ended the connection, and the thread is done with all that came before
                _handled.pop(link, None)
                _received.pop(link, None)
        return data

    setattr(socket, "setdefaulttimeout", lambda _: None)  # noqa: B010  rospy would give the master and nodes 60 s
    setattr(socket.socket, "recv", recv)  # noqa: B010  mypy refuses to assign to a method
    rospy.topics.QueuedConnection = lambda connection, _size: connection


class _Updater:
    """In place of the master's thread pool, whose threads look for work every 0.1 s and do not tell when it is done."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1)  # one thread: in the order in which the nodes have called

    def queue_task(self, _node: str, task: Callable[..., Any], arguments: Tuple[Any, ...]) -> None:
        _updates[:] = [update for update in _updates if not update.done()]
        _updates.append(self._thread.submit(task, *arguments))


def update_at_once(master: Any) -> None:
    """Have a master of this process call nodes about new topics and parameters without delay."""
    master.thread_pool.join_all(wait_for_tasks=False, wait_for_threads=False)
    master.thread_pool = master.reg_manager.thread_pool = _Updater()


def all_updated() -> bool:
    """Return whether the master has called all nodes about the topics and parameters that it has been told of."""
    return all(update.done() for update in list(_updates))


def set_time(now_ns: int) -> None:
    """Set this process's rospy time, by which actionlib stamps messages, without a subscription to /clock."""
    rospy.rostime._set_rostime(rospy.Time(0, now_ns))


def shutdown_has_begun() -> bool:
    """Whether shutdown was requested; rospy.is_shutdown() turns true only after the on_shutdown hooks."""
    return bool(rospy.core.is_shutdown_requested())


def raw(kind: Any, body: bytes) -> Tuple[str, bytes, str, Any]:
    """A serialized message as rosbag.Bag.write() takes it."""
    return kind._type, body, kind._md5sum, kind


def handled(link: Link) -> int:
    """How many bytes of a subscription's connection have been received, and have had their callbacks; else -1.

    Of one that a subscriber of this process's topics has made, only the header is ever received.
    """
    return -1 if link[1] == ports()[1] else _handled.get(link, -1)


def hears_from(node: str) -> bool:
    """Whether a topic of a node's is connected, or something that came from it has not had its callbacks yet.

    rospy closes a connection that the other side has ended when it has made use of all that came before.
    """
    return any(
        connection.socket is not None and connection.callerid_pub == node
        for subscription in list(_topics().subs.values())
        for connection in subscription.connections
    )


@functools.lru_cache(maxsize=None)
def ports() -> List[int]:
    """The ports at which other nodes reach this one: its XML-RPC server's and its topics' and services'."""
    return [int(rospy.get_node_uri().rpartition(":")[2].strip("/")), tcpros_base.get_tcpros_server_address()[1]]


def sent() -> Iterator[Tuple[Link, int]]:
    """Each connection on which this process publishes, with the number of bytes sent."""
    for topic in list(_topics().pubs.values()):
        for connection in topic.connections:
            link = _link(connection)
            if link is not None:
                yield link, connection.stat_bytes


def _topics() -> Any:
    return rospy.topics.get_topic_manager()


def _link(connection: Any) -> Optional[Link]:
    known: Optional[Link] = getattr(connection, "robocop_link", None)
    if known is None:
        with contextlib.suppress(AttributeError, OSError):  # it is being connected, or closed
            known = connection.socket.getpeername()[1], connection.socket.getsockname()[1]
            connection.robocop_link = known
    return known


def hears(node: str, topic: str, checksum: str) -> bool:
    """Whether this process is connected to a node's topic, or does not want it, or not of this type."""
    subscription = _topics().subs.get(topic)
    if subscription is None or subscription.data_class._md5sum not in ("*", checksum):
        return True
    return node in {getattr(connection, "callerid_pub", None) for connection in subscription.connections}


def other_type(topic: str, checksum: str) -> str:
    """The type with which this process publishes or subscribes to a topic, if it is not the one of this checksum."""
    kinds = [it[topic].data_class for it in (_topics().pubs, _topics().subs) if topic in it]
    others = [kind._type for kind in kinds if "*" not in (checksum, kind._md5sum) and checksum != kind._md5sum]
    return str(others[0]) if others else ""


def reaches(node: str, topic: str, checksum: str) -> bool:
    """Whether what this process publishes on a topic goes to a node, or it does not publish that, or not this type."""
    connections = _subscribers(topic, checksum)
    return connections is None or node in {connection.endpoint_id for connection in connections}


def is_connected(topic: str, checksum: str, node_ports: Set[int]) -> bool:
    """Whether what this process publishes on a topic goes to all these ports of a node."""
    connections = _subscribers(topic, checksum)
    links = map(_link, connections or [])
    return connections is None or node_ports <= {link[0] for link in links if link is not None}


def _subscribers(topic: str, checksum: str) -> Optional[List[Any]]:
    publication = _topics().pubs.get(topic)
    if publication is None or "*" != checksum != publication.data_class._md5sum:
        return None
    connections: List[Any] = publication.connections
    return connections


def goal_senders(server: actionlib.ActionServer) -> int:
    """How many nodes can send goals to an action server; actionlib keeps its topics to itself."""
    return int(server.goal_sub.get_num_connections())


def has_client(server: actionlib.ActionServer) -> bool:
    """Whether somebody can send goals to an action server, and hears of their status and result."""
    topics = (server.goal_sub, server.status_pub, server.result_pub)
    return all(topic.get_num_connections() > 0 for topic in topics)
