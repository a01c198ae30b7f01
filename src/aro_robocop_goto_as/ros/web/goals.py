"""Goals: sent by a click, cancelled, with their feedback and their results. A click can also place the robot."""

from collections import deque
from dataclasses import dataclass
from functools import partial
from typing import Any, Deque, Dict, Optional, Set, Tuple

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionGoal, GoToPositionActionResult
from aro_robocop_goto_as.srv import SetPose

from ...names import ACTION, absolute
from ...web import text
from ...web.page import floor_point
from ...web.state import PageState
from .. import convert, markers
from ..client.goal_states import STATES, UNFINISHED, result_text
from ..connected_nodes import publishers_of
from ..marker_shapes import MarkerStore
from .part import Context, Inbox, Part
from .requests import Requests

SEND_GOAL, PLACE_ROBOT = "sends a goal", "places the robot"
POSITION_VARIANCE, YAW_VARIANCE = 0.25, 0.0685  # of RViz's 2D Pose Estimate: 0.5 m and 15 degrees, squared
REMEMBERED = 8  # goals in the history
TOLERANCE = 0.1  # [m] at which the handout counts a goal as reached


def cancel(requests: Requests) -> None:
    """Cancel all goals of the selected robot's server."""
    requests.publish("cancel", f"{ACTION}/cancel", GoalID(), ": is the server running?")


@dataclass(frozen=True)
class Ended:
    """A goal that has ended."""

    robot: str
    state: str  # of actionlib, as SUCCEEDED
    message: str
    goal: Optional[Tuple[float, float]]  # [m] in the server's frame, if it was seen or its server names it


class GoalHistory:
    """The goals and their results, by actionlib ids."""

    def __init__(self) -> None:
        self._goals: Dict[str, Tuple[float, float]] = {}
        self.latest: Deque[Ended] = deque(maxlen=REMEMBERED)  # the newest first

    def sent(self, goal_id: str, x: float, y: float) -> None:
        """A goal was sent to a server [m]."""
        self._goals[goal_id] = (x, y)
        for oldest in list(self._goals)[:-REMEMBERED]:
            del self._goals[oldest]

    def position(self, goal_id: str) -> Optional[Tuple[float, float]]:
        """A goal's position [m] in the server's frame, if it was seen and is not too old."""
        return self._goals.get(goal_id)

    def named(self, goal_id: str) -> None:
        """A server names a goal: a goal that was sent without an id, as by `rostopic pub`, has the first unknown id."""
        if goal_id not in self._goals and "" in self._goals:
            self._goals[goal_id] = self._goals.pop("")

    def ended(self, robot: str, goal_id: str, state: str, message: str) -> None:
        """A result was received."""
        self.named(goal_id)
        self.latest.appendleft(Ended(robot, state, message, self.position(goal_id) or text.goal_in(message)))


class GoalsPart(Part):
    """The goals of all robots. Their results are received also without a browser, for the history of later visitors."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        gui, live = context.server.gui, context.state.now.live
        self._feedback_html = gui.add_html("")
        self._mode = gui.add_dropdown("Tap or click", (SEND_GOAL, PLACE_ROBOT), visible=live, hint="on the floor")
        self._cancel = gui.add_button("Cancel goal", icon="x", visible=live)
        self._cancel.on_click(lambda _: cancel(context.requests))
        self._history_html: Any = None
        self._robot = ""  # the robot to which the four fields below belong
        self._status: Optional[rospy.Subscriber] = None  # of its server
        self._executing: Optional[bool] = None  # as its newest status says; None before the first one
        self._newest: Optional[GoalStatus] = None  # of the newest goal; actionlib's servers report it for five seconds
        self._feedback: Any = None  # the message
        self._history = GoalHistory()
        self._resets = 0  # how often robots had been placed when the newest goal was shown
        self._forgotten = ""  # a goal that ended before, which its server still reports for some seconds
        self._watched: Set[str] = set()
        context.server.scene.on_click()(self._on_click)

    def add_history(self) -> None:
        """Show the last goals in the part of the panel that is open now."""
        gui = self.context.server.gui
        with gui.add_folder("Goals"):
            self._history_html = gui.add_html("")

    def _on_click(self, event: Any) -> None:
        point = floor_point(event.ray_origin, event.ray_direction)
        state, requests = self.context.state.now, self.context.requests
        if point is None or not state.live:
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
        self._robot, self._feedback, self._executing, self._newest = robot, None, None, None
        self._status = inbox.subscribe(absolute(robot, f"{ACTION}/status"), GoalStatusArray, self._on_status)
        inbox.subscribe(absolute(robot, f"{ACTION}/feedback"), GoToPositionActionFeedback, self._on_feedback)

    def ask_master(self, state: PageState, inbox: Inbox) -> None:
        for robot in set(state.robots) - self._watched:
            self._watched.add(robot)
            name = absolute(robot, ACTION)
            inbox.subscribe(f"{name}/goal", GoToPositionActionGoal, self._on_goal, None)
            inbox.subscribe(f"{name}/result", GoToPositionActionResult, partial(self._on_result, robot), None)

    def _on_feedback(self, _: float, message: GoToPositionActionFeedback) -> None:
        self._feedback = message.feedback

    def _on_status(self, _: float, message: GoalStatusArray) -> None:
        self._executing = any(STATES.get(entry.status) in UNFINISHED for entry in message.status_list)
        for entry in message.status_list:
            self._history.named(entry.goal_id.id)
        known = (entry for entry in message.status_list if entry.goal_id.id != self._forgotten)
        self._newest = max(known, key=lambda entry: entry.goal_id.stamp, default=self._newest)

    def _on_goal(self, _: float, message: GoToPositionActionGoal) -> None:
        self._history.sent(message.goal_id.id, message.goal.position.x, message.goal.position.y)

    def _on_result(self, robot: str, _: float, message: GoToPositionActionResult) -> None:
        if robot == self._robot:
            self._feedback = None
        state, goal_id = message.status.status, message.status.goal_id.id
        self._history.ended(robot, goal_id, STATES.get(state, ""), result_text(state, message.result.message))

    def show(self, state: PageState) -> None:
        if state.resets != self._resets and self._newest is not None and not self._executing:
            self._newest, self._forgotten = None, self._newest.goal_id.id
        self._resets = state.resets
        connected = self._status is not None and bool(publishers_of(self._status))
        if not connected and not state.recorded:  # its server is gone
            self._executing = self._newest = self._feedback = None
        if self._executing is False:
            self._feedback = None
        answering = connected if not state.recorded else self._executing is not None
        if self._robot == self.context.state.now.selected:  # not of a robot that was chosen just now
            self.context.state.change(executing=self._executing, answering=answering)
        goal, errors, progress = self._show_goal(state.selected), "", ""
        if state.waiting:
            goal = f"waits for its server: {state.waiting}"
        elif self._feedback is not None:
            errors = f"{self._feedback.position_error:.2f} m, {self._feedback.angle_error:.2f} rad"
            progress = self._feedback.message
        self._cancel.disabled = (not answering or self._executing is False) and not state.waiting
        # All rows at all times: the buttons below stay where they are when a goal begins or ends.
        rows = (("goal", goal), ("errors", errors), ("feedback", progress))
        self._feedback_html.content = text.table((name, value or "–") for name, value in rows)
        if self._history_html is not None:
            several = len(state.robots) > 1
            lines = (self._ended(ended, several) for ended in self._history.latest)
            self._history_html.content = text.history(lines)

    def _show_goal(self, robot: str) -> str:
        """The newest goal's state, as actionlib names it, and its position; empty without a goal.

        It is drawn, unless the server publishes markers, as this package's does with its own tolerance.
        """
        drawn, newest, shown = MarkerStore(), self._newest, ""
        if newest is not None:
            state, goal = STATES.get(newest.status, ""), self._history.position(newest.goal_id.id)
            shown = f"{state} {self.context.place(robot, *goal)}" if goal else state
            if goal is not None and not self.context.scene.draws("server"):
                color = markers.goal_color(state in UNFINISHED, newest.status == GoalStatus.SUCCEEDED)
                drawn.apply(MarkerArray(markers.goal(TOLERANCE, *goal, self.context.frame_of(robot, "odom"), color)))
        self.context.scene.show("goal", drawn.placed(self.context.locate))
        return shown

    def _ended(self, ended: Ended, several: bool) -> Tuple[bool, str]:
        outcome, colon, message = text.short(ended.message).partition(": ")
        if not (colon and outcome.isupper()):  # of another server
            outcome, message = ended.state, ended.message
        place = "" if ended.goal is None else self.context.place(ended.robot, *ended.goal)
        words = " ".join(filter(None, (ended.robot if several else "", outcome, place)))
        return ended.state == "SUCCEEDED", ", ".join(filter(None, (words, message)))
