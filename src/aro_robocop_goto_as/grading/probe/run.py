"""Time moved on tick by tick, each time until the submission has answered; all that it does is recorded."""

import queue
import time
from typing import Any, Callable, Dict, List, Optional, Set

import rosbag
import rosgraph
import rospy
from actionlib_msgs.msg import GoalID, GoalStatusArray
from geometry_msgs.msg import Twist
from rosgraph_msgs.msg import Log

from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionResult

from ...geometry import STANDSTILL, Twist2D
from ...lockstep import SURE, Lockstep
from ...nodes import convert
from .. import record as rec
from ..record import Record
from .nodes import Node
from .stage import Event, Stage

ACTION = "/robocop_goto_as"  # the handout's
SILENCE = 2.0  # [s, wall] for an answer to a tick, once per goal
SILENCE_AGAIN = 0.2  # [s, wall] for one that is due, once that was in vain
SILENCE_LEARNING = 0.06  # [s, wall] likewise, for one that may not be due: a slow loop whose rhythm is not yet known
SILENCE_OF_THE_MUTE = 0.5  # [s, wall] as SILENCE, for who said nothing in all of a scenario; no tick waits after that
TRAILING = 0.15  # [s, wall] for the other stream's answer once one has come
SAME_ITERATION = 0.004  # [s, wall] for a command that often comes with a feedback, but need not
SETTLE = 0.15  # [s, wall] for what a node does at once, without time moving on
PACE = 0.008  # [s, wall] at least of a tick that nobody has to answer
STREAMS = ("command", "feedback")
MOST_ENTRIES = 20_000  # of a kind in one record


NODE_LOST = "the grader's ROS node was shut down while the submission ran"


class GraderLost(Exception):
    """The submission has ended the ROS master or the grader's own node: nothing that follows can be judged."""


class Run:
    """The recording of the current scenario, and the clockwork that both parts share."""

    def __init__(self, stage: Stage, part: str) -> None:
        self.stage = stage
        self.part = part
        self.node: Optional[Node] = None
        self.lockstep = Lockstep()
        self.awaiting = ""  # id of the goal that is being pursued
        self.ended: Set[str] = set()
        self.known: Dict[str, int] = {}  # goal -> status
        self.heard: Set[str] = set()  # streams, since the last tick
        self.said_death = False
        self.takes_up_late = False  # this node takes a goal up when time goes on, as one driven by a timer does
        self.fell_silent = False  # since the goal was sent, or known to answer more seldom than the ticks come
        self.mute = False  # goals were given in an earlier scenario, and no word has come since
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
                continue  # what this process sends itself
            self.subscribers[name] = stage.listen(topic, kind, name)
        self.handlers: Dict[str, Callable[[Any], None]] = {
            "command": self._on_command,
            "feedback": self._on_feedback,
            "result": self._on_result,
            "status": self._on_status,
            "cancel": self._on_cancel,
            "log": self._on_log,
            "line": self._on_line,
            "job": lambda job: job(),
        }

    # -- a scenario's recording --

    def begin(self, index: int, odd_scan: bool = False, bag: str = "") -> None:
        """A fresh record; the robot at the start."""
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
        """The scenario's bag is complete."""
        if self.stage.bag is not None:
            self.stage.bag.close()
            self.stage.bag = None

    def finish(self, name: str, **more: Any) -> Record:
        """The record of the scenario."""
        self.close_bag()
        if not rosgraph.is_master_online():
            raise GraderLost("the ROS master was ended while the submission ran")
        return Record(name, self.part, marks=self.marks, **{key: tuple(it) for key, it in self.parts.items()}, **more)

    def add(self, part: str, entry: Any) -> None:
        """Note something; of what floods us, the beginning."""
        if len(self.parts[part]) < MOST_ENTRIES:
            self.parts[part].append(entry)

    # -- what comes in, in the main thread --

    def drain(self, until: Callable[[], bool], patience: float) -> bool:
        """Take what comes in until a condition holds, for `patience` [s, wall] at the most; whether it holds."""
        deadline = time.monotonic() + patience
        while not until():
            try:
                self._take(self.stage.inbox.get(timeout=max(1e-6, deadline - time.monotonic())))
            except queue.Empty:
                return until()
            if time.monotonic() >= deadline:
                break
        for _ in range(self.stage.inbox.qsize()):  # what is there already, and no more: a node may flood us
            self._take(self.stage.inbox.get_nowait())
        return until()

    def _take(self, event: Event) -> None:
        name, payload = event
        if name in self.handlers:
            self.handlers[name](payload)

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

    def tick(self, pace: float = PACE, real_time: bool = True) -> None:
        """One control tick. While a goal is pursued it lasts until it is answered, otherwise `pace` [s, wall].

        Who watches sees it at real time, if it is to be.
        """
        if rospy.core.is_shutdown_requested():
            raise GraderLost(NODE_LOST)
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
        self._look_at_node()

    def _await_answers(self) -> None:
        """Until every stream that is awaited was heard, or the goal's end.

        Who is known to be slower than the ticks may not be due at this one, so the wait is short.
        """

        def done() -> bool:
            return self.awaiting in self.ended or not self.lockstep.missing() or self._dead()

        patience = SILENCE_OF_THE_MUTE if self.mute else SILENCE
        if self.fell_silent:
            patience = SILENCE_AGAIN if self.lockstep.patience() >= SURE else SILENCE_LEARNING
        deadline = time.monotonic() + patience
        while not self.drain(done, TRAILING if self.heard else 0.05):
            if self.heard or time.monotonic() >= deadline:
                self.fell_silent = self.fell_silent or not self.heard
                self.lockstep.give_up()
                break
        if self.awaiting not in self.ended and len(self.heard) < len(STREAMS):
            self.drain(lambda: len(self.heard) == len(STREAMS), SAME_ITERATION)

    def pursue(self, goal: str) -> None:
        """From now on ticks wait for what comes of this goal; it has just been sent, and time stands."""
        busy = self.awaiting and self.awaiting not in self.ended  # a loop that wakes up with the next tick only
        self.awaiting = goal
        self.fell_silent = self.lockstep.slower_than_ticks()
        self.heard.clear()
        self.lockstep = Lockstep(self.stage.tick_number)
        soon = self.drain(lambda: goal in self.known or goal in self.ended,
                          SETTLE if busy or self.takes_up_late else SILENCE)
        self.takes_up_late = not (soon or busy)
        self.drain(lambda: self.heard.issuperset(STREAMS) or goal in self.ended, SETTLE)
        for stream in STREAMS:
            self.lockstep.commanded(stream)

    def settle(self, seconds: float) -> None:
        """Nobody is waited for: the goal has ended."""
        self.awaiting = ""
        self.drain(lambda: False, SETTLE)
        for _ in range(int(round(seconds * 10))):
            self.tick()

    # -- the node --

    def _dead(self) -> bool:
        return self.node is None or self.node.death() is not None

    def _look_at_node(self) -> None:
        if self.node is not None and not self.said_death and self.node.death() is not None:
            self.said_death = True
            self.add("deaths", rec.Death(self.stage.now, self.node.process.returncode, self.node.guard.reason))

    def wait_for(self, condition: Callable[[], bool], patience: float, pace: float = PACE) -> bool:
        """Let time go on until a condition holds, the node is dead or `patience` [s, wall] is over.

        It goes on as fast as ever even when watched: a node that takes simulated seconds to come up has to be there
        within that patience all the same.
        """
        deadline = time.monotonic() + patience
        while not condition():
            if self._dead() or time.monotonic() >= deadline:
                self._look_at_node()
                return condition()
            self.tick(pace, real_time=False)
        return True
