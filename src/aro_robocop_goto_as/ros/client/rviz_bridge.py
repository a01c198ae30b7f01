"""robocop_rviz_goto_ac: RViz's 2D Nav Goal -> tf2 -> GoToPosition goal, and a periodic status report."""

import logging
import threading
import time
from typing import Callable, Optional

import actionlib
import rospy
from actionlib_msgs.msg import GoalID
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import String

from aro_robocop_goto_as.msg import (
    GoToPositionAction,
    GoToPositionFeedback,
    GoToPositionGoal,
    GoToPositionResult,
)

from ...errors import FrameError
from ...names import ACTION, BRIDGE, position_text
from ..node_main import answer_help, load_params, node
from . import discovery
from .goal_frame import GoalTransformer
from .goal_states import STATES, UNFINISHED, ending
from .params import BridgeParams

SERVER_TIMEOUT = 10.0  # [s, wall] without the server until the status says what to do; it starts within a few seconds
UNLOGGED = (
    "Got a transition callback on a goal handle",  # actionlib's error if a goal starts before send_goal() has returned
)
IDLE_POLL = 0.1  # [s, wall] between two checks for shutdown while no click arrives


class Bridge:
    """Callbacks store the newest click; the main thread transforms and sends it; a timer reports the status."""

    def __init__(self, p: BridgeParams) -> None:
        self.p = p
        self.odom: Optional[Odometry] = None
        self.click = PoseStamped()
        self.clicked = threading.Event()  # there is a click that is not served yet
        self.where = ""  # the place of the current goal as it was clicked
        self.waiting = ""  # that of a goal which is kept for a server that comes later
        self.feedback: Optional[GoToPositionFeedback] = None  # of the current goal
        self.ending = ""  # of the last goal: state and message
        self.has_ended = threading.Event()  # the goal that was sent last
        self.sending = threading.Lock()  # held while a goal is being sent: it is reported only afterwards
        self.last_status = ""
        self.last_seen = time.monotonic()  # when the server was up
        self.transformer = GoalTransformer(p.goal_frame, p.default_frame, p.transform_timeout, lambda: self.odom)
        self.client = actionlib.SimpleActionClient(ACTION, GoToPositionAction)
        self.status = rospy.Publisher("~status", String, queue_size=1, latch=True)
        rospy.Subscriber("odom", Odometry, self.on_odom, queue_size=1)
        rospy.Subscriber("move_base_simple/goal", PoseStamped, self.on_click, queue_size=10)
        rospy.Subscriber(f"{ACTION}/cancel", GoalID, self.on_cancel, queue_size=10)
        rospy.Timer(rospy.Duration.from_sec(p.status_period), self.report, reset=True)

    def on_odom(self, message: Odometry) -> None:
        """Store odometry; a callback."""
        self.odom = message

    def on_click(self, message: PoseStamped) -> None:
        """Store a click; a callback."""
        self.click = message
        self.clicked.set()

    def on_cancel(self, message: GoalID) -> None:
        """Drop a goal that waits for its server when all goals are cancelled; a callback."""
        if not message.id:
            self.waiting = ""

    # -- clicks, in the main thread --

    def run(self) -> None:
        """Forward clicks until shutdown."""
        while not rospy.is_shutdown():
            if not self.clicked.wait(IDLE_POLL):
                if not self.last_status and time.monotonic() - self.last_seen > SERVER_TIMEOUT:
                    self.report()  # simulated time does not pass, and so no timer fires
                continue
            self.clicked.clear()
            click = self.click
            try:
                position = self.resolve(click)
            except FrameError as error:
                self.publish_status(f"goal refused: {error}", rospy.logerr)
            else:
                self.replace_goal(position, click)

    def resolve(self, click: PoseStamped) -> Point:
        """The clicked position in the server's frame; FrameError if it is not known there."""
        if not self.p.ignore_goal_frame:
            return self.transformer.resolve(click)
        rospy.logwarn_once(
            "ignore_goal_frame is set: coordinates in %r are sent to the server as if they were in %r",
            click.header.frame_id,
            self.p.goal_frame,
        )
        return click.pose.position

    def replace_goal(self, position: Point, click: PoseStamped) -> None:
        """Cancel the earlier goal, wait for its end, then send this one, unless a newer click arrives meanwhile.

        Reports name the place that was clicked, as the view shows it.
        """
        where = position_text(click.pose.position.x, click.pose.position.y, self.transformer.frame_of(click))
        if not discovery.is_up(self.client) and not self.wait_for_server(where):
            return
        self.cancel_goal()
        if self.clicked.is_set() or rospy.is_shutdown():
            return
        with self.sending:
            self.where = where
            self.feedback = None
            self.has_ended.clear()
            self.client.send_goal(GoToPositionGoal(position), done_cb=self.on_done, feedback_cb=self.on_feedback)
        rospy.loginfo(
            "goal sent: %s, for the server %s", self.where, position_text(position.x, position.y, self.p.goal_frame)
        )
        self.report()

    def wait_for_server(self, where: str) -> bool:
        """Keep a goal until its server is up; False if a newer click or a cancel comes first, or the node ends."""
        self.waiting = where
        rospy.logwarn("%s; the goal is sent when the server is up", discovery.absence(ACTION))
        self.report()
        while self.waiting and not discovery.is_up(self.client):
            if self.clicked.wait(IDLE_POLL) or rospy.is_shutdown():
                break
        kept, self.waiting = bool(self.waiting), ""
        if not kept:
            rospy.loginfo("goal cancelled before its server was up: %s", where)
            self.report()
        return kept and not (self.clicked.is_set() or rospy.is_shutdown())

    def cancel_goal(self) -> None:
        """Cancel the current goal, if there is one, and wait for its end."""
        if not self.where or self.has_ended.is_set():
            return
        self.client.cancel_goal()
        if self.has_ended.wait(self.p.cancel_timeout):
            self.client.wait_for_result()  # actionlib calls on_done before its own state changes
        else:
            rospy.logwarn(
                "the earlier goal did not end within %g s of its cancel; sending the new goal preempts it",
                self.p.cancel_timeout,
            )

    def on_feedback(self, feedback: GoToPositionFeedback) -> None:
        """Store feedback; a callback."""
        self.feedback = feedback

    def on_done(self, state: int, result: Optional[GoToPositionResult]) -> None:
        """Store how the goal ended; a callback."""
        self.ending = ending(state, result)
        rospy.loginfo("goal ended, %s", self.ending)
        self.has_ended.set()

    # -- status report --

    def report(self, _event: Optional[rospy.timer.TimerEvent] = None) -> None:
        """Publish the state of the server, and of the last goal as this client knows it."""
        log = rospy.loginfo
        if not discovery.is_up(self.client):
            text = discovery.absence(ACTION)
            if self.waiting:
                text += f"; goal {self.waiting} waits for it"
            if time.monotonic() - self.last_seen > SERVER_TIMEOUT:
                text, log = f"{text}; {discovery.advice()}", rospy.logwarn
            return self.publish_status(text, log)
        self.last_seen = time.monotonic()
        with self.sending:
            if self.where and not self.has_ended.is_set():
                return self.publish_status(self.progress(), log)
        last = f"last goal {self.ending}" if self.where else "no goal yet"
        self.publish_status(f"{ACTION} is ready, {last}", log)

    def progress(self) -> str:
        """The current goal's state and feedback in words."""
        state, feedback = STATES[self.client.get_state()], self.feedback
        if state not in UNFINISHED:
            return f"goal {self.where} has ended ({state}), waiting for its result"
        if feedback is None:
            return f"goal {self.where} is {state}"
        errors = f"position_error {feedback.position_error:.2f} m, angle_error {feedback.angle_error:.2f} rad"
        return f"goal {self.where} is {state}: {feedback.message} ({errors})"

    def publish_status(self, text: str, log: Callable[..., None]) -> None:
        """Publish a status, and log it if it has changed."""
        if text != self.last_status:
            log("%s", text)
        self.last_status = text
        self.status.publish(text)


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it can't start, with the reason logged."""
    logging.getLogger("rosout").addFilter(lambda record: not record.getMessage().startswith(UNLOGGED))
    answer_help("The bridge: makes goals of robocop_goto_as from 2D Nav Goals of RViz (/move_base_simple/goal).")
    with node(BRIDGE):
        Bridge(load_params(BridgeParams)).run()
