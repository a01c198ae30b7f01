"""Connections between a publisher of rospy and a subscriber that is only a socket, without a ROS master."""

import itertools
import socket
from typing import Callable, Iterator, NamedTuple

import pytest
import rospy
from rospy.impl.tcpros_base import TCPROSTransport
from rospy.impl.tcpros_pubsub import TCPROSPub


class Link(NamedTuple):
    """rospy's connection to a subscriber, and the subscriber's end of it."""

    connection: TCPROSTransport
    socket: socket.socket


@pytest.fixture(name="connect")
def connected_by_hand() -> Iterator[Callable[..., Link]]:
    """Connects one more subscriber to a topic, as rospy's server does after the handshake."""
    server = socket.create_server(("127.0.0.1", 0))
    names = (f"/subscriber_{i}" for i in itertools.count())
    ends = [socket.create_connection(server.getsockname())]

    def connect(topic: rospy.Publisher, name: str = "") -> Link:
        connection = TCPROSTransport(TCPROSPub(topic.name, topic.data_class), topic.name)
        connection.set_socket(server.accept()[0], name or next(names))
        ends.append(socket.create_connection(server.getsockname()))  # here, so that accept() got the first free number
        topic.impl.add_connection(connection)
        return Link(connection, ends[-2])

    yield connect
    for end in (server, *ends):
        end.close()
