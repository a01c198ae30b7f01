"""Goals: sent by a click, cancelled, with feedback and result. A click can also place the robot."""

from typing import Any, Optional

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.msg import (
    GoToPositionActionFeedback,
    GoToPositionActionGoal,
    GoToPositionActionResult,
    GoToPositionFeedback,
)
from aro_robocop_goto_as.srv import SetPose

from ...names import ACTION, absolute
from ...web import text
from ...web.page import floor_point
from ...web.state import PageState
from .. import convert, markers
from ..client.goal_follower import STATES, UNFINISHED
from ..connected_nodes import publishers_of
from ..marker_shapes import MarkerStore
from .part import Context, Inbox, Part
from .requests import Requests

SEND_GOAL, PLACE_ROBOT = "sends a goal", "places the robot"
POSITION_VARIANCE, YAW_VARIANCE = 0.25, 0.0685  # of RViz's 2D Pose Estimate: 0.5 m and 15 degrees, squared
TOLERANCE = 0.1  # [m] at which the handout counts a goal as reached


def cancel(requests: Requests) -> None:
    """Cancel all goals of the selected robot's server."""
    requests.publish("cancel", f"{ACTION}/cancel", GoalID(), ": is the server running?")


class GoalsPart(Part):
    """The newest goal of the selected robot, whoever sent it, from the topics of its server."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        gui, can_send = context.server.gui, context.state.now.can_send
        self._goal_html = gui.add_html("")
        self._mode = gui.add_dropdown("Tap or click", (SEND_GOAL, PLACE_ROBOT), visible=can_send, hint="on the floor")
        self._cancel = gui.add_button("Cancel goal", icon="x", visible=can_send)
        self._cancel.on_click(lambda _: cancel(context.requests))
        self._robot = ""  # the robot to which the fields of _forget belong
        self._status: Optional[rospy.Subscriber] = None  # of its server
        self._forget()
        self._resets = 0  # how often robots had been placed when the newest goal was shown
        self._forgotten = ""  # a goal that ended before, which its server still reports for some seconds
        context.server.scene.on_click()(self._on_click)

    def _forget(self) -> None:
        self._executing: Optional[bool] = None  # as the server's newest status says; None before the first one
        self._goal: Optional[GoToPositionActionGoal] = None  # that was sent last
        self._newest: Optional[GoalStatus] = None  # of the newest goal; actionlib's servers report it for five seconds
        self._feedback: Optional[GoToPositionFeedback] = None  # of the goal that is executed
        self._ending = ""  # the message of the result

    def _on_click(self, event: Any) -> None:
        point = floor_point(event.ray_origin, event.ray_direction)
        state, requests = self.context.state.now, self.context.requests
        if point is None or not state.can_send:
            return
        place, pose = self._mode.value == PLACE_ROBOT, PoseStamped()
        where = f"{'pose' if place else 'goal'} {text.position(*point)}"
        pose.header.frame_id = state.root  # with time zero, which means the newest transforms
        pose.pose.position.x, pose.pose.position.y = point
        pose.pose.orientation = convert.to_quaternion(state.pose.on_plane().yaw if place and state.pose else 0.0)
        if not place:  # a 2D Nav Goal, which the bridge makes a goal of
            requests.publish(where, "move_base_simple/goal", pose, ": is the bridge running?")
        elif state.simulated:
            requests.call(where, "set_pose", SetPose, state.selected, pose)
        else:  # for a localization
            estimate = PoseWithCovarianceStamped(header=pose.header)
            estimate.pose.pose = pose.pose
            variances = (POSITION_VARIANCE, POSITION_VARIANCE, 0.0, 0.0, 0.0, YAW_VARIANCE)
            estimate.pose.covariance = convert.diagonal(variances)
            requests.publish(where, "initialpose", estimate)

    def subscribe_to_robot(self, inbox: Inbox, robot: str) -> None:
        self._robot, name = robot, absolute(robot, ACTION)
        self._forget()
        inbox.subscribe(f"{name}/goal", GoToPositionActionGoal, self._on_goal)
        self._status = inbox.subscribe(f"{name}/status", GoalStatusArray, self._on_status)
        inbox.subscribe(f"{name}/feedback", GoToPositionActionFeedback, self._on_feedback)
        inbox.subscribe(f"{name}/result", GoToPositionActionResult, self._on_result)

    def _on_goal(self, _: float, message: GoToPositionActionGoal) -> None:
        self._goal, self._ending = message, ""

    def _on_status(self, _: float, message: GoalStatusArray) -> None:
        self._executing = any(STATES.get(entry.status) in UNFINISHED for entry in message.status_list)
        known = (entry for entry in message.status_list if entry.goal_id.id != self._forgotten)
        self._newest = max(known, key=lambda entry: entry.goal_id.stamp, default=self._newest)

    def _on_feedback(self, _: float, message: GoToPositionActionFeedback) -> None:
        self._feedback = message.feedback

    def _on_result(self, _: float, message: GoToPositionActionResult) -> None:
        self._feedback, self._newest = None, message.status
        self._ending = message.result.message or message.status.text

    def show(self, state: PageState) -> None:
        if state.resets != self._resets and self._newest is not None and not self._executing:
            self._newest, self._ending, self._forgotten = None, "", self._newest.goal_id.id
        self._resets = state.resets
        connected = self._status is not None and bool(publishers_of(self._status))
        if not connected and not state.recorded:  # its server is gone
            self._forget()
        if self._executing is False:
            self._feedback = None
        answering = connected if not state.recorded else self._executing is not None
        if self._robot == self.context.state.now.selected:  # not of a robot that was chosen just now
            self.context.state.change(executing=self._executing, answering=answering)
        self._cancel.disabled = self._executing is False
        goal, errors, report = self._show_goal(state.selected), "", self._ending
        if self._feedback is not None:
            errors = f"{self._feedback.position_error:.2f} m, {self._feedback.angle_error:.2f} rad"
            report = self._feedback.message
        # All rows at all times: the buttons below stay where they are when a goal begins or ends.
        rows = text.table((name, value or "–") for name, value in (("goal", goal), ("errors", errors)))
        self._goal_html.content = rows + text.report(report)

    def _show_goal(self, robot: str) -> str:
        """The newest goal's state, as actionlib names it, and its position; empty without a goal.

        It is drawn, unless the server publishes markers, as this package's does with its own tolerance.
        """
        drawn, newest, goal = MarkerStore(), self._newest, self._goal
        shown = "" if newest is None else STATES.get(newest.status, "")
        if newest is not None and goal is not None and goal.goal_id.id in ("", newest.goal_id.id):  # servers give ids
            x, y = goal.goal.position.x, goal.goal.position.y
            if not self.context.scene.draws("server"):
                color = markers.goal_color(shown in UNFINISHED, newest.status == GoalStatus.SUCCEEDED)
                drawn.apply(MarkerArray(markers.goal(TOLERANCE, x, y, self.context.frame_of(robot, "odom"), color)))
            shown += f" {self.context.place(robot, x, y)}"
        self.context.scene.show("goal", drawn.placed(self.context.locate))
        return shown
