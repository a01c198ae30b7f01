"""A click becomes a goal, and the status says what becomes of the goal."""

from types import SimpleNamespace

import pytest
import rospy
from actionlib_msgs.msg import GoalID, GoalStatus
from aro_robocop_goto_as.msg import GoToPositionFeedback, GoToPositionResult
from geometry_msgs.msg import Point, PoseStamped

from aro_robocop_goto_as.errors import FrameError
from aro_robocop_goto_as.ros.client import rviz_bridge
from aro_robocop_goto_as.ros.client.goal_states import ending
from aro_robocop_goto_as.ros.client.params import BridgeParams

CHECKS = 6  # of is_shutdown, until the node ends


class System:
    """A bridge whose server is up, the calls of its client and its statuses; also stands for its client."""

    def __init__(self, monkeypatch):
        self.topics, self.calls, self.statuses, self.timers, self.transforms = {}, [], [], [], []
        self.on_cancel = self.on_status = self.wait_for_result = lambda: None
        self.is_up = True
        self.get_state = lambda: GoalStatus.ACTIVE
        checks = iter([False] * CHECKS)
        monkeypatch.setattr(rospy, "is_shutdown", lambda: next(checks, True))
        monkeypatch.setattr(rospy, "Subscriber", lambda name, _, callback, **__: self.topics.update({name: callback}))
        monkeypatch.setattr(rospy, "Publisher", lambda *_, **__: SimpleNamespace(publish=self.publish))
        monkeypatch.setattr(rospy, "Timer", lambda period, report, **__: self.timers.append((period.to_sec(), report)))
        monkeypatch.setattr(rviz_bridge.actionlib, "SimpleActionClient", lambda *_: self)
        monkeypatch.setattr(rviz_bridge.discovery, "is_up", lambda client: self.is_up)
        monkeypatch.setattr(rviz_bridge.discovery, "absence", lambda action: "absent")
        monkeypatch.setattr(rviz_bridge.discovery, "advice", lambda: "advice")
        transformer = SimpleNamespace(frame_of=lambda pose: "map", resolve=self.resolve)
        monkeypatch.setattr(rviz_bridge, "GoalTransformer", lambda *given: self.transforms.append(given) or transformer)
        self.bridge = rviz_bridge.Bridge(BridgeParams())

    def publish(self, status):
        self.statuses.append(status)
        self.on_status()

    def resolve(self, pose):
        if pose.pose.position.x < 0.0:
            raise FrameError("no transform")
        return Point(pose.pose.position.x + 10.0, 0.0, 0.0)

    def click(self, x):
        pose = PoseStamped()
        pose.pose.position.x = x
        self.topics["move_base_simple/goal"](pose)

    def send_goal(self, goal, done_cb, feedback_cb):
        self.calls.append(f"goal {goal.position.x:g}")
        self.done, self.feedback = done_cb, feedback_cb

    def cancel_goal(self):
        self.calls.append("cancel")
        self.on_cancel()
        self.done(GoalStatus.PREEMPTED, None)


@pytest.fixture
def system(monkeypatch):
    return System(monkeypatch)


def test_click_is_sent_once_in_the_servers_frame(system):
    system.click(1.0)
    system.bridge.run()
    assert system.calls == ["goal 11"]
    assert system.statuses == ["goal x 1.00 y 0.00 in map is ACTIVE"]


def test_goal_waits_for_a_server_that_is_missing_and_the_status_says_so_and_later_what_to_do(system, monkeypatch):
    system.is_up = False
    system.bridge.report()
    monkeypatch.setattr(rviz_bridge, "SERVER_TIMEOUT", 0.0)
    system.on_status = lambda: setattr(system, "is_up", True)
    system.click(1.0)
    system.bridge.run()
    assert system.calls == ["goal 11"]
    goal = "goal x 1.00 y 0.00 in map"
    assert system.statuses == ["absent", f"absent; {goal} waits for it; advice", f"{goal} is ACTIVE"]


@pytest.mark.parametrize("goal_id, sent", [("", []), ("another", ["goal 11"])])
def test_goal_that_waits_for_its_server_is_dropped_when_all_goals_are_cancelled(system, goal_id, sent):
    system.is_up = False

    def cancel():
        system.topics["robocop_goto_as/cancel"](GoalID(id=goal_id))
        system.is_up = True

    system.on_status = cancel
    system.click(1.0)
    system.bridge.run()
    assert system.calls == sent


def test_with_ignore_goal_frame_the_numbers_are_sent_as_they_are_with_a_warning(system, monkeypatch):
    warnings = []
    monkeypatch.setattr(rospy, "logwarn_once", lambda text, *values: warnings.append(text % values))
    system.bridge.p = BridgeParams(ignore_goal_frame=True)
    system.click(1.0)
    system.bridge.run()
    assert system.calls == ["goal 1"]
    assert [text.split(":")[0] for text in warnings] == ["ignore_goal_frame is set"]


def test_newer_click_cancels_the_goal_before_its_own_is_sent(system):
    system.bridge.replace_goal(Point(1.0, 0.0, 0.0), PoseStamped())
    system.click(2.0)
    system.bridge.run()
    assert system.calls == ["goal 1", "cancel", "goal 12"]


def test_click_that_is_outdated_before_it_is_sent_is_left_out(system):
    system.bridge.replace_goal(Point(1.0, 0.0, 0.0), PoseStamped())
    system.on_cancel = lambda: system.click(3.0)
    system.click(2.0)
    system.bridge.run()
    assert system.calls == ["goal 1", "cancel", "goal 13"]


def test_refused_click_leaves_the_earlier_goal(system):
    system.bridge.replace_goal(Point(1.0, 0.0, 0.0), PoseStamped())
    system.click(-1.0)
    system.bridge.run()
    assert (system.calls, system.statuses[-1]) == (["goal 1"], "goal refused: no transform")


def test_click_that_is_refused_while_the_earlier_goal_is_cancelled_says_nothing_of_that_goal(system, monkeypatch):
    errors = []
    monkeypatch.setattr(rospy, "logerr", lambda text, *values: errors.append(text % values))
    system.bridge.replace_goal(Point(1.0, 0.0, 0.0), PoseStamped())
    system.on_cancel = lambda: system.click(-1.0)
    system.click(2.0)
    system.bridge.run()
    assert (system.calls, errors) == (["goal 1", "cancel"], ["goal refused: no transform"])


def test_status_tells_of_the_last_goal(system):
    system.bridge.report()
    system.bridge.replace_goal(Point(1.0, 0.0, 0.0), PoseStamped())
    system.feedback(GoToPositionFeedback(0.5, 0.1, "driving"))
    system.bridge.report()
    system.done(GoalStatus.SUCCEEDED, GoToPositionResult(True, "REACHED: so"))
    system.bridge.report()
    system.bridge.replace_goal(Point(2.0, 0.0, 0.0), PoseStamped())
    assert [text.replace("goal x 0.00 y 0.00 in map", "goal") for text in system.statuses] == [
        "robocop_goto_as is ready, no goal yet",
        "goal is ACTIVE",
        "goal is ACTIVE: driving (position_error 0.50 m, angle_error 0.10 rad)",
        "robocop_goto_as is ready, last goal SUCCEEDED: REACHED: so",
        "goal is ACTIVE",
    ]


@pytest.mark.parametrize(
    "message, text", [(None, "ABORTED"), ("", "ABORTED"), ("STUCK: so", "ABORTED: STUCK: so"), ("ABORTED: so",) * 2]
)
def test_ending_is_the_state_and_the_message_of_the_result(message, text):
    assert ending(GoalStatus.ABORTED, None if message is None else GoToPositionResult(message=message)) == text


def test_ending_of_a_goal_that_actionlib_recalls_says_why_servers_recall_goals():
    assert ending(GoalStatus.RECALLED, GoToPositionResult()).startswith(
        "RECALLED: its server dropped it before it began"
    )
    assert ending(GoalStatus.RECALLED, GoToPositionResult(message="so")) == "RECALLED: so"


def test_status_is_reported_periodically_and_odometry_and_frames_are_those_of_the_transforms(system):
    assert system.timers == [(BridgeParams().status_period, system.bridge.report)]
    (*given, latest_odom) = system.transforms[0]
    assert given == ["odom", "map", BridgeParams().transform_timeout]
    system.topics["odom"]("newest")
    assert latest_odom() == "newest"


def test_status_of_a_goal_that_has_ended_without_its_result_says_what_is_missing(system):
    system.bridge.replace_goal(Point(1.0, 0.0, 0.0), PoseStamped())
    system.get_state = lambda: GoalStatus.SUCCEEDED
    system.bridge.report()
    assert system.statuses[-1].endswith(" in map has ended (SUCCEEDED), waiting for its result")
