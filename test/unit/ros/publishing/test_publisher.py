"""Publishers and batches with rospy's own connections, without a ROS master."""

import socket
import threading
import weakref
from types import SimpleNamespace

import pytest
import rospy
from sensor_msgs.msg import LaserScan
from subscriber_links import LONG, SHORT, received

from aro_robocop_goto_as.ros.publishing.batch import Batch
from aro_robocop_goto_as.ros.publishing.packed import PackedMessage
from aro_robocop_goto_as.ros.publishing.publisher import publisher, resume

SCAN = PackedMessage(LaserScan(ranges=[1.0] * 360))


@pytest.fixture(name="topic")
def _topic():
    made = []

    def make(latch=False):
        made.append(publisher(f"/topic_{len(made)}", LaserScan, latch))
        return made[-1]

    yield make
    for topic in made:
        topic.unregister()


def test_descriptors_of_gone_subscribers_are_closed(topic, connect):
    scans = topic()
    links = [connect(scans) for _ in range(10)]
    duplicates = [weakref.ref(link.socket) for link in scans.links]
    for connection, end in links:
        end.close()
        if connection is links[4].connection:
            rospy.topics.get_topic_manager().check_all()  # rospy notices a part of them by itself
    while scans.get_num_connections():
        Batch([(scans, SCAN)]).send(0)
    assert len(duplicates) == 10 and not any(duplicate() for duplicate in duplicates)


def test_new_subscriber_with_the_descriptor_number_of_one_that_is_gone_stays_connected(topic, connect):
    scans, new = topic(), []
    gone, slow = connect(scans), connect(scans)
    number = gone.connection.fileno()
    gone.connection.socket.shutdown(socket.SHUT_RDWR)

    def send(rest, _flags):
        new.append(connect(scans).connection)
        scans.impl.check()  # as one of rospy's threads does twice a second
        return len(rest)

    second = scans.links[1]
    kept, second.socket = second.socket, SimpleNamespace(send=send)
    Batch([(scans, PackedMessage(LaserScan(ranges=[1.0] * 3_000_000)))]).send(0)  # more than a socket takes at once
    assert [connection.fileno() for connection in new] == [number]
    assert scans.impl.connections == [slow.connection, *new]
    kept.close()


def _set_timeout(link, timeout):
    link.connection.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, timeout)


def _serialized(beams, seq):
    message = LaserScan(ranges=[1.0] * beams)
    message.header.seq = seq
    return PackedMessage(message).data.tobytes()


def test_subscriber_of_a_latched_topic_gets_its_newest_message_when_it_reads_again(topic, connect):
    latched, many = topic(latch=True), 3_000_000  # beams: more than a socket takes at once
    link = connect(latched)
    _set_timeout(link, SHORT)
    for beams in (many, 20, 10):
        latched.impl.publish(LaserScan(ranges=[1.0] * beams))  # as a node does, after its init_node
    (subscriber,) = latched.links
    assert subscriber.stands_still
    _set_timeout(link, LONG)
    first, read = _serialized(many, 1), []
    reading = threading.Thread(target=lambda: read.append(received(link.socket, len(first))))
    reading.start()
    while subscriber.stands_still:
        resume()
    reading.join()
    sent = latched.impl.seq
    last = _serialized(10, sent)  # the third message, sent once more, for which there was room at last
    assert sent > 3 and read == [first] and received(link.socket, len(last)) == last
    assert latched.impl.connections == [link.connection]
    resume()
    latched.impl.publish(LaserScan())
    assert received(link.socket, len(_serialized(0, sent + 1))) == _serialized(0, sent + 1)
