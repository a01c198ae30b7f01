"""Messages wait for the main thread: which of them, and in what order they are handled."""

import pytest

from aro_robocop_goto_as.ros.web import part


class Topic:
    """Stands in for rospy.Subscriber."""

    def __init__(self, _topic, _kind, callback, queue_size=None):
        self.publish = callback
        self.closed = False

    def unregister(self):
        self.closed = True


@pytest.fixture
def received(monkeypatch):
    monkeypatch.setattr(part.rospy, "Subscriber", Topic)
    return []


def subscribed(received, keep):
    made = part.Inbox()
    made.subscribe("/topic", object, lambda at, message: received.append(message), keep)
    return made, made._subscriptions[0][0]


@pytest.mark.parametrize("keep, handled", [(1, [2]), (2, [1, 2]), (None, [0, 1, 2])])
def test_the_last_messages_are_handled_in_order_when_they_are_delivered(received, keep, handled):
    made, topic = subscribed(received, keep)
    for number in range(3):
        topic.publish(number)
    assert received == []
    made.deliver()
    made.deliver()
    assert received == handled


def test_what_waits_is_forgotten_when_it_is_cleared_or_closed(received):
    made, topic = subscribed(received, None)
    topic.publish(0)
    made.clear()
    made.deliver()
    topic.publish(1)
    made.close()
    made.deliver()
    assert received == [] and topic.closed
