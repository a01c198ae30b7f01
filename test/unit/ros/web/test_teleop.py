"""What becomes of the pad's buttons: cmd_vel, one stop at the end, and a goal that is cancelled."""

import asyncio
from unittest.mock import MagicMock

import pytest
from waiting import wait_for

from aro_robocop_goto_as.geometry import Twist2D
from aro_robocop_goto_as.ros.web import teleop
from aro_robocop_goto_as.ros.web.frames import Frames
from aro_robocop_goto_as.ros.web.part import Context
from aro_robocop_goto_as.web.state import PageState, SharedState

LEFT = Twist2D(0.0, 1.0)


class Publishers:
    """Stands in for rospy.Publisher: topics and velocities that were published."""

    def __init__(self):
        self.sent = []

    def __call__(self, topic, *_, **__):
        publisher = MagicMock()
        publisher.publish = lambda message: self.sent.append((topic, message.angular.z))
        return publisher


def driven(monkeypatch, publishers, **state):
    monkeypatch.setattr(teleop.rospy, "Publisher", publishers)
    shared = SharedState(PageState(robots=("blue", "red"), chosen="red", **state))
    context = Context(MagicMock(), MagicMock(), shared, MagicMock(), Frames(), "map")
    return teleop.TeleopPart(context, 0.2, 1.0), context


def test_the_selected_robot_is_driven_and_stopped_once(monkeypatch):
    publishers = Publishers()
    pad, _ = driven(monkeypatch, publishers)

    def turns():
        pad.drive(1, LEFT)
        return publishers.sent

    wait_for(turns, "cmd_vel")
    pad.stop()
    wait_for(lambda: publishers.sent[-1] == ("/red/cmd_vel", 0.0), "a stop")
    assert [sent for sent in publishers.sent if sent[1] == 0.0] == [("/red/cmd_vel", 0.0)]
    assert set(publishers.sent) == {("/red/cmd_vel", 1.0), ("/red/cmd_vel", 0.0)}


@pytest.mark.parametrize(
    "answering, executing, cancels",
    [(True, True, 1), (True, False, 0), (True, None, 1), (False, None, 0)],  # None: not known yet
)
def test_a_goal_that_may_be_executed_is_cancelled_once_when_driving_begins(monkeypatch, answering, executing, cancels):
    pad, context = driven(monkeypatch, Publishers(), answering=answering, executing=executing)
    pad.drive(1, LEFT)
    pad.drive(1, LEFT)
    assert context.requests.publish.call_count == cancels
    pad.stop()


def test_a_page_that_only_watches_drives_nothing(monkeypatch):
    pad, _ = driven(monkeypatch, Publishers(), can_send=False)
    pad.drive(1, LEFT)
    assert not pad._dead_man.active


def test_each_button_drives_its_way_while_it_is_held(monkeypatch):
    pad, context = driven(monkeypatch, Publishers())
    asked = []
    monkeypatch.setattr(pad, "drive", lambda _page, twist: asked.append(twist))
    for held in context.server.gui.add_button.return_value.on_hold.call_args_list:
        asyncio.run(held[0][0](MagicMock()))
    assert asked == [(0.2, 0.0), (0.0, 1.0), (-0.2, 0.0), (0.0, -1.0)]
