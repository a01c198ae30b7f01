"""The bridge's scenarios: clicks as RViz publishes them, and an action server controlled by the grader."""

from functools import partial
from typing import Any, Optional, Set

import roslib.message
from actionlib_msgs.msg import GoalID, GoalStatusArray
from aro_robocop_goto_as.msg import (
    GoToPositionActionFeedback,
    GoToPositionActionGoal,
    GoToPositionActionResult,
    GoToPositionResult,
)
from geometry_msgs.msg import PoseStamped

from aro_robocop_goto_as.geometry import STANDSTILL, Pose2D, Twist2D, compose, inverse

from .. import record as rec
from ..handout import ACTION, CLICK_TOPIC
from ..plan import TICK
from ..sites import SITE
from .goals import Goals
from .job import Job
from .run import Run
from .stage import Stage

START_TIMEOUT = 20.0  # [s] for the node's first connection
CONNECT_TIMEOUT = 10.0  # [s] for its client to find the server
REACTION_TIME = 3.0  # [s] for a click to become a goal
STATUS_TICKS = 2  # from one status message to the next, which is actionlib's 5 Hz
FIRST_CLICK, SECOND_CLICK = (1.24, -0.43), (-0.57, 0.86)  # [m] clicks in odom; a bridge that rounds them loses 0.04 m
# The goals after the first one: the click, for how long [s] its goal is active, how it ends, and how long [s] the next
# click takes to come. The last click comes while a server's status still begins with the goal before.
LATER_GOALS = (
    (SECOND_CLICK, 5.0, rec.ABORTED, 9.0),
    (SECOND_CLICK, 2.0, rec.PREEMPTED, 0.4),
    (FIRST_CLICK, 5.0, rec.PREEMPTED, 3.0),
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


class BridgeRun(Run):
    """One submission's bridge, whose goals are accepted at once, as the handout's server does."""

    def __init__(self, job: Job, stage: Stage) -> None:
        super().__init__(job, stage)
        self.topics.subscribe(f"{ACTION}/cancel", GoalID, self._on_cancel)
        self.topics.advertise(CLICK_TOPIC, PoseStamped)
        self.server: Optional[Goals] = None
        self.reports: Set[str] = set()  # topics
        self._ticks = 0

    def scenarios(self) -> None:
        """Run the scenarios up to the last one that a check examines: each begins where the previous one ended."""
        for name in self.plan.scenarios_of(self.job.part):
            scenario = getattr(self, f"_{name}")
            self.announce(name)
            scenario()

    # -- the server that it talks to --

    def _serve(self) -> None:
        for name, kind in (("result", GoToPositionActionResult), ("feedback", GoToPositionActionFeedback)):
            self.topics.advertise(f"{ACTION}/{name}", kind)
        self.topics.advertise(f"{ACTION}/status", GoalStatusArray, latch=True)
        self.topics.subscribe(f"{ACTION}/goal", GoToPositionActionGoal, self._on_goal)
        self.server = Goals(self.topics.publish, lambda: self.stage.stamp)
        self.stage.run_node()

    def _on_goal(self, message: GoToPositionActionGoal) -> None:
        assert self.server is not None
        message.goal_id = self.server.identified(message.goal_id)
        position, name = message.goal.position, message.goal_id.id
        self.add("goals", rec.SentGoal(name, position.x, position.y, self.stage.now, ""))
        state = self.server.add(message)
        if state is not None:
            self.add("statuses", rec.Status(self.stage.now, name, state))
        if state == rec.PENDING:
            self.server.accept(name)
            self.add("statuses", rec.Status(self.stage.now, name, rec.ACTIVE))

    def _on_cancel(self, message: GoalID) -> None:
        """Preempt the goals that a cancel request is for.

        A request for all goals spares the goals of the same tick: a client that cancels all goals and then sends a
        goal uses two connections, and cannot know which message arrives first.
        """
        self.add("cancels", rec.Cancel(self.stage.now, message.id, message.stamp.to_sec()))
        if self.server is None:
            return
        of_this_tick = {goal.id for goal in self.entries["goals"] if goal.time > self.stage.now - 1e-6}
        for name in self.server.request_cancel(message, of_this_tick):
            state = self.server.cancel(name, GoToPositionResult(False, "cancelled"))
            self.add("statuses", rec.Status(self.stage.now, name, state))

    def _finish_goals(self, status: int = rec.SUCCEEDED) -> None:
        """Let all goals end in a state."""
        assert self.server is not None
        for name in self.server.running():
            self.server.finish(name, status)
            self.add("statuses", rec.Status(self.stage.now, name, status))

    # -- clicks --

    def _send_click(self, frame: str, x: float, y: float) -> None:
        """Send a 2D Nav Goal; then let time pass until a goal has come, for REACTION_TIME at most."""
        robot, to_map = self.stage.odom_from_footprint(), inverse(self.stage.sim.map_from_odom())
        odom = compose({"base_footprint": robot, "map": to_map, "odom": Pose2D()}[frame], Pose2D(x, y))
        self.add("clicks", rec.Click(self.stage.now, frame, x, y, odom.x, odom.y))
        message = PoseStamped()
        message.header.frame_id, message.header.stamp = frame, self.stage.stamp
        message.pose.position.x, message.pose.position.y, message.pose.orientation.w = x, y, 1.0
        count = len(self.entries["goals"])
        self.topics.publish(CLICK_TOPIC, message)
        self.stage.run_node()  # what the bridge does at once takes no simulated time
        for _ in range(round(REACTION_TIME / TICK)):
            if len(self.entries["goals"]) > count:
                break
            self.tick()
        self.stage.run_node()  # its client has learned the goal's state before time continues

    def _subscribe_to_reports(self) -> None:
        """Record published states like logged lines; their topics may appear at any time."""
        reports = [name for name, topic in self.topics.published.items() if topic.type in STATUS_TYPES]
        for name in sorted(it for it in reports if not self.topics.listens_to(it)):
            kind = roslib.message.get_message_class(self.topics.published[name].type)
            self.topics.subscribe(name, kind, self._on_line, partial(_text, f"published on {name}"))
            self.reports.add(name)
            self.stage.run_node()

    def tick(self) -> None:
        """Run one control tick; then publish the server's goals if their status is due."""
        super().tick()
        self._ticks += 1
        if self.server is not None and self._ticks % STATUS_TICKS == 0:
            self.server.publish_status()
        self.stage.run_node()  # its client has learned the state before time continues

    # -- scenarios, in this order --

    def _begin(self, name: str) -> None:
        """Begin where map is not odom, and drive the robot away from odom's origin: a frame taken for another shows."""
        self.begin(name, SITE)
        for twist, seconds in ((Twist2D(0.2, 1.0), 1.5), (STANDSTILL, 0.5)):
            self.stage.command(twist)
            self.settle(seconds)

    def _no_server(self) -> None:
        """Start the bridge while there is no server."""
        self._begin("no_server")
        self.launch()
        self.wait_for(
            lambda: self.topics.node_subscribes_to(CLICK_TOPIC) or self.topics.node_publishes(f"{ACTION}/cancel"),
            START_TIMEOUT,
        )
        self.settle(4.0)
        self.marks["own_server"] = float(f"{ACTION}/result" in self.topics.published)
        self.finish("no_server")

    def _click(self) -> None:
        """Send clicks while there is a server; let time pass while each goal is active, and after its end.

        The first goal is active for longer than `status_span`, so that no report is lost by its phase.
        """
        self._begin("click")
        self._serve()
        self.wait_for(self._has_client, CONNECT_TIMEOUT)
        self.settle(2.0)  # a goal that no click has asked for may come now
        self._finish_goals()
        self.settle(0.5)
        self.marks["clicked"] = self.stage.now
        self.marks["listeners"] = float(self.topics.node_subscribes_to(CLICK_TOPIC))
        self.marks["clients"] = float(self.topics.node_publishes(f"{ACTION}/goal"))
        limits = self.plan.limits
        first = (FIRST_CLICK, limits.status_span + limits.status_period / 2.0, rec.SUCCEEDED, 6.0)
        for click, active, status, after in (first, *LATER_GOALS):
            self._send_click("odom", *click)
            self._watch_reports(active)
            self._finish_goals(status)
            self._watch_reports(after)
        self._stop_watching()
        self.finish("click", **self.action_fields("/goal"))

    def _has_client(self) -> bool:
        """Return whether the node hears of clicks, sends goals, and hears of their status and result."""
        topics = CLICK_TOPIC, f"{ACTION}/status", f"{ACTION}/result"
        heard = all(map(self.topics.node_subscribes_to, topics))
        return heard and self.topics.node_publishes(f"{ACTION}/goal")

    def _watch_reports(self, seconds: float) -> None:
        """Let time pass, and record what is published on topics that appear meanwhile."""
        self.marks.setdefault("watching", self.stage.now)
        for tick in range(round(seconds / TICK)):
            if tick % 10 == 0:
                self._subscribe_to_reports()
            self.tick()
        self.marks.setdefault("watched", self.stage.now)

    def _stop_watching(self) -> None:
        for name in self.reports:
            self.topics.ignore(name)
        self.reports.clear()

    def _replace(self) -> None:
        """Send a click, and a second click while the first goal is active."""
        self._begin("replace")
        self._send_click("odom", *FIRST_CLICK)
        self.settle(2.0)
        self._send_click("odom", *SECOND_CLICK)
        self.settle(2.0)
        self.finish("replace")

    def _frame(self) -> None:
        """Send clicks in other frames.

        The first click is newer than the newest transform to odom, as most clicks in RViz are; map -> odom is static.
        """
        self._finish_goals()
        self._begin("frame")
        self.stage.advance_between_transforms()
        for frame in FRAMES:
            self._send_click(frame, 1.0, 0.2)
            self.settle(0.5)
            self._finish_goals()
            self.settle(0.5)
        self.finish("frame")


def _text(text: str, message: Any) -> str:
    """A line about a published report: a state's number, or the words in the message."""
    content = getattr(message, "status", getattr(message, "data", message))
    return f"{text}: {content}"[: rec.MAX_TEXT]
