"""robocop_rviz_goto_ac: RViz's 2D Nav Goal -> tf2 -> GoToPosition goal, and a periodic status report."""

import threading
from typing import Callable, Optional

import rospy
from geometry_msgs.msg import Point, PoseStamped
from std_msgs.msg import String

from aro_robocop_goto_as.msg import GoToPositionFeedback

from ...errors import FrameError
from ...names import ACTION, BRIDGE, position_text
from ..node_main import answer_help, load_params, node
from .goal_follower import GoalFollower
from .goal_frame import GoalTransformer
from .params import BridgeParams

POLL = 0.1  # [s, wall] between two checks for a newer click, for the server and for shutdown


class Bridge:
    """A callback stores the newest click, the main thread makes a goal of it, and a timer reports the status."""

    def __init__(self, p: BridgeParams) -> None:
        self.p = p
        self.click = PoseStamped()
        self.clicked = threading.Event()  # there is a click that is not served yet
        self.where = ""  # the place of the newest goal as it was clicked
        self.feedback: Optional[GoToPositionFeedback] = None  # of this goal
        self.sending = threading.Lock()  # held while a goal is being sent: it is reported only afterwards
        self.last_status = ""
        self.transformer = GoalTransformer(p.goal_frame, p.default_frame, p.transform_timeout)
        self.goal = GoalFollower(ACTION, self.on_feedback)
        self.status = rospy.Publisher("~status", String, queue_size=1, latch=True)
        rospy.Subscriber("move_base_simple/goal", PoseStamped, self.on_click, queue_size=10)
        rospy.Timer(rospy.Duration.from_sec(p.status_period), self.publish_state, reset=True)

    def on_click(self, message: PoseStamped) -> None:
        """Store a click; a callback."""
        self.click = message
        self.clicked.set()

    def on_feedback(self, feedback: GoToPositionFeedback) -> None:
        """Store feedback; a callback."""
        self.feedback = feedback

    # -- clicks, in the main thread --

    def run(self) -> None:
        """Forward clicks until shutdown."""
        self.publish_state()  # also where simulated time stands still, so that no timer fires
        while not rospy.is_shutdown():
            if not self.clicked.wait(POLL):
                continue
            self.clicked.clear()
            click = self.click
            try:
                position = self.resolve(click)
            except FrameError as error:
                self.publish(f"goal refused: {error}", rospy.logerr)
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
        """Wait for the server, cancel the earlier goal, send this one; a newer click ends this, and takes its place.

        Reports name the place that was clicked, as the view shows it.
        """
        where = position_text(click.pose.position.x, click.pose.position.y, self.transformer.frame_of(click))
        self.wait_for_server(where)
        self.cancel_goal()
        if self.clicked.is_set() or rospy.is_shutdown():
            return
        with self.sending:
            self.where = where
            self.feedback = None
            self.goal.send(position)
        rospy.loginfo(
            "goal sent: %s, for the server %s", where, position_text(position.x, position.y, self.p.goal_frame)
        )
        self.publish_state()

    def wait_for_server(self, where: str) -> None:
        """Wait as the client's wait_for_server() does, but only until there is a newer click or the node ends."""
        if not self.goal.is_up():
            rospy.logwarn("the goal %s is sent when %s is up", where, ACTION)
        while not (self.goal.is_up() or rospy.is_shutdown() or self.clicked.wait(POLL)):
            pass

    def cancel_goal(self) -> None:
        """Cancel the earlier goal, if it runs, and wait for its end."""
        if self.goal.is_up() and not self.goal.has_ended() and not self.goal.cancel(self.p.cancel_timeout):
            rospy.logwarn(
                "the earlier goal did not end within %g s of its cancel; sending the new goal preempts it",
                self.p.cancel_timeout,
            )

    # -- status --

    def publish_state(self, _event: Optional[rospy.timer.TimerEvent] = None) -> None:
        """Publish the state of the server, and of the newest goal as this client knows it."""
        if not self.goal.is_up():
            log = rospy.logwarn if self.last_status else rospy.loginfo  # both may have been started just now
            return self.publish(f"waiting for {ACTION}; if it has ended, its terminal says why", log)
        with self.sending:
            text = self.state()
        self.publish(text, rospy.loginfo)

    def state(self) -> str:
        """The newest goal's state in words, with the newest feedback or how the goal ended."""
        if not self.where:
            return f"{ACTION} is ready, no goal yet"
        if self.goal.has_ended():
            return f"{ACTION} is ready, last goal {self.goal.state()}"
        text, feedback = f"goal {self.where} is {self.goal.state()}", self.feedback
        if feedback is None:
            return text
        errors = f"position_error {feedback.position_error:.2f} m, angle_error {feedback.angle_error:.2f} rad"
        return f"{text}: {feedback.message} ({errors})"

    def publish(self, text: str, log: Callable[..., None]) -> None:
        """Publish a status, and log it if it has changed."""
        if text != self.last_status:
            log("%s", text)
        self.last_status = text
        self.status.publish(text)


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it can't start, with the reason logged."""
    answer_help("The bridge: makes goals of robocop_goto_as from 2D Nav Goals of RViz (/move_base_simple/goal).")
    with node(BRIDGE):
        Bridge(load_params(BridgeParams)).run()
