"""A click becomes a goal, and the status says what becomes of the goal."""

from types import SimpleNamespace

import pytest
import rospy
from aro_robocop_goto_as.msg import GoToPositionFeedback
from geometry_msgs.msg import Point, PoseStamped

from aro_robocop_goto_as.errors import FrameError
from aro_robocop_goto_as.ros.client import rviz_bridge
from aro_robocop_goto_as.ros.client.params import BridgeParams

CHECKS = 12  # of is_shutdown, until the node ends


class System:
    """A bridge whose server is up, the calls of its follower and its statuses; also stands for its follower."""

    def __init__(self, monkeypatch):
        self.topics, self.calls, self.statuses, self.timers, self.transforms = {}, [], [], [], []
        self.on_cancel = self.on_look = lambda: None
        self.server_is_up, self.ended, self.ending = True, True, ""
        checks = iter([False] * CHECKS)
        monkeypatch.setattr(rospy, "is_shutdown", lambda: next(checks, True))
        monkeypatch.setattr(rospy, "Subscriber", lambda name, _, callback, **__: self.topics.update({name: callback}))
        monkeypatch.setattr(rospy, "Publisher", lambda *_, **__: SimpleNamespace(publish=self.statuses.append))
        monkeypatch.setattr(
            rospy, "Timer", lambda period, publish, **__: self.timers.append((period.to_sec(), publish))
        )
        monkeypatch.setattr(rviz_bridge, "POLL", 0.0)
        monkeypatch.setattr(rviz_bridge, "GoalFollower", self.follower)
        transformer = SimpleNamespace(frame_of=lambda pose: "map", resolve=self.resolve)
        monkeypatch.setattr(rviz_bridge, "GoalTransformer", lambda *given: self.transforms.append(given) or transformer)
        self.bridge = rviz_bridge.Bridge(BridgeParams())

    def follower(self, _, on_feedback):
        self.feedback = on_feedback
        return self

    def resolve(self, pose):
        if pose.pose.position.x < 0.0:
            raise FrameError("no transform")
        return Point(pose.pose.position.x + 10.0, 0.0, 0.0)

    def click(self, x):
        pose = PoseStamped()
        pose.pose.position.x = x
        self.topics["move_base_simple/goal"](pose)

    def is_up(self):
        self.on_look()
        return self.server_is_up

    def send(self, position):
        self.calls.append(f"goal {position.x:g}")
        self.ended = False

    def cancel(self, timeout):
        self.calls.append("cancel")
        self.on_cancel()
        self.ended = True
        return True

    def has_ended(self):
        return self.ended

    def state(self):
        return self.ending if self.ended else "ACTIVE"


@pytest.fixture
def system(monkeypatch):
    return System(monkeypatch)


@pytest.fixture
def driving(system):
    """The system while the robot drives to x 1."""
    system.bridge.replace_goal(Point(1.0, 0.0, 0.0), PoseStamped())
    return system


def test_click_is_sent_once_in_the_servers_frame(system):
    system.click(1.0)
    system.bridge.run()
    assert system.calls == ["goal 11"]
    assert system.statuses == ["robocop_goto_as is ready, no goal yet", "goal x 1.00 y 0.00 in map is ACTIVE"]


@pytest.mark.parametrize("newer, sent", [(None, "goal 11"), (2.0, "goal 12")])
def test_the_newest_click_waits_for_a_server_that_is_missing(system, newer, sent):
    looks = iter([lambda: newer and system.click(newer), lambda: None, lambda: setattr(system, "server_is_up", True)])
    system.server_is_up = False
    system.bridge.publish_state()
    system.on_look = lambda: next(looks, lambda: None)()
    system.click(1.0)
    system.bridge.run()
    assert system.calls == [sent]
    assert system.statuses[0] == "waiting for robocop_goto_as; if it has ended, its terminal says why"


def test_a_click_while_the_server_is_missing_ends_the_wait_without_a_cancel(driving):
    driving.server_is_up = False
    looks = iter([lambda: None, lambda: driving.click(3.0)])
    driving.on_look = lambda: next(looks, lambda: None)()
    driving.bridge.replace_goal(Point(12.0, 0.0, 0.0), PoseStamped())
    assert (driving.calls, driving.bridge.clicked.is_set()) == (["goal 1"], True)


def test_with_ignore_goal_frame_the_numbers_are_sent_as_they_are_with_a_warning(system, monkeypatch):
    warnings = []
    monkeypatch.setattr(rospy, "logwarn_once", lambda text, *values: warnings.append(text % values))
    system.bridge.p = BridgeParams(ignore_goal_frame=True)
    system.click(1.0)
    system.bridge.run()
    assert system.calls == ["goal 1"]
    assert [text.split(":")[0] for text in warnings] == ["ignore_goal_frame is set"]


def test_newer_click_cancels_the_goal_before_its_own_is_sent(driving):
    driving.click(2.0)
    driving.bridge.run()
    assert driving.calls == ["goal 1", "cancel", "goal 12"]


def test_goal_that_has_ended_is_not_cancelled(driving):
    driving.ended = True
    driving.click(2.0)
    driving.bridge.run()
    assert driving.calls == ["goal 1", "goal 12"]


def test_click_that_is_outdated_before_it_is_sent_is_left_out(driving):
    driving.on_cancel = lambda: driving.click(3.0)
    driving.click(2.0)
    driving.bridge.run()
    assert driving.calls == ["goal 1", "cancel", "goal 13"]


def test_refused_click_leaves_the_earlier_goal(driving):
    driving.click(-1.0)
    driving.bridge.run()
    assert (driving.calls, driving.statuses[-1]) == (["goal 1"], "goal refused: no transform")


def test_click_that_is_refused_while_the_earlier_goal_is_cancelled_says_nothing_of_that_goal(driving, monkeypatch):
    errors = []
    monkeypatch.setattr(rospy, "logerr", lambda text, *values: errors.append(text % values))
    driving.on_cancel = lambda: driving.click(-1.0)
    driving.click(2.0)
    driving.bridge.run()
    assert (driving.calls, errors) == (["goal 1", "cancel"], ["goal refused: no transform"])


def test_status_tells_of_the_newest_goal(system):
    system.bridge.publish_state()
    system.bridge.replace_goal(Point(1.0, 0.0, 0.0), PoseStamped())
    system.feedback(GoToPositionFeedback(0.5, 0.1, "driving"))
    system.bridge.publish_state()
    system.ended, system.ending = True, "SUCCEEDED: REACHED: so"
    system.bridge.publish_state()
    system.bridge.replace_goal(Point(2.0, 0.0, 0.0), PoseStamped())
    assert [text.replace("goal x 0.00 y 0.00 in map", "goal") for text in system.statuses] == [
        "robocop_goto_as is ready, no goal yet",
        "goal is ACTIVE",
        "goal is ACTIVE: driving (position_error 0.50 m, angle_error 0.10 rad)",
        "robocop_goto_as is ready, last goal SUCCEEDED: REACHED: so",
        "goal is ACTIVE",
    ]


def test_status_is_reported_periodically_and_frames_and_timeout_are_those_of_the_transforms(system):
    assert system.timers == [(BridgeParams().status_period, system.bridge.publish_state)]
    assert system.transforms == [("odom", "map", BridgeParams().transform_timeout)]
