"""How long a goal's transform is waited for."""

from unittest.mock import MagicMock

import pytest
from geometry_msgs.msg import PoseStamped, TransformStamped

from aro_robocop_goto_as.errors import FrameError
from aro_robocop_goto_as.ros import graph
from aro_robocop_goto_as.ros.client import goal_frame
from aro_robocop_goto_as.ros.client.tf_buffer import TfBuffer

TIMEOUT = 0.02  # [s, wall]


class Machine:
    """A busy one: callbacks, or a publisher of /tf_static, are late for some looks, and use processor time."""

    def __init__(self, monkeypatch, callbacks_late, publisher_late):
        self.callbacks_late, self.publisher_late, self.used = callbacks_late, publisher_late, 0.0
        monkeypatch.setattr(goal_frame, "TfBuffer", lambda: TfBuffer(debug=False))
        monkeypatch.setattr(goal_frame.tf2_ros, "TransformListener", MagicMock())
        monkeypatch.setattr(graph, "has_living_publisher", self.has_living_publisher)
        self.transformer = goal_frame.GoalTransformer(
            "odom", "map", TIMEOUT, lambda: None, lambda: self.used, self.callbacks_want_to_run
        )
        for name, topic in (("/tf", "tf_sub"), ("/tf_static", "tf_static_sub")):
            subscriber = getattr(self.transformer.listener, topic)
            subscriber.resolved_name, subscriber.impl.connections = name, [MagicMock(callerid_pub="/connected")]

    def callbacks_want_to_run(self):
        self.callbacks_late -= 1
        if self.callbacks_late == 0:
            self.send()
        return self.callbacks_late > 0

    def has_living_publisher(self, topic, but):
        assert but == {"/connected"}
        if topic == "/tf":
            return False
        self.publisher_late -= 1
        if self.publisher_late == 0:
            self.send()
        return self.publisher_late > 0

    def send(self):
        sent = TransformStamped()
        sent.header.frame_id, sent.child_frame_id, sent.transform.rotation.w = "odom", "map", 1.0
        sent.transform.translation.x = 1.0
        self.transformer.buffer.set_transform_static(sent, "/publisher")

    def resolve(self):
        pose = PoseStamped()
        pose.header.frame_id = "map"
        return self.transformer.resolve(pose).x


@pytest.mark.parametrize("callbacks_late, publisher_late", [(1, 0), (3, 0), (0, 1), (0, 3)])
def test_transform_that_a_busy_machine_delays_is_waited_for(monkeypatch, callbacks_late, publisher_late):
    assert Machine(monkeypatch, callbacks_late, publisher_late).resolve() == 1.0


def test_transform_that_nobody_sends_is_not_waited_for_longer(monkeypatch):
    machine = Machine(monkeypatch, 0, 0)
    with pytest.raises(FrameError):
        machine.resolve()
    assert (machine.callbacks_late, machine.publisher_late) == (-1, -1)  # one look each


def test_callbacks_that_always_run_get_as_much_processor_time_as_the_timeout(monkeypatch):
    machine = Machine(monkeypatch, 1000, 0)

    def work():
        machine.used += TIMEOUT / 2
        return True

    machine.transformer._callbacks_want_to_run = work
    with pytest.raises(FrameError):
        machine.resolve()
    assert machine.used == TIMEOUT
