"""robocop_rviz_goto_ac: RViz's 2D Nav Goal -> tf2 -> GoToPosition goal, with a periodic report of the server."""

import threading
import traceback
from typing import Optional

import actionlib
import rospy
from geometry_msgs.msg import Point, PoseStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import String

from aro_robocop_goto_as.msg import GoToPositionAction

from ..errors import FrameError
from ..params import BridgeParams
from . import action_servers, params
from .goal_frame import GoalTransformer
from .goto_as import ACTION
from .lifetime import node
from .sent_goal import SentGoal
from .ticker import wait_until
from .timer import start_timer

IDLE_POLL = 0.1  # [s, wall] between two looks for shutdown while no click comes


class Bridge:
    """Clicks are kept, newest wins; one thread resolves and sends them; one timer reports."""

    def __init__(self, p: BridgeParams) -> None:
        self.p = p
        self.odom: Optional[Odometry] = None
        self.click: Optional[PoseStamped] = None
        self.clicked = threading.Condition()
        self.sent: Optional[SentGoal] = None
        self.last_result = ""
        self.said_naive = False
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
                position = self._resolve(click)
            except FrameError as error:
                rospy.logerr("goal refused, the robot goes on as before: %s", error)
                self._publish_status(f"goal refused: {error}")
                continue
            try:
                self._replace_goal(position)
            except Exception:  # this click's "main": the next one is served all the same
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
        if not self.said_naive:
            self.said_naive = True
            rospy.logwarn("ignore_goal_frame is set: numbers given in %r go to the server as if they were in %r",
                          click.header.frame_id, self.p.goal_frame)
        return click.pose.position

    def _replace_goal(self, position: Point) -> None:
        """Cancel the goal before and see it end, then send this one; a click that comes meanwhile takes its place."""
        if not self._wait_for_server():
            return
        older = self.sent
        if older is not None and not older.done.is_set():
            older.cancel()
            if not wait_until(lambda: older.done.is_set() or self.click is not None, self.p.cancel_timeout):
                rospy.logwarn("the older goal did not end within %g s of its cancel; the newer one is sent all the "
                              "same, which preempts it", self.p.cancel_timeout)
        if self.click is not None:
            return
        self.sent = SentGoal(self.client, position, self._on_end)
        rospy.loginfo("goal sent: x %.2f y %.2f in %s", position.x, position.y, self.p.goal_frame)
        self._report()

    def _wait_for_server(self) -> bool:
        """Whether the server is up; a goal is kept while it is not, until a newer click replaces it."""
        if action_servers.is_up(self.client):
            return True
        rospy.logwarn("%s; the goal is kept until it comes", action_servers.absence(ACTION))
        wait_until(lambda: action_servers.is_up(self.client) or self.click is not None, float("inf"))
        return self.click is None and not rospy.is_shutdown()

    def _on_end(self, ending: str) -> None:
        self.last_result = ending
        rospy.loginfo("goal ended, %s", ending)

    # -- the report --

    def _report(self) -> None:
        """One line on the log and on ~status, now."""
        self._publish_status(self._describe())

    def _publish_status(self, text: str) -> None:
        rospy.loginfo("%s", text)
        self.status.publish(String(text))

    def _describe(self) -> str:
        """The server's state as far as this client knows; a goal that is pending is not at its end."""
        if not action_servers.is_up(self.client):
            return action_servers.absence(ACTION)
        if self.sent is None:
            return f"{ACTION} is ready, no goal yet"
        if self.sent.done.is_set():
            return f"{ACTION} is ready, last goal {self.last_result}"
        return str(self.sent)


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it can't start, with the reason logged."""
    with node("robocop_rviz_goto_ac_node"):
        Bridge(params.load(BridgeParams)).run()
