"""What a submission does during a scenario: everything that arrives from it, as a record."""

from typing import Any, Callable, Dict, List, Set

import rosgraph
import rospy
from actionlib_msgs.msg import GoalID, GoalStatusArray
from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionResult
from geometry_msgs.msg import Twist
from rosgraph_msgs.msg import Log

from aro_robocop_goto_as.errors import GraderLostError
from aro_robocop_goto_as.geometry import STANDSTILL, Twist2D
from aro_robocop_goto_as.ros import convert

from .. import record as rec
from ..handout import ACTION
from ..record import Record
from .stage import Stage

PARTS = "samples goals cancels statuses results feedback commands clicks lines deaths".split()  # of a Record
MAX_ENTRIES = 20_000  # of each kind in one record


class Recording:
    """The record of the current scenario, and which goals are known and have ended."""

    def __init__(self, stage: Stage, part: str) -> None:
        self.stage = stage
        self.part = part
        self.ended: Set[str] = set()
        self.known: Dict[str, int] = {}  # goal -> status
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

    def begin(self, index: int, odd_scan: bool = False, bag: str = "") -> None:
        """Start a new record, with the robot at the scenario's start."""
        self.parts = {name: [] for name in PARTS}
        self.marks = {}
        self.stage.bag.open(bag)
        self.stage.command(STANDSTILL)
        self.stage.begin(index, odd_scan)

    def finish(self, name: str, **more: Any) -> Record:
        """The record of the scenario."""
        self.stage.bag.close()
        if not rosgraph.is_master_online():
            raise GraderLostError("the ROS master was ended while the submission ran")
        parts: Dict[str, Any] = {name: tuple(entries) for name, entries in self.parts.items()}
        return Record(name, self.part, marks=self.marks, **parts, **more)

    def add(self, part: str, entry: Any) -> None:
        """Record an entry; of a flood of them only the first ones."""
        if len(self.parts[part]) < MAX_ENTRIES:
            self.parts[part].append(entry)

    # -- what arrives, in the main thread --

    def _on_command(self, message: Twist) -> None:
        twist = convert.from_twist_msg(message)
        self.stage.keep("/cmd_vel", message)
        self.add("commands", rec.Command(self.stage.now, twist.v, twist.w))
        self.stage.command(Twist2D(twist.v, twist.w))

    def _on_feedback(self, message: GoToPositionActionFeedback) -> None:
        self.stage.keep(f"{ACTION}/feedback", message)
        feedback = message.feedback
        self.add(
            "feedback",
            rec.Feedback(self.stage.now, message.status.goal_id.id, feedback.position_error, feedback.angle_error),
        )

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
        level = "ERROR" if message.level >= Log.ERROR else "WARN" if message.level >= Log.WARN else "INFO"
        self.add("lines", rec.Line(self.stage.now, f"[{level}] {message.msg}"))

    def _on_line(self, text: str) -> None:
        self.add("lines", rec.Line(self.stage.now, text))
