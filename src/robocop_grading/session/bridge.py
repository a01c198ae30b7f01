"""The bridge's scenarios: clicks as RViz publishes them, and an action server controlled by the grader."""

from functools import partial
from typing import Any, Callable, Dict

import actionlib
import roslib.message
import rospy
from actionlib_msgs.msg import GoalID
from aro_robocop_goto_as.msg import (
    GoToPositionAction,
    GoToPositionActionGoal,
    GoToPositionFeedback,
    GoToPositionResult,
)
from geometry_msgs.msg import PoseStamped

from aro_robocop_goto_as.geometry import Pose2D, Twist2D, compose, inverse
from aro_robocop_goto_as.ros import graph

from .. import record as rec
from ..handout import ACTION, CLICKS
from ..runner import Job
from .ros_internals import goal_senders, has_client
from .run import TICK, Run
from .stage import Stage

START_TIMEOUT = 20.0  # [s] for the node's first connection
CONNECT_TIMEOUT = 10.0  # [s] for its client to find the server
REACTION_TIME = 3.0  # [s] for a click to become a goal
STATUS_TICKS = 2  # from one status message to the next, which is actionlib's 5 Hz
BEFORE, SECOND = (1.2, -0.4), (-0.6, 0.9)  # [m] clicks in odom
ACCEPTED = (
    "This goal has been accepted by the simple action server"  # the status text of actionlib's SimpleActionServer
)
# Types in which a bridge may report the goal's state: text, actionlib's states and their numbers. Not GoalStatusArray,
# which any action server sends by itself, and not floats, which may be anything.
STATUS_TYPES = {
    "actionlib_msgs/GoalStatus",
    "diagnostic_msgs/DiagnosticArray",
    "diagnostic_msgs/DiagnosticStatus",
    *(f"std_msgs/{name}" for name in ("String", "Int8", "Int16", "Int32", "UInt8", "UInt16", "UInt32")),
}
FRAMES = ("base_footprint", "map")


class _Server(actionlib.ActionServer):
    """actionlib's, which the main thread tells what has arrived."""

    def __init__(self, on_goal: Callable[[Any], None]) -> None:
        super().__init__(ACTION, GoToPositionAction, on_goal, lambda _handle: None, auto_start=False)

    def internal_goal_callback(self, goal: GoToPositionActionGoal) -> None:
        """Not in the thread that receives it."""

    def internal_cancel_callback(self, goal_id: GoalID) -> None:
        """Likewise."""

    def receive_goal(self, goal: GoToPositionActionGoal) -> None:
        super().internal_goal_callback(goal)

    def receive_cancel(self, goal_id: GoalID) -> None:
        super().internal_cancel_callback(goal_id)


class BridgeRun(Run):
    """One submission's bridge.

    Its goals are accepted at once, as by the handout's server. In the last scenario, which gives no points, they stay
    PENDING: how long they do with a real server depends on that server.
    """

    def __init__(self, job: Job, stage: Stage) -> None:
        super().__init__(job, stage)
        self.accepts = True
        self.cancels = stage.listen(f"{ACTION}/cancel", GoalID, self._on_cancel)
        self.clicks = rospy.Publisher(CLICKS, PoseStamped, queue_size=10)
        self.handles: Dict[str, Any] = {}  # of goals that have not ended, by id
        self.server: Any = None
        self.reports: Dict[str, rospy.Subscriber] = {}  # by topic
        self._ticks = 0

    def scenarios(self) -> None:
        """Run the scenarios up to the last one that is examined: each begins where another one has ended."""
        for name in self.plan.scenarios_of(self.job.part):
            scenario = getattr(self, f"_{name}")
            self.announce(name, scenario.__doc__)
            scenario()

    # -- the server that it talks to --

    def _serve(self) -> None:
        # actionlib's server does not report a goal whose cancel is handled first, so goals are counted on the topic.
        self.stage.listen(f"{ACTION}/goal", GoToPositionActionGoal, self._on_sent)
        self.server = _Server(self._on_goal)
        self.server.start()
        self.server.status_timer.shutdown()  # by the wall clock; see tick()
        self.stage.join()

    def _on_sent(self, message: GoToPositionActionGoal) -> None:
        position, name = message.goal.position, message.goal_id.id
        self.add("goals", rec.Goal(name, position.x, position.y, self.stage.now, ""))
        self._note_if_cancelled(message.goal_id)
        self.server.receive_goal(message)

    def _note_if_cancelled(self, goal_id: GoalID) -> None:
        """Cancel requests are handled first of what has arrived."""
        stamp = goal_id.stamp.to_sec()
        if any(cancel.id == goal_id.id or 0.0 < stamp <= cancel.stamp for cancel in self.parts["cancels"]):
            self.add("statuses", rec.Status(self.stage.now, goal_id.id, rec.PREEMPTED))

    def _on_goal(self, handle: Any) -> None:
        name = handle.get_goal_id().id
        self.handles[name] = handle
        self.add("statuses", rec.Status(self.stage.now, name, rec.PENDING))
        self._note_if_cancelled(handle.get_goal_id())
        if self.accepts:
            self._accept(name)

    def _accept(self, name: str) -> None:
        self.handles[name].set_accepted(ACCEPTED)
        self.add("statuses", rec.Status(self.stage.now, name, rec.ACTIVE))
        self.handles[name].publish_feedback(GoToPositionFeedback(1.0, 0.0, "on the way"))

    def _on_cancel(self, message: GoalID) -> None:
        """Preempt the goals that a cancel request is for.

        A request for all goals spares those of the same tick: a client that cancels all and then sends a goal uses two
        connections, and cannot know which message arrives first.
        """
        self.add("cancels", rec.Cancel(self.stage.now, message.id, message.stamp.to_sec()))
        if self.server is not None:
            self.server.receive_cancel(message)
        for goal in self.parts["goals"]:
            handle = self.handles.get(goal.id)
            everything = not message.id and not message.stamp and goal.time < self.stage.now - 1e-6
            earlier = bool(message.stamp) and handle is not None and handle.get_goal_id().stamp <= message.stamp
            if handle is not None and (message.id == goal.id or everything or earlier):
                self.add("statuses", rec.Status(self.stage.now, goal.id, rec.PREEMPTED))
                handle.set_canceled(GoToPositionResult(False, "cancelled"))
                del self.handles[goal.id]

    def _finish_goals(self) -> None:
        """Let all goals succeed."""
        for name, handle in self.handles.items():
            handle.set_succeeded(GoToPositionResult(True, "there"))
            self.add("statuses", rec.Status(self.stage.now, name, rec.SUCCEEDED))
        self.handles.clear()

    # -- clicks --

    def _send_click(self, frame: str, x: float, y: float) -> None:
        """A 2D Nav Goal; then let time pass until a goal has come, for REACTION_TIME at most."""
        robot, to_map = self.stage.odom_from_footprint(), inverse(self.stage.sim.map_from_odom())
        odom = compose({"base_footprint": robot, "map": to_map, "odom": Pose2D()}[frame], Pose2D(x, y))
        self.add("clicks", rec.Click(self.stage.now, frame, x, y, odom.x, odom.y))
        message = PoseStamped()
        message.header.frame_id, message.header.stamp = frame, self.stage.stamp
        message.pose.position.x, message.pose.position.y, message.pose.orientation.w = x, y, 1.0
        count = len(self.parts["goals"])
        self.clicks.publish(message)
        self.stage.digest()  # what the bridge does at once takes no simulated time
        for _ in range(round(REACTION_TIME / TICK)):
            if len(self.parts["goals"]) > count:
                break
            self.tick()
        self.stage.digest()  # its client has learned the goal's state before time continues

    def _subscribe_to_reports(self) -> None:
        """Record published states like logged lines; their topics may appear at any time."""
        for topic in graph.published_topics():
            others = set(topic.publishers) - {rospy.get_name()}
            if others and topic.name not in self.reports and topic.type in STATUS_TYPES:
                text = f"published on {topic.name}"
                kind = roslib.message.get_message_class(topic.type)
                self.reports[topic.name] = self.stage.listen(topic.name, kind, self._on_line, partial(_text, text))
                self.stage.join()

    def tick(self, real_time: bool = True) -> None:
        """One control tick, after which the server tells of its goals if that is due."""
        super().tick(real_time)
        self._ticks += 1
        if self.server is not None and self._ticks % STATUS_TICKS == 0:
            self.server.publish_status()
        self.stage.digest()  # its client has learned the state before time continues

    # -- scenarios, in this order --

    def _no_server(self) -> None:
        """The bridge starts and gets a click while there is no server."""
        self.begin("no_server", 0)
        self.launch()
        self.wait_for(lambda: any(it.get_num_connections() for it in (self.clicks, self.cancels)), START_TIMEOUT)
        self.settle(1.0)
        if self.clicks.get_num_connections():
            self._send_click("odom", 0.5, 0.1)
        self.settle(3.0)
        self.finish("no_server")

    def _click(self) -> None:
        """The server is there; a click, then time passes while the goal is active, and when it has succeeded."""
        self.begin("click", 0)
        self._serve()
        self.wait_for(lambda: self.clicks.get_num_connections() > 0 and has_client(self.server), CONNECT_TIMEOUT)
        self.settle(2.0)  # a click that the bridge has kept may come now
        self._finish_goals()
        self.settle(0.5)
        self.marks["clicked"] = self.stage.now
        self.marks["listeners"] = float(self.clicks.get_num_connections())
        self.marks["clients"] = float(goal_senders(self.server))
        self._send_click("odom", *BEFORE)
        self._watch_reports()
        self._finish_goals()
        self._watch_reports()
        self._stop_watching()
        self.finish("click", **self.names(graph.action_clients()))

    def _watch_reports(self) -> None:
        """Let time pass, and record what is published on topics that appear meanwhile."""
        self.marks.setdefault("watching", self.stage.now)
        for tick in range(round(self.plan.limits.status_span / TICK)):
            if tick % 10 == 0:
                self._subscribe_to_reports()
            self.tick()
        self.marks.setdefault("watched", self.stage.now)

    def _stop_watching(self) -> None:
        for subscriber in self.reports.values():
            subscriber.unregister()
        self.reports.clear()

    def _replace(self) -> None:
        """A click, and a second one while the first one's goal is active."""
        self.begin("replace", 0)
        self._send_click("odom", *BEFORE)
        self.settle(2.0)
        self._send_click("odom", *SECOND)
        self.settle(2.0)
        self.finish("replace")

    def _frame(self) -> None:
        """Clicks in other frames, after the robot has moved, where map differs from odom."""
        self._finish_goals()
        self.begin("frame", 1)
        self.settle(0.5)
        for twist, seconds in ((Twist2D(0.2, 0.0), 3.0), (Twist2D(0.0, 0.5), 2.0), (Twist2D(), 1.0)):
            self.stage.command(twist)
            self.settle(seconds)
        for frame in FRAMES:
            self._send_click(frame, 1.0, 0.2)
            self.settle(0.5)
            self._finish_goals()
            self.settle(0.5)
        self.finish("frame")

    def _pending(self) -> None:
        """A click and a second one, whose goals are not accepted yet; for advice, without points."""
        self._finish_goals()
        self.accepts = False
        self.begin("pending", 0)
        self.settle(1.0)
        self._send_click("odom", *BEFORE)
        self._watch_reports()
        self._stop_watching()
        self._send_click("odom", *SECOND)
        self.settle(2.0)
        self.finish("pending")


def _text(text: str, message: Any) -> str:
    """A line about a published report: a state's number, or the words that the message has."""
    content = getattr(message, "status", getattr(message, "data", message))
    return f"{text}: {content}"[: rec.MOST_TEXT]
