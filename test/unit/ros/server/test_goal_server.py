"""The action server's results with rospy's own connections, without a ROS master."""

import socket
from typing import Callable

import pytest
import rospy
from actionlib_msgs.msg import GoalID
from aro_robocop_goto_as.msg import GoToPositionActionResult
from subscriber_links import Link

from aro_robocop_goto_as.ros.rospy_internals import lengthen_queue
from aro_robocop_goto_as.ros.server.goal_server import ENDED_KEPT, RESULTS_KEPT, GoalServer


def test_subscriber_that_falls_behind_gets_the_result_of_every_goal(connect: Callable[..., Link]) -> None:
    results = rospy.Publisher("/goal_server/result", GoToPositionActionResult, queue_size=50)  # actionlib's
    try:
        early = connect(results)
        lengthen_queue(results, RESULTS_KEPT)
        late = connect(results)
        for link in (early, late):
            link.connection.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
        message = GoToPositionActionResult()
        message.status.text = 100 * "the position was reached, "
        for number in range(1000):
            message.status.goal_id.id = f"goal {number:04d}"
            results.impl.publish(message)  # a Publisher does nothing before init_node
        for link in (early, late):
            received, link_end = b"", link.socket
            link_end.settimeout(30.0)
            while b"goal 0999" not in received:
                received += link_end.recv(1 << 20)
            missing = [number for number in range(1000) if f"goal {number:04d}".encode() not in received]
            assert missing == []
    finally:
        results.unregister()


def test_cancels_of_goals_that_have_not_come_are_kept_and_left_alone_by_a_cancel_of_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    errors = []
    monkeypatch.setattr(rospy, "logerr", lambda *text: errors.append(text))
    monkeypatch.setattr(rospy.Time, "now", lambda: rospy.Time(1))
    server = GoalServer()
    server.started = True
    monkeypatch.setattr(server, "publish_status", lambda: None)
    for number in range(ENDED_KEPT):
        server.internal_cancel_callback(GoalID(rospy.Time(), f"unknown {number}"))
        server.internal_cancel_callback(GoalID())
        server.internal_cancel_callback(GoalID(rospy.Time(2), f"unknown {number}"))
    server.receive()
    assert [tracker.status.goal_id.id for tracker in server.status_list] == [
        f"unknown {number}" for number in range(ENDED_KEPT)
    ]
    assert errors == []
