"""A batch: every message reaches every subscriber that reads, whole and in order; one that stands still is kept."""

import gc
import socket
import struct
import threading
import weakref
from types import SimpleNamespace

import pytest
import rospy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from subscriber_links import LONG, SHORT, received

from aro_robocop_goto_as.ros.publishing.batch import Batch
from aro_robocop_goto_as.ros.publishing.packed import PackedMessage, counter
from aro_robocop_goto_as.ros.publishing.publisher import SubscriberLink

MANY = 10_000  # messages of 500 bytes, more than any socket's buffer holds
READ_TIMEOUT = 60.0  # [s, wall] for a thread that reads


class Connection:
    """Stands for a connection of rospy."""

    endpoint_id, name = "/subscriber", "/topic"

    def __init__(self):
        self.closed = False

    def close(self):
        """As rospy's: called for a subscriber that is lost."""
        self.closed = True


class Subscriber:
    """One end of a socket pair; the other one is a subscriber's."""

    def __init__(self, timeout):
        near, self.socket = socket.socketpair()
        self.connection = Connection()
        self.link = SubscriberLink(self.connection, near)
        self.set_timeout(timeout)

    def set_timeout(self, timeout):
        """Set how long one send may wait for it."""
        self.link.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, timeout)

    def received(self, size):
        """The next bytes."""
        return received(self.socket, size)

    def close(self):
        """Disconnect."""
        self.socket.close()
        self.link.socket.close()


@pytest.fixture(name="subscriber")
def _subscriber():
    made = []

    def make(timeout=LONG):
        made.append(Subscriber(timeout))
        return made[-1]

    yield make
    for subscriber in made:
        subscriber.close()


def topic_of(*subscribers):
    """Stands for a DirectPublisher with these subscribers."""
    impl = SimpleNamespace(
        is_latch=False,
        c_lock=threading.RLock(),
        connections=[one.connection for one in subscribers],
        remove_connection=lambda connection: connection.close(),
    )
    return SimpleNamespace(links=tuple(one.link for one in subscribers), impl=impl)


def spied(subscriber, before):
    """Stands for its link's socket; `before` is called with the flags of each send."""
    near = subscriber.link.socket

    def send(data, flags):
        before(flags)
        return near.send(data, flags)

    return SimpleNamespace(send=send, close=near.close, getpeername=near.getpeername, getsockname=near.getsockname)


def counted(beams):
    """A scan whose header's number is counted on with each send."""
    return PackedMessage(LaserScan(ranges=[1.0] * beams), {"header": counter()})


def scan(beams):
    """A message of about 4 bytes a beam."""
    return PackedMessage(LaserScan(ranges=[1.0] * beams))


def test_a_message_without_a_subscriber_lives_as_long_as_its_batch_which_fills_it():
    message = counted(10)
    kept, batch = weakref.ref(message), Batch([(topic_of(), message)])
    del message
    gc.collect()
    batch.send(7 * 10**9)
    assert struct.unpack_from("<2I", kept().data, 4) == (1, 7)  # the header's seq and secs


def test_each_subscriber_gets_the_messages_of_its_topics_in_order_also_of_steps_that_follow_at_once(subscriber):
    first, second = subscriber(), subscriber()
    both, one = topic_of(first, second), topic_of(second)
    messages = [counted(10), PackedMessage(Clock()), counted(20)]
    batch, of_first, of_second = Batch([*zip((both, one), messages)], [(both, messages[2])]), b"", b""
    for more in (True, True, False, True):
        batch.send(0, more)
        data = [message.data.tobytes() for message in messages]
        of_first, of_second = of_first + data[0] + data[2], of_second + b"".join(data)
    assert (first.received(len(of_first)), second.received(len(of_second))) == (of_first, of_second)


def _gone(reader):
    reader.socket.close()


def _shut_down(reader):
    reader.link.socket.shutdown(socket.SHUT_RDWR)  # as rospy does before it closes a connection


@pytest.mark.parametrize("fault", [_gone, _shut_down])
def test_lost_subscriber_is_disconnected_and_the_others_get_everything(subscriber, fault):
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


def send_until_it_stands_still(batch, reader):
    """How many messages are sent until a subscriber that does not read is not waited for any more."""
    for sent in range(1, MANY):
        batch.send(0)
        if reader.link.stands_still:
            return sent
    raise AssertionError("still waited for")


@pytest.mark.parametrize("beams", [3, 100, 1_000_000])
def test_subscriber_that_stands_still_stays_connected_and_gets_whole_messages_when_it_reads_again(
    subscriber, beams, monkeypatch
):
    said = []
    monkeypatch.setattr(rospy, "logwarn", lambda text, *_: said.append(text))
    monkeypatch.setattr(rospy, "loginfo", lambda text, *_: said.append(text))
    frozen, message = subscriber(SHORT), counted(beams)
    batch, received = Batch([(topic_of(frozen), message)]), bytearray()
    send_until_it_stands_still(batch, frozen)
    for _ in range(10):
        batch.send(0)  # which it misses
    frozen.set_timeout(LONG)  # it reads from here on

    def read():
        while True:
            part = frozen.socket.recv(1_000_000)
            if not part:
                return
            received.extend(part)

    reading = threading.Thread(target=read)
    reading.start()
    while frozen.link.stands_still:
        batch.send(0)
    batch.send(0)
    assert not frozen.link.stands_still and not frozen.connection.closed
    frozen.link.socket.shutdown(socket.SHUT_WR)
    reading.join(READ_TIMEOUT)
    assert not reading.is_alive()
    assert received[-message.size :] == message.data.tobytes()
    numbers = [struct.unpack_from("<I", received, start + 4)[0] for start in range(0, len(received) - 8, message.size)]
    whole = len(received) // message.size
    assert len(received) == whole * message.size
    assert numbers == sorted(numbers) and len(set(numbers)) == whole
    assert [text.split(";")[0] for text in said] == ["%s has stopped reading", "%s reads again"]


def test_nobody_waits_for_a_subscriber_that_stands_still(subscriber, monkeypatch):
    frozen, reader, message, clock = subscriber(SHORT), subscriber(), scan(100), PackedMessage(Clock())
    both = topic_of(frozen, reader)
    batch = Batch([(both, message)], [(topic_of(reader), clock)])
    for _ in range(MANY):
        batch.send(0)
        reader.received(message.size + clock.size)
        if frozen.link.stands_still:
            break
    waits = []
    frozen.link.socket = spied(frozen, lambda flags: waits.append(flags))
    for _ in range(10):
        batch.send(0)
        assert reader.received(message.size + clock.size) == message.data.tobytes() + clock.data.tobytes()
    assert not waits
    assert not frozen.connection.closed


def test_messages_on_one_connection_are_not_mixed(subscriber):
    reader, messages = subscriber(), [scan(1_000_000), scan(10)]
    received = []
    size = sum(message.size for message in messages)
    thread = threading.Thread(target=lambda: received.append(reader.received(size)))

    def begin(_flags):
        if not thread.is_alive():
            thread.start()  # there is room in the socket as soon as a part of the first message is read

    reader.link.socket = spied(reader, begin)
    Batch([(topic_of(reader), message) for message in messages]).send(0)  # topics remapped to one
    thread.join(READ_TIMEOUT)
    assert received == [b"".join(message.data.tobytes() for message in messages)]


def test_clock_waits_for_messages_that_a_full_socket_delays(subscriber):
    slow, reader, message, clock = subscriber(), subscriber(), scan(100_000), PackedMessage(Clock())
    thread = threading.Thread(target=slow.received, args=(message.size,))

    def look(_flags):
        reader.socket.setblocking(False)
        with pytest.raises(BlockingIOError):
            reader.socket.recv(1)
        if not thread.is_alive():
            thread.start()

    slow.link.socket = spied(slow, look)
    Batch([(topic_of(slow), message)], [(topic_of(reader), clock)]).send(0)
    thread.join(READ_TIMEOUT)
    assert reader.socket.recv(100) == clock.data.tobytes()
    assert not slow.connection.closed


def _full(reader):
    with pytest.raises(BlockingIOError):
        while True:
            reader.link.socket.send(bytes(1000), socket.MSG_DONTWAIT)


@pytest.mark.parametrize("beams", [10, 100_000], ids=["nothing is taken", "a part is taken"])
def test_subscribers_that_stall_together_are_waited_for_only_once(subscriber, beams):
    stalled, waited = [subscriber(SHORT) for _ in range(5)], []
    for number, one in enumerate(stalled):
        if beams < 1000:
            _full(one)
        one.link.socket = spied(one, lambda flags, number=number: waited.append(number) if not flags else None)
    Batch([(topic_of(*stalled), scan(beams))]).send(0)
    assert all(one.link.stands_still and not one.connection.closed for one in stalled)
    assert set(waited) <= {0}


def test_subscriber_that_reads_while_another_one_stalls_gets_its_message_whole(subscriber):
    stalled, slow, message = subscriber(SHORT), subscriber(), scan(100_000)
    received = []
    reading = threading.Thread(target=lambda: received.append(slow.received(message.size - 100_000)))

    def read_meanwhile(flags):
        if not flags and not received:
            received.append(slow.received(100_000))
            reading.start()

    stalled.link.socket = spied(stalled, read_meanwhile)
    Batch([(topic_of(stalled, slow), message)]).send(0)
    reading.join(READ_TIMEOUT)
    assert stalled.link.stands_still and not slow.link.stands_still
    assert b"".join(received) == bytes(message.data)
