"""Connections between a publisher of rospy and a subscriber that is only a socket, without a ROS master."""

import itertools
import socket
import struct
from typing import NamedTuple

import pytest
from rospy.impl.tcpros_base import TCPROSTransport
from rospy.impl.tcpros_pubsub import TCPROSPub

SHORT = struct.pack("ll", 0, 100_000)  # [s], [us] a send timeout, of a subscriber that is to stand still
LONG = struct.pack("ll", 60, 0)  # of one that reads, whenever it gets a processor


class Link(NamedTuple):
    """rospy's connection to a subscriber, and the subscriber's end of it."""

    connection: TCPROSTransport
    socket: socket.socket


def received(end, size):
    """The next bytes at a subscriber's end."""
    end.settimeout(60.0)
    data = b""
    while len(data) < size:
        part = end.recv(size - len(data))
        assert part, "closed"
        data += part
    return data


@pytest.fixture(name="connect")
def connected_by_hand():
    """Connects one more subscriber to a topic, as rospy's server does after the handshake."""
    server = socket.create_server(("127.0.0.1", 0))
    names = (f"/subscriber_{i}" for i in itertools.count())
    ends = [socket.create_connection(server.getsockname())]

    def connect(topic):
        connection = TCPROSTransport(TCPROSPub(topic.name, topic.data_class), topic.name)
        connection.set_socket(server.accept()[0], next(names))
        ends.append(socket.create_connection(server.getsockname()))  # here, so that accept() got the first free number
        topic.impl.add_connection(connection)
        return Link(connection, ends[-2])

    yield connect
    for end in (server, *ends):
        end.close()
