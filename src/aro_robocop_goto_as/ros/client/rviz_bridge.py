"""robocop_rviz_goto_ac: RViz's 2D Nav Goal -> tf2 -> GoToPosition goal, and a periodic status report."""

import threading
import time
import traceback
from typing import Callable, Optional

import actionlib
import rospy
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import String

from aro_robocop_goto_as.msg import GoToPositionAction

from ...bridge_params import BridgeParams
from ...errors import FrameError
from ..names import ACTION, BRIDGE, place
from ..node_main import load_params, node
from ..ticker import start_timer, wait_until
from . import discovery
from .goal_frame import GoalTransformer
from .sent_goal import SentGoal

ADVICE_AFTER = 10.0  # [s, wall] without the server until the status says what to do; it starts within a few seconds
IDLE_POLL = 0.1  # [s, wall] between two checks for shutdown while no click arrives


class Bridge:
    """Callbacks store the newest click; the main thread transforms and sends it; a timer reports the status."""

    def __init__(self, p: BridgeParams) -> None:
        self.p = p
        self.odom: Optional[Odometry] = None
        self.click: Optional[PoseStamped] = None
        self.clicked = threading.Condition()
        self.sent: Optional[SentGoal] = None
        self.last_status = ""
        self.last_seen = time.monotonic()  # when the server was up
        self.transformer = GoalTransformer(p.goal_frame, p.default_frame, p.transform_timeout, lambda: self.odom)
        self.client = actionlib.ActionClient(ACTION, GoToPositionAction)
        self.status = rospy.Publisher("~status", String, queue_size=1, latch=True)
        rospy.Subscriber("odom", Odometry, self._on_odom, queue_size=1)
        rospy.Subscriber("move_base_simple/goal", PoseStamped, self._on_click, queue_size=10)
        self.timer = start_timer(p.status_period, self._report)

    def _on_odom(self, message: Odometry) -> None:
        self.odom = message

    def _on_click(self, message: PoseStamped) -> None:
        with self.clicked:
            self.click = message
            self.clicked.notify()

    # -- clicks, in the main thread --

    def run(self) -> None:
        """Forward clicks until shutdown."""
        while not rospy.is_shutdown():
            click = self._next_click()
            if click is None:
                continue
            try:
                self._replace_goal(self._resolve(click), click)
            except FrameError as error:
                rospy.logerr("goal refused, an earlier goal continues: %s", error)
                self._publish_status(f"goal refused: {error}", rospy.loginfo)
            except Exception:  # the click's outermost level: the next one is served nevertheless
                if not rospy.is_shutdown():
                    rospy.logerr("goal not sent:\n%s", traceback.format_exc())

    def _next_click(self) -> Optional[PoseStamped]:
        with self.clicked:
            if self.click is None:
                self.clicked.wait(IDLE_POLL)
            click, self.click = self.click, None
            return click

    def _resolve(self, click: PoseStamped) -> Point:
        if not self.p.ignore_goal_frame:
            return self.transformer.resolve(click)
        rospy.logwarn_once(
            "ignore_goal_frame is set: coordinates in %r are sent to the server as if they were in %r",
            click.header.frame_id,
            self.p.goal_frame,
        )
        return click.pose.position

    def _replace_goal(self, position: Point, click: PoseStamped) -> None:
        """Cancel the earlier goal, wait for its end, then send this one, unless a newer click arrives meanwhile.

        Reports name the place that was clicked, as the view shows it.
        """
        if not self._wait_for_server():
            return
        earlier = self.sent
        if earlier is not None and not earlier.done.is_set():
            earlier.cancel()
            ended = earlier.done.is_set
            if not wait_until(lambda: ended() or self.click is not None, self.p.cancel_timeout):
                rospy.logwarn(
                    "the earlier goal did not end within %g s of its cancel; sending the new goal preempts it",
                    self.p.cancel_timeout,
                )
        if self.click is not None:
            return
        clicked = click.pose.position
        where = place(clicked.x, clicked.y, self.transformer.frame_of(click))
        self.sent = SentGoal(self.client, position, where, lambda ending: rospy.loginfo("goal ended, %s", ending))
        rospy.loginfo("goal sent: %s, for the server %s", where, place(position.x, position.y, self.p.goal_frame))
        self._report()

    def _wait_for_server(self) -> bool:
        """Wait for the server; False when a newer click or shutdown ends the wait."""
        if discovery.is_up(self.client):
            return True
        rospy.logwarn("%s; the goal is sent when the server is up", discovery.absence(ACTION))
        wait_until(lambda: discovery.is_up(self.client) or self.click is not None, float("inf"))
        return self.click is None and not rospy.is_shutdown()

    # -- status report --

    def _report(self) -> None:
        """Publish the state of the server, and of the last goal as this client knows it."""
        log = rospy.loginfo
        if not discovery.is_up(self.client):
            text = discovery.absence(ACTION)
            if time.monotonic() - self.last_seen > ADVICE_AFTER:
                text, log = f"{text}; {discovery.advice()}", rospy.logwarn
            return self._publish_status(text, log)
        self.last_seen = time.monotonic()
        sent = self.sent
        if sent is not None and not sent.done.is_set():
            return self._publish_status(str(sent), log)
        last = "no goal yet" if sent is None else f"last goal {sent.ending}"
        self._publish_status(f"{ACTION} is ready, {last}", log)

    def _publish_status(self, text: str, log: Callable[..., None]) -> None:
        """Publish a status, and log it if it has changed."""
        if text != self.last_status:
            log("%s", text)
        self.last_status = text
        self.status.publish(String(text))


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it can't start, with the reason logged."""
    with node(BRIDGE):
        Bridge(load_params(BridgeParams)).run()
