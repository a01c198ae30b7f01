"""Advances time tick by tick, each time until the submission has answered, and records what it does."""

import time
from typing import Any, Callable, Dict, List, Optional, Sequence, Set, Tuple

import rosbag
import rosgraph
import rospy
from actionlib_msgs.msg import GoalID, GoalStatusArray
from geometry_msgs.msg import Twist
from rosgraph_msgs.msg import Log

from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionResult

from ...errors import GraderLostError
from ...geometry import STANDSTILL, Twist2D
from ...ros import convert
from ...ros.private_api import shutdown_has_begun
from ...simulation.lockstep import SURE, Lockstep
from .. import record as rec
from ..handout import ACTION
from ..record import Record
from . import thread_activity
from .nodes import Node
from .one_shot_subscriptions import OneShotSubscriptions
from .stage import Stage

# [s, wall] how long a tick waits for an answer:
FIRST_TIMEOUT = 2.0  # until the node has been silent once for a goal
LATER_TIMEOUT = 0.2  # afterwards, for an answer that is due
UNSURE_TIMEOUT = 0.06  # afterwards, for one that may not be due: a slow loop whose period is not yet known
MUTE_TIMEOUT = 0.5  # instead of the first, for a node that was silent in a whole scenario; later ticks don't wait
OTHER_STREAM_TIMEOUT = 0.15  # for the other stream's answer once one has come
SAME_ITERATION = 0.004  # [s, wall] for a command that often comes with a feedback message, but need not
# [s, wall] how long time is held at most while the node's threads are busy; a loaded machine needs some of it:
REST_TIMEOUT = 2.0
RESTLESS_TIMEOUT = 0.02  # of a node that was busy throughout RESTLESS such waits: it polls in a busy loop
RESTLESS = 3
REST_POLL = 0.001
POLLING_AFTER = 0.1  # a node that has not come to rest by then may poll, with a short sleep in between
START_REST = 0.5  # while the node starts
MOST_BUSY = 20.0  # in total while it starts, besides the time-out for that
ONE_SHOT_TIMEOUT = 2.0  # for a node to unsubscribe after a message, if it is to be the subscription's only one
LASTING_TIMEOUT = 0.3  # likewise, once one of the node's subscriptions has lasted
TREE_PERIOD = 0.5  # between two looks for the node's child processes
SETTLE = 0.15  # [s, wall] for what a node does at once, while time is held
PACE = 0.008  # [s, wall] minimum duration of a tick that needs no answer
STREAMS = ("command", "feedback")
MAX_ENTRIES = 20_000  # of each kind in one record


NODE_LOST = "the grader's ROS node was shut down while the submission ran"


class Run:
    """The recording of the current scenario, and the ticks that both parts share."""

    def __init__(self, stage: Stage, part: str, grader_pids: Sequence[int] = ()) -> None:
        """`grader_pids` are the processes, besides the node's, that have to rest before time may pass."""
        self.stage = stage
        self._grader_pids = list(grader_pids)
        self._tree: Tuple[float, List[int]] = (0.0, [])  # when it was read, the node's processes
        self._threads = thread_activity.Threads()
        self._restless = 0  # waits in a row at whose end the node was still busy
        self.one_shot = OneShotSubscriptions(stage.sensor_topics)
        stage.after_publishing = self._serve_one_shot
        self.part = part
        self.node: Optional[Node] = None
        self.lockstep = Lockstep()
        self.awaiting = ""  # id of the active goal
        self.ended: Set[str] = set()
        self.known: Dict[str, int] = {}  # goal -> status
        self.heard: Set[str] = set()  # streams, since the last tick
        self.death_recorded = False
        self.accepts_late = False  # this node accepts a goal when time advances, as one driven by a timer does
        self.fell_silent = False  # since the goal was sent; or it is known to answer less often than every tick
        self.mute = False  # it got goals in an earlier scenario, and nothing has come from it since
        self.parts: Dict[str, List[Any]] = {}
        self.marks: Dict[str, float] = {}
        self.subscribers: Dict[str, rospy.Subscriber] = {}
        for topic, kind, name in (
            ("/cmd_vel", Twist, "command"),
            (f"{ACTION}/feedback", GoToPositionActionFeedback, "feedback"),
            (f"{ACTION}/result", GoToPositionActionResult, "result"),
            (f"{ACTION}/status", GoalStatusArray, "status"),
            (f"{ACTION}/cancel", GoalID, "cancel"),
            ("/rosout", Log, "log"),
        ):
            if part == "server" and name == "cancel" or part == "bridge" and name in ("feedback", "result", "status"):
                continue  # this process publishes it
            self.subscribers[name] = stage.listen(topic, kind, name)
        self.handlers: Dict[str, Callable[[Any], object]] = stage.handlers
        self.handlers.update(
            {
                "command": self._on_command,
                "feedback": self._on_feedback,
                "result": self._on_result,
                "status": self._on_status,
                "cancel": self._on_cancel,
                "log": self._on_log,
                "line": self._on_line,
            }
        )

    # -- a scenario's recording --

    def begin(self, index: int, odd_scan: bool = False, bag: str = "") -> None:
        """Start a new record, with the robot at the scenario's start."""
        self.parts = {
            name: []
            for name in (
                "samples",
                "goals",
                "cancels",
                "statuses",
                "results",
                "feedback",
                "commands",
                "clicks",
                "lines",
                "deaths",
            )
        }
        self.marks = {}
        self.close_bag()
        self.stage.bag = rosbag.Bag(bag, "w") if bag else None
        self.stage.command(STANDSTILL)
        self.stage.begin(index, odd_scan)

    def close_bag(self) -> None:
        """Close the scenario's bag, if there is one."""
        if self.stage.bag is not None:
            self.stage.bag.close()
            self.stage.bag = None

    def finish(self, name: str, **more: Any) -> Record:
        """The record of the scenario."""
        self.close_bag()
        if not rosgraph.is_master_online():
            raise GraderLostError("the ROS master was ended while the submission ran")
        parts: Dict[str, Any] = {name: tuple(entries) for name, entries in self.parts.items()}
        return Record(name, self.part, marks=self.marks, **parts, **more)

    def add(self, part: str, entry: Any) -> None:
        """Record an entry; of a flood of them only the first ones."""
        if len(self.parts[part]) < MAX_ENTRIES:
            self.parts[part].append(entry)

    # -- what comes in, in the main thread --

    def drain(self, until: Callable[[], bool], timeout: float) -> bool:
        """Process messages until a condition holds, for at most `timeout` [s, wall]; whether it holds."""
        return self.stage.loop.run_jobs_until(until, timeout)

    def _hear(self, stream: str) -> None:
        self.mute = False
        self.heard.add(stream)
        if self.awaiting:
            self.lockstep.commanded(stream)

    def _on_command(self, message: Twist) -> None:
        twist = convert.from_twist_msg(message)
        self.stage.keep("/cmd_vel", message)
        self.add("commands", rec.Command(self.stage.now, twist.v, twist.w))
        self.stage.command(Twist2D(twist.v, twist.w))
        self._hear("command")

    def _on_feedback(self, message: GoToPositionActionFeedback) -> None:
        self.stage.keep(f"{ACTION}/feedback", message)
        feedback = message.feedback
        self.add(
            "feedback",
            rec.Feedback(self.stage.now, message.status.goal_id.id, feedback.position_error, feedback.angle_error),
        )
        self._hear("feedback")

    def _on_result(self, message: GoToPositionActionResult) -> None:
        self.stage.keep(f"{ACTION}/result", message)
        status, result = message.status, message.result
        self.add(
            "results", rec.Result(self.stage.now, status.goal_id.id, status.status, result.success, result.message)
        )
        self.ended.add(status.goal_id.id)

    def _on_status(self, message: GoalStatusArray) -> None:
        for entry in message.status_list:
            if self.known.get(entry.goal_id.id) != entry.status:
                self.known[entry.goal_id.id] = entry.status
                self.add("statuses", rec.Status(self.stage.now, entry.goal_id.id, entry.status))

    def _on_cancel(self, message: GoalID) -> None:
        self.add("cancels", rec.Cancel(self.stage.now, message.id))

    def _on_log(self, message: Log) -> None:
        if message.name == rospy.get_name():
            return
        level = "ERROR" if message.level >= Log.ERROR else "INFO"
        self.add("lines", rec.Line(self.stage.now, f"[{level}] {message.msg}"))

    def _on_line(self, text: str) -> None:
        self.add("lines", rec.Line(self.stage.now, text))

    # -- time --

    def tick(self, pace: float = PACE, real_time: bool = True, patience: float = REST_TIMEOUT) -> None:
        """One control tick. While a goal is active it lasts until the node answers, otherwise `pace` [s, wall] or more.

        In both cases until it is at rest, for at most `patience` [s, wall]. `real_time`: a watched run is shown at
        real time.
        """
        if shutdown_has_begun():
            raise GraderLostError(NODE_LOST)
        self.heard.clear()
        started = self.stage.wall()
        sample = self.stage.tick(real_time)
        self.lockstep.tick = self.stage.tick_number
        self.add("samples", sample)
        if self.stage.watch is not None:
            self.stage.watch.show(sample, self.parts["goals"], self.parts["clicks"])
        if self.awaiting and not (self.mute and self.fell_silent):
            self._await_answers()
        else:
            self.drain(lambda: False, max(1e-3, pace - (self.stage.wall() - started)))
            self.rest(patience)
        self._record_death()

    def _await_answers(self) -> None:
        """Wait until every awaited stream was heard, or the goal has ended.

        The wait is short for a node that may not be due at this tick, as it is slower than the ticks.
        """

        def done() -> bool:
            answered = self.awaiting in self.ended or not self.lockstep.missing()
            return answered or self._dead() or self.one_shot.waiting()

        timeout = MUTE_TIMEOUT if self.mute else FIRST_TIMEOUT
        if self.fell_silent:
            timeout = LATER_TIMEOUT if self.lockstep.patience() >= SURE else UNSURE_TIMEOUT
        deadline = time.monotonic() + timeout
        while not self.drain(done, OTHER_STREAM_TIMEOUT if self.heard else 0.05):
            if self.heard or time.monotonic() >= deadline:
                self.fell_silent = self.fell_silent or not self.heard
                self.lockstep.give_up()
                break
        if self.awaiting not in self.ended and len(self.heard) < len(STREAMS):
            self.drain(lambda: len(self.heard) == len(STREAMS), SAME_ITERATION)
        self.rest()

    def rest(self, timeout: float = REST_TIMEOUT) -> bool:
        """Hold simulated time until the node is idle; False if it is busy for too long."""
        if self._restless >= RESTLESS:
            timeout = min(timeout, RESTLESS_TIMEOUT)
        started = time.monotonic()
        while not self._at_rest(time.monotonic() - started > POLLING_AFTER or self.one_shot.waiting()):
            if time.monotonic() - started >= timeout:
                self._restless += 1
                return False
            self.drain(lambda: False, REST_POLL)
        self._restless = 0
        self.stage.exclude_from_deadlines(time.monotonic() - started)
        return True

    def _at_rest(self, polling: bool) -> bool:
        if self.stage.loop.jobs_waiting or self.node is None:
            return not self.stage.loop.jobs_waiting
        read, pids = self._tree
        if time.monotonic() - read > TREE_PERIOD:
            pids = thread_activity.tree([self.node.pid])
            self._tree = time.monotonic(), pids
        return self._threads.at_rest([*self._grader_pids, *pids], polling) and not self.stage.loop.jobs_waiting

    def _serve_one_shot(self) -> None:
        """After messages were sent: hold time until a node that needed one of them has made use of it."""
        if not self.awaiting or self.awaiting in self.ended:
            return
        if self.one_shot.served():
            timeout = LASTING_TIMEOUT if self.one_shot.lasting_seen else ONE_SHOT_TIMEOUT
            started = time.monotonic()
            if self.drain(lambda: self._dead() or not self.one_shot.served(), timeout):
                self.stage.exclude_from_deadlines(time.monotonic() - started)
            else:
                self.one_shot.keep_served()
        if self.one_shot.seen:
            self.rest()

    def follow_goal(self, goal: str) -> None:
        """From now on ticks wait for answers to this goal, which has just been sent."""
        busy = self.awaiting and self.awaiting not in self.ended  # its loop wakes up with the next tick only
        self.awaiting = goal
        self.fell_silent = self.lockstep.slower_than_ticks()
        self.heard.clear()
        self.lockstep = Lockstep(self.stage.tick_number)
        soon = self.drain(
            lambda: goal in self.known or goal in self.ended, SETTLE if busy or self.accepts_late else FIRST_TIMEOUT
        )
        self.accepts_late = not (soon or busy)
        self.drain(lambda: self.heard.issuperset(STREAMS) or goal in self.ended, SETTLE)
        self.rest()
        for stream in STREAMS:
            self.lockstep.commanded(stream)

    def settle(self, seconds: float) -> None:
        """Let time pass without waiting for answers, as the goal has ended."""
        self.awaiting = ""
        self.drain(lambda: False, SETTLE)
        for _ in range(int(round(seconds * 10))):
            self.tick()
        self.one_shot.forget()

    # -- the node --

    def _dead(self) -> bool:
        return self.node is None or self.node.status() is not None

    def _record_death(self) -> None:
        if self.node is None or self.death_recorded:
            return
        status = self.node.status()
        if status is not None:
            self.death_recorded = True
            reason = self.node.guard.reason
            if not reason and status in rec.OUT_OF_TIME:
                reason = "it used more processor time than a node may"
            self.add("deaths", rec.Death(self.stage.now, status, reason))

    def wait_for(self, condition: Callable[[], bool], timeout: float, pace: float = PACE) -> bool:
        """Let time pass until a condition holds, the node is dead or `timeout` [s, wall] is over; whether it holds.

        Not at real time even if watched: a node that takes simulated seconds to start has the same timeout.
        """
        deadline, excludable = time.monotonic() + timeout, MOST_BUSY
        while not condition():
            if self._dead() or time.monotonic() >= deadline:
                self._record_death()
                return condition()
            started = time.monotonic()
            if not self.rest(START_REST):  # it loads its modules, for long on a busy machine
                spent = min(excludable, time.monotonic() - started)
                excludable, deadline = excludable - spent, deadline + spent
                self.stage.exclude_from_deadlines(spent)
            self.tick(pace, real_time=False, patience=START_REST)
            self._restless = 0
        return True
