"""The outbox: every message reaches every subscriber, whole and in order; a subscriber that stalls is disconnected."""

import socket
import struct
import threading
from types import SimpleNamespace
from typing import Any, Callable, Iterator, List, Tuple

import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.ros.outbox import Outbox
from aro_robocop_goto_as.ros.packed import PackedMessage
from aro_robocop_goto_as.ros.publishing import Outlet

MANY = 10_000  # messages of 500 bytes, more than any socket's buffer holds
SHORT = struct.pack("ll", 0, 100_000)  # [s], [us] a send timeout


class Connection:
    """Stands for a connection of rospy."""

    def __init__(self) -> None:
        self.stat_bytes = self.stat_num_msg = 0
        self.closed = False

    def close(self) -> None:
        """As rospy's: called for a subscriber that is lost."""
        self.closed = True


class Subscriber:
    """One end of a socket pair; the other one is an outlet."""

    def __init__(self) -> None:
        near, self.socket = socket.socketpair()
        near.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, SHORT)
        self.connection = Connection()
        self.outlet = Outlet(self.connection, near, near.fileno())

    def received(self, size: int) -> bytes:
        """The next bytes."""
        data = b""
        while len(data) < size:
            part = self.socket.recv(size - len(data))
            assert part, "closed"
            data += part
        return data

    def close(self) -> None:
        """Disconnect."""
        self.socket.close()
        self.outlet.socket.close()


@pytest.fixture(name="subscriber")
def _subscriber() -> Iterator[Callable[[], Subscriber]]:
    made: List[Subscriber] = []

    def make() -> Subscriber:
        made.append(Subscriber())
        return made[-1]

    yield make
    for subscriber in made:
        subscriber.close()


def topic_of(*subscribers: Subscriber) -> Any:
    """Stands for a DirectPublisher with these subscribers."""
    impl = SimpleNamespace(
        seq=0,
        message_data_sent=0,
        c_lock=threading.RLock(),
        connections=[it.connection for it in subscribers],
        remove_connection=lambda connection: connection.close(),
    )
    return SimpleNamespace(outlets=tuple(it.outlet for it in subscribers), impl=impl)


def scan(beams: int) -> PackedMessage:
    """A message of about 4 bytes a beam."""
    return PackedMessage(LaserScan(ranges=[1.0] * beams))


def test_each_subscriber_gets_the_messages_of_its_topics_in_order(subscriber: Callable[[], Subscriber]) -> None:
    first, second = subscriber(), subscriber()
    both, one = topic_of(first, second), topic_of(second)
    messages = [scan(10), PackedMessage(Clock()), scan(20)]
    outbox = Outbox()
    for topic, message in zip((both, one, both), messages):
        outbox.put(topic, message)
    outbox.flush()
    assert first.received(messages[0].size + messages[2].size) == bytes(messages[0].data + messages[2].data)
    assert second.received(sum(it.size for it in messages)) == b"".join(bytes(it.data) for it in messages)


def test_messages_are_sent_once_and_counted_as_rospy_does(subscriber: Callable[[], Subscriber]) -> None:
    reader, message, outbox = subscriber(), scan(3), Outbox()
    topic = topic_of(reader)
    outbox.put(topic, message)
    outbox.flush()
    outbox.flush()
    reader.socket.setblocking(False)
    assert reader.socket.recv(10 * message.size) == bytes(message.data)
    assert (topic.impl.seq, topic.impl.message_data_sent) == (1, message.size)
    assert (reader.connection.stat_num_msg, reader.connection.stat_bytes) == (1, message.size)


def test_message_larger_than_the_sockets_buffer_arrives_whole(subscriber: Callable[[], Subscriber]) -> None:
    reader, message, outbox = subscriber(), scan(1_000_000), Outbox()
    received: List[bytes] = []
    thread = threading.Thread(target=lambda: received.append(reader.received(message.size)))
    thread.start()
    outbox.put(topic_of(reader), message)
    outbox.flush()
    thread.join(10.0)
    assert received == [bytes(message.data)]
    assert not reader.connection.closed


def _stalled(reader: Subscriber) -> None:
    """Nobody reads."""


def _gone(reader: Subscriber) -> None:
    reader.socket.close()


def _shut_down(reader: Subscriber) -> None:
    reader.outlet.socket.shutdown(socket.SHUT_RDWR)  # as rospy does before it closes a connection


@pytest.mark.parametrize("fault", [_stalled, _gone, _shut_down])
def test_lost_subscriber_is_disconnected_and_the_others_get_everything(
    subscriber: Callable[[], Subscriber], fault: Callable[[Subscriber], None]
) -> None:
    lost, reader, message, outbox = subscriber(), subscriber(), scan(100), Outbox()
    topics: Tuple[Any, Any] = topic_of(lost), topic_of(reader)
    fault(lost)
    sent = 0
    while not lost.connection.closed and sent < MANY:
        for topic in topics:
            outbox.put(topic, message)
        outbox.flush()
        sent += 1
        assert reader.received(message.size) == bytes(message.data)
    assert lost.connection.closed
    assert reader.connection.stat_num_msg == sent
    assert not reader.connection.closed


def _full(reader: Subscriber) -> None:
    reader.outlet.socket.settimeout(0.0)
    with pytest.raises(BlockingIOError):
        while True:
            reader.outlet.socket.send(bytes(1000))
    reader.outlet.socket.settimeout(None)


def test_message_is_sent_only_when_the_one_before_it_on_its_connection_is_sent_whole(
    subscriber: Callable[[], Subscriber],
) -> None:
    reader, outbox, message, sent = subscriber(), Outbox(), scan(10), []
    near = reader.outlet.socket
    reader.outlet = reader.outlet._replace(socket=SimpleNamespace(sendall=sent.append, close=near.close))
    for topic in (topic_of(reader), topic_of(reader)):  # remapped to one
        outbox.put(topic, message)
    outbox.flush()
    assert sent == [message.data, message.data], "by sendall(), which ends when the message is sent whole"


def _full(reader: Subscriber) -> None:
    with pytest.raises(BlockingIOError):
        while True:
            reader.outlet.socket.send(bytes(1000), socket.MSG_DONTWAIT)


@pytest.mark.parametrize("beams", [10, 100_000], ids=["nothing is taken", "a part is taken"])
def test_subscribers_that_stall_together_are_waited_for_only_once(
    subscriber: Callable[[], Subscriber], beams: int
) -> None:
    stalled, outbox, waited = [subscriber() for _ in range(5)], Outbox(), []

    class Spy(socket.socket):
        def sendall(self, rest: memoryview) -> None:
            waited.append(self)
            super().sendall(rest)

    for one in stalled:
        if beams < 1000:
            _full(one)
        spy = Spy(fileno=one.outlet.socket.detach())
        one.outlet = Outlet(one.connection, spy, spy.fileno())
    outbox.put(topic_of(*stalled), scan(beams))
    outbox.flush()
    assert all(one.connection.closed for one in stalled)
    assert waited == [stalled[0].outlet.socket]


def test_subscriber_that_reads_while_another_one_stalls_gets_its_message_whole(
    subscriber: Callable[[], Subscriber],
) -> None:
    stalled, slow, message, outbox = subscriber(), subscriber(), scan(100_000), Outbox()
    received: List[bytes] = []
    reading = threading.Thread(target=lambda: received.append(slow.received(message.size - 100_000)))

    class Stalled(Connection):
        def close(self) -> None:
            super().close()
            received.append(slow.received(100_000))
            reading.start()

    stalled.connection = Stalled()
    stalled.outlet = stalled.outlet._replace(connection=stalled.connection)
    outbox.put(topic_of(stalled, slow), message)
    outbox.flush()
    reading.join(10.0)
    assert stalled.connection.closed and not slow.connection.closed
    assert b"".join(received) == bytes(message.data)


def test_empty_outbox_sends_nothing() -> None:
    Outbox().flush()
