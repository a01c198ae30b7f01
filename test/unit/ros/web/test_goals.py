"""What a click on the floor requests, and what is shown of the newest goal."""

from unittest.mock import MagicMock

import pytest
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionGoal, GoToPositionActionResult
from frames_of_tests import transform

from aro_robocop_goto_as.geometry import Pose2D, lifted
from aro_robocop_goto_as.ros import markers
from aro_robocop_goto_as.ros.web import goals
from aro_robocop_goto_as.ros.web.frames import Frames
from aro_robocop_goto_as.ros.web.part import Context
from aro_robocop_goto_as.web.state import PageState, SharedState

CLICK = MagicMock(ray_origin=(1.0, 2.0, 3.0), ray_direction=(0.0, 0.0, -1.0))


def made(**state):
    shared = SharedState(PageState(robots=("blue", "red"), chosen="red", pose=lifted(Pose2D(0.0, 0.0, 3.0)), **state))
    context = Context(MagicMock(), MagicMock(), shared, MagicMock(), Frames(), "map")
    part, inbox = goals.GoalsPart(context), MagicMock()
    inbox.subscribe.return_value.impl.connections = [MagicMock(callerid_pub="/server")]
    part.subscribe_to_robot(inbox, "red")
    return part, context


def clicked(mode, **state):
    part, context = made(root="red/odom", **state)
    part._mode.value = mode
    part._on_click(CLICK)
    return context.requests


@pytest.mark.parametrize("simulated", [True, False])
def test_a_click_places_the_robot_with_the_heading_that_it_has(simulated):
    requests = clicked(goals.PLACE_ROBOT, simulated=simulated)
    if simulated:
        _, service, _, robot, request = requests.call.call_args[0]
        pose = request.pose
        assert (service, robot) == ("set_pose", "red")
    else:
        _, topic, request = requests.publish.call_args[0]
        assert topic == "initialpose" and request.pose.covariance[0] == goals.POSITION_VARIANCE
        pose = request.pose.pose
    assert (request.header.frame_id, pose.position.x, pose.position.y) == ("red/odom", 1.0, 2.0)
    assert pose.orientation.z == pytest.approx(goals.convert.to_quaternion(3.0).z)


def test_a_click_is_a_goal_in_the_frame_of_the_scene():
    _, topic, pose, _ = clicked(goals.SEND_GOAL).publish.call_args[0]
    assert topic == "move_base_simple/goal"
    assert (pose.header.frame_id, pose.pose.position.x, pose.pose.position.y) == ("red/odom", 1.0, 2.0)


def test_a_click_into_the_sky_requests_nothing():
    part, context = made()
    part._on_click(MagicMock(ray_origin=(1.0, 2.0, 3.0), ray_direction=(0.0, 0.0, 1.0)))
    assert not context.requests.method_calls


def shown(part, context):
    """Whether the server is there, whether it executes a goal, and whether feedback is shown."""
    part.show(context.state.now)
    state = context.state.now
    return state.answering, state.executing, "0.00 rad" in part._goal_html.content


def test_a_goal_is_executed_until_its_server_reports_its_end_or_is_gone_however_long_both_take():
    part, context = made()
    assert shown(part, context) == (True, None, False)
    earlier, goal = GoalStatus(status=GoalStatus.ABORTED), GoalStatus(status=GoalStatus.ACTIVE)
    part._on_feedback(0.0, GoToPositionActionFeedback())  # long ago by the wall clock, as in a pause
    part._on_status(0.0, GoalStatusArray(status_list=[earlier, goal]))
    assert shown(part, context) == (True, True, True)
    for ended in ([earlier, GoalStatus(status=GoalStatus.SUCCEEDED)], []):
        part._on_status(0.0, GoalStatusArray(status_list=ended))
        assert shown(part, context) == (True, False, False)
    part._on_status(0.0, GoalStatusArray(status_list=[goal]))
    part._status.impl.connections = []
    assert shown(part, context) == (False, None, False)


def test_the_result_takes_the_place_of_the_feedback_also_where_no_status_is_reported_as_in_a_recording():
    part, context = made(recorded=True)
    part._on_feedback(0.0, GoToPositionActionFeedback())
    assert shown(part, context) == (False, None, True)
    result = GoToPositionActionResult()
    result.status.status, result.result.message = GoalStatus.SUCCEEDED, "REACHED: so"
    part._on_result(0.0, result)
    assert shown(part, context) == (False, None, False)
    assert all(words in part._goal_html.content for words in ("SUCCEEDED", "REACHED: so"))
    part._on_goal(0.0, GoToPositionActionGoal())
    part.show(context.state.now)
    assert "REACHED" not in part._goal_html.content


def test_a_goal_is_shown_in_the_fixed_frame_with_the_state_that_actionlib_names():
    part, context = made()
    goal, status = GoToPositionActionGoal(), GoalStatus(status=GoalStatus.ACTIVE)
    goal.goal_id.id = status.goal_id.id = "goal"
    goal.goal.position.x = 1.0
    part._on_goal(0.0, goal)
    part._on_status(0.0, GoalStatusArray(status_list=[status]))
    assert part._show_goal("red") == "ACTIVE (1.00, 0.00) in odom"
    context.frames.update(transform("map", "red/odom", -0.7, 0.2))
    assert part._show_goal("red") == "ACTIVE (0.30, 0.20)"


def test_a_goal_that_has_ended_is_no_longer_shown_when_robots_are_placed_anew():
    part, context = made()
    ended = GoalStatusArray(status_list=[GoalStatus(GoalID(id="goal"), GoalStatus.SUCCEEDED, "")])
    for resets, is_shown in ((0, True), (1, False), (1, False)):
        context.state.change(resets=resets)
        part._on_status(0.0, ended)  # as its server does for some seconds
        part.show(context.state.now)
        assert ("SUCCEEDED" in part._goal_html.content) == is_shown


def test_a_goal_that_the_bridge_keeps_for_a_server_that_is_down_can_be_cancelled():
    part, context = made()
    part._status.impl.connections = []
    part.show(context.state.now)
    assert part._cancel.disabled is False


@pytest.mark.parametrize("sent, shows", [("one", True), ("", True), ("another", False)])
def test_the_position_shown_is_that_of_the_goal_which_the_server_reports_and_may_have_named(sent, shows):
    part, _ = made()
    part._on_goal(0.0, GoToPositionActionGoal(goal_id=GoalID(id=sent)))
    part._on_status(0.0, GoalStatusArray(status_list=[GoalStatus(GoalID(id="one"), GoalStatus.ACTIVE, "")]))
    assert ("(0.00, 0.00)" in part._show_goal("red")) == shows


def drawn(part, context):
    """The goal's shapes by name."""
    part.show(context.state.now)
    group = next(call[0][1] for call in reversed(context.scene.show.call_args_list) if call[0][0] == "goal")
    return {name: (shape.color, pose.position) for (name, _), (shape, pose) in group.items()}


@pytest.mark.parametrize(
    "status, color",
    [
        (GoalStatus.ACTIVE, markers.GOAL_COLOR),
        (GoalStatus.SUCCEEDED, markers.REACHED),
        (GoalStatus.ABORTED, markers.NOT_REACHED),
    ],
)
def test_the_goal_of_a_server_without_markers_is_drawn_and_stays_when_its_status_is_no_longer_reported(status, color):
    part, context = made(root="red/odom")
    context.frames.update(transform("red/odom", "red/base_footprint"))
    context.scene.draws.return_value = False
    goal = GoToPositionActionGoal()
    goal.goal_id.id, goal.goal.position.x = "goal", 1.0
    part._on_goal(0.0, goal)
    part._on_status(0.0, GoalStatusArray(status_list=[GoalStatus(goal.goal_id, status, "")]))
    part._on_status(0.0, GoalStatusArray())
    rgb = tuple(round(255 * value) for value in (color.r, color.g, color.b))
    assert drawn(part, context) == {"goal_circle": (rgb, (1.0, 0.0, 0.0)), "goal_pin": (rgb, (1.0, 0.0, 0.2))}
    context.scene.draws.return_value = True  # the server's markers
    assert drawn(part, context) == {}
