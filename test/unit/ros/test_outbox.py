"""A batch: every message reaches every subscriber, whole and in order; a subscriber that stalls is disconnected."""

import socket
import struct
import threading
from types import SimpleNamespace
from typing import Any, Callable, Iterator, List

import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.ros.outbox import Batch
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
        is_latch=False,
        seq=0,
        message_data_sent=0,
        c_lock=threading.RLock(),
        connections=[one.connection for one in subscribers],
        remove_connection=lambda connection: connection.close(),
    )
    return SimpleNamespace(outlets=tuple(one.outlet for one in subscribers), impl=impl)


def scan(beams: int) -> PackedMessage:
    """A message of about 4 bytes a beam."""
    return PackedMessage(LaserScan(ranges=[1.0] * beams))


def test_each_subscriber_gets_the_messages_of_its_topics_in_order(subscriber: Callable[[], Subscriber]) -> None:
    first, second = subscriber(), subscriber()
    both, one = topic_of(first, second), topic_of(second)
    messages = [scan(10), PackedMessage(Clock()), scan(20)]
    Batch([*zip((both, one), messages)], [(both, messages[2])]).send(0)
    sizes, data = [message.size for message in messages], [message.data.tobytes() for message in messages]
    assert first.received(sizes[0] + sizes[2]) == data[0] + data[2]
    assert second.received(sum(sizes)) == b"".join(data)


def test_messages_are_counted_as_rospy_does(subscriber: Callable[[], Subscriber]) -> None:
    reader, message = subscriber(), scan(3)
    topic = topic_of(reader)
    batch = Batch([(topic, message)])
    for _ in range(3):
        batch.send(0)
        batch.send(0)
        batch.count()
    reader.socket.setblocking(False)
    assert reader.socket.recv(10 * message.size) == 6 * bytes(message.data)
    assert (topic.impl.seq, topic.impl.message_data_sent) == (6, 6 * message.size)
    assert (reader.connection.stat_num_msg, reader.connection.stat_bytes) == (6, 6 * message.size)


def test_message_larger_than_the_sockets_buffer_arrives_whole(subscriber: Callable[[], Subscriber]) -> None:
    reader, message = subscriber(), scan(1_000_000)
    received: List[bytes] = []
    thread = threading.Thread(target=lambda: received.append(reader.received(message.size)))
    thread.start()
    Batch([(topic_of(reader), message)]).send(0)
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
    lost, reader, message = subscriber(), subscriber(), scan(100)
    batch = Batch([(topic_of(lost), message), (topic_of(reader), message)])
    fault(lost)
    sent = 0
    while not lost.connection.closed and sent < MANY:
        batch.send(0)
        sent += 1
        assert reader.received(message.size) == bytes(message.data)
    assert lost.connection.closed
    assert not reader.connection.closed


def test_messages_on_one_connection_are_not_mixed(subscriber: Callable[[], Subscriber]) -> None:
    reader, messages = subscriber(), [scan(1_000_000), scan(10)]
    received: List[bytes] = []
    size = sum(message.size for message in messages)
    thread = threading.Thread(target=lambda: received.append(reader.received(size)))
    near = reader.outlet.socket

    def finish(rest: memoryview) -> None:
        if not thread.is_alive():
            thread.start()  # there is room in the socket as soon as a part of the first message is read
        near.sendall(rest)

    reader.outlet = reader.outlet._replace(socket=SimpleNamespace(sendall=finish, close=near.close))
    near.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, struct.pack("ll", 10, 0))
    Batch([(topic_of(reader), message) for message in messages]).send(0)  # topics remapped to one
    thread.join(10.0)
    assert received == [b"".join(message.data.tobytes() for message in messages)]


def test_clock_waits_for_messages_that_a_full_socket_delays(subscriber: Callable[[], Subscriber]) -> None:
    slow, reader, message, clock = subscriber(), subscriber(), scan(100_000), PackedMessage(Clock())
    near = slow.outlet.socket

    def finish(rest: memoryview) -> None:
        reader.socket.setblocking(False)
        with pytest.raises(BlockingIOError):
            reader.socket.recv(1)
        near.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, struct.pack("ll", 10, 0))
        thread = threading.Thread(target=slow.received, args=(message.size,))
        thread.start()
        near.sendall(rest)
        thread.join(10.0)

    slow.outlet = slow.outlet._replace(socket=SimpleNamespace(sendall=finish, close=near.close))
    Batch([(topic_of(slow), message)], [(topic_of(reader), clock)]).send(0)
    assert reader.socket.recv(100) == clock.data.tobytes()
    assert not slow.connection.closed


def _full(reader: Subscriber) -> None:
    with pytest.raises(BlockingIOError):
        while True:
            reader.outlet.socket.send(bytes(1000), socket.MSG_DONTWAIT)


@pytest.mark.parametrize("beams", [10, 100_000], ids=["nothing is taken", "a part is taken"])
def test_subscribers_that_stall_together_are_waited_for_only_once(
    subscriber: Callable[[], Subscriber], beams: int
) -> None:
    stalled, waited = [subscriber() for _ in range(5)], []

    class Spy(socket.socket):
        def sendall(self, rest: memoryview) -> None:
            waited.append(self)
            super().sendall(rest)

    for one in stalled:
        if beams < 1000:
            _full(one)
        spy = Spy(fileno=one.outlet.socket.detach())
        one.outlet = Outlet(one.connection, spy, spy.fileno())
    Batch([(topic_of(*stalled), scan(beams))]).send(0)
    assert all(one.connection.closed for one in stalled)
    assert waited == [stalled[0].outlet.socket]


def test_subscriber_that_reads_while_another_one_stalls_gets_its_message_whole(
    subscriber: Callable[[], Subscriber],
) -> None:
    stalled, slow, message = subscriber(), subscriber(), scan(100_000)
    received: List[bytes] = []
    reading = threading.Thread(target=lambda: received.append(slow.received(message.size - 100_000)))

    class Stalled(Connection):
        def close(self) -> None:
            super().close()
            received.append(slow.received(100_000))
            reading.start()

    stalled.connection = Stalled()
    stalled.outlet = stalled.outlet._replace(connection=stalled.connection)
    Batch([(topic_of(stalled, slow), message)]).send(0)
    reading.join(10.0)
    assert stalled.connection.closed and not slow.connection.closed
    assert b"".join(received) == bytes(message.data)


def test_empty_batch_sends_nothing() -> None:
    Batch([]).send(0)
