"""One node's run through the scenarios of its part: the ticks, and a record of everything that the node sends."""

import time
from collections import defaultdict
from typing import Any, Callable, DefaultDict, Dict, List, Sequence, Set

from actionlib_msgs.msg import GoalStatusArray
from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionResult
from geometry_msgs.msg import Twist
from rosgraph_msgs.msg import Log

from aro_robocop_goto_as.geometry import STANDSTILL, Pose2D
from aro_robocop_goto_as.ros import convert

from .. import record as rec
from ..errors import UngradableError
from ..handout import ACTION
from ..plan import TICK
from ..record import Record
from ..scenarios import Block
from ..sites import ORIGIN
from .job import Job
from .node import Node
from .services import Services
from .stage import Stage
from .topics import NodeTopic

MAX_PER_TICK = 50  # of each kind at one tick
MAX_PRINTED = 2_000_000  # characters of lines in one record; as many at one tick, as a traceback comes at once
SHORT = 100  # characters; a shorter line counts as one of this length


class Run:
    """A job in progress: its records, the current one so far, the known goals, and the goals that have ended."""

    def __init__(self, job: Job, stage: Stage) -> None:
        self.job, self.plan, self.stage, self.topics = job, job.plan, stage, stage.topics
        self.services = Services(stage.sim)
        self.records: Dict[str, Record] = {}  # of the scenarios that are over
        self.scenario = ""  # the present one
        self._until = time.monotonic() + job.budget
        self.ended: Set[str] = set()
        self.known: Dict[str, int] = {}  # goal -> status
        self.entries: DefaultDict[str, List[Any]] = defaultdict(list)  # by field of the record
        self._before: DefaultDict[str, int] = defaultdict(int)  # how many of them there were before this tick
        self.marks: Dict[str, float] = {}
        self.end_recorded = False
        self._printed = 0  # characters of this record's lines
        self._used = 0.0  # processor time [s] of the nodes that have ended
        self._started = Pose2D()  # odom_from_footprint when the node was started
        self.topics.subscribe("/cmd_vel", Twist, self._on_command)
        self.topics.subscribe("/rosout", Log, self._on_log)

    def scenarios(self) -> None:
        """Run the scenarios that the plan's checks examine."""
        raise NotImplementedError

    def announce(self, name: str) -> None:
        """Say which scenario is the next one."""
        self.scenario = name
        self.job.on_scenario(name)

    def begin(self, name: str, site: Pose2D = ORIGIN, blocks: Sequence[Block] = (), odd_scan: bool = False) -> None:
        """Start a scenario's record and bag, with the robot at rest at its site."""
        self.entries = defaultdict(list)
        self._before.clear()
        self.marks, self._printed = {}, 0
        self.stage.bag.open(self.job.out / f"{self.job.part}-{name}.bag")
        self.stage.command(STANDSTILL)
        self.stage.begin(site, blocks, odd_scan)

    def finish(self, name: str, **more: Any) -> Record:
        """Keep the scenario's record, and return it."""
        self.stage.bag.close()
        fields: Dict[str, Any] = {field: tuple(entries) for field, entries in self.entries.items()}
        others = self.topics.other_types() if self.stage.node is not None else ()
        record = self.records[name] = Record(
            name,
            self.job.part,
            started=self._started,
            marks=self.marks,
            other_types=others,
            programs=tuple(sorted(self.topics.programs)),
            delays=tuple(sorted(self.topics.delays.items())),
            **fields,
            **more,
        )
        return record

    def add(self, field: str, entry: Any) -> None:
        """Record an entry; if there are very many at one tick, only the first MAX_PER_TICK are recorded."""
        if len(self.entries[field]) - self._before[field] < MAX_PER_TICK:
            self.entries[field].append(entry)

    def action_fields(self, suffix: str) -> Dict[str, Any]:
        """Fields of a record: the node's action servers or clients, and topics that the node waits for in vain.

        `suffix`: the end of the name of a topic that these servers or clients publish, such as /result.
        """
        kind = f"Action{suffix[1:].capitalize()}"
        found: Dict[str, NodeTopic] = {
            name: topic
            for name, topic in sorted(self.topics.published.items())
            if name.endswith(suffix) and topic.type.endswith(kind)
        }
        return {
            "servers": tuple(self.topics.node_name(name)[: -len(suffix)] for name in found),
            # GoToPositionActionResult -> GoToPositionAction
            "types": tuple(topic.type[: -len(suffix[1:])] for topic in found.values()),
            "unpublished": tuple(self.topics.unpublished()),
        }

    # -- the node --

    def launch(self) -> None:
        """Start the node that is graded."""
        self.end_recorded = False
        stage = self.stage
        self._started = stage.odom_from_footprint()
        now_ns, clock_ns = stage.sim.stamp_ns, stage.clock_ns
        stage.node = Node(
            self.job, self.topics, self.services, self._on_line, self._expect_time, now_ns, clock_ns, self._used
        )

    def _expect_time(self) -> None:
        if time.monotonic() > self._until:
            raise UngradableError(f"{self.job.part}: not done within {self.job.budget:g} s, stopped at {self.scenario}")

    def node_has_ended(self) -> bool:
        """Return whether there is no node, or it has ended."""
        return self.stage.node is None or self.stage.node.has_ended()

    def end_node(self) -> None:
        """End the node, if there is one."""
        if self.stage.node is not None:
            self.stage.node.end()
            self._used, self.stage.node = self.stage.node.used, None

    def close(self) -> None:
        """End the node and the simulation."""
        self.end_node()
        self.stage.sim.close()

    def _record_end(self) -> None:
        node = self.stage.node
        if node is not None and node.has_ended() and not self.end_recorded:
            self.end_recorded = True
            self.add("node_ends", node.how_ended(self.stage.now))

    # -- time --

    def tick(self) -> None:
        """One control tick."""
        for field, entries in self.entries.items():
            self._before[field] = len(entries)
        self.add("samples", self.stage.tick())
        self._record_end()

    def settle(self, seconds: float) -> None:
        """Let time pass."""
        for _ in range(round(seconds / TICK)):
            self.tick()

    def wait_for(self, condition: Callable[[], bool], timeout: float) -> bool:
        """Let time pass until a condition holds, the node has ended or `timeout` [s] is over; return if it holds."""
        for _ in range(round(timeout / TICK)):
            if condition() or self.node_has_ended():
                break
            self.tick()
        return condition()

    # -- what arrives, in the main thread --

    def listen_to_server(self) -> None:
        """Record what an action server sends."""
        for name, kind, handler in (
            ("feedback", GoToPositionActionFeedback, self._on_feedback),
            ("result", GoToPositionActionResult, self._on_result),
            ("status", GoalStatusArray, self._on_status),
        ):
            self.topics.subscribe(f"{ACTION}/{name}", kind, handler)

    def _on_command(self, message: Twist) -> None:
        twist = convert.from_twist_msg(message)
        self.stage.bag.write("/cmd_vel", message)
        self.add("commands", rec.Command(self.stage.now, twist.v, twist.w))
        self.stage.command(twist)

    def _on_feedback(self, message: GoToPositionActionFeedback) -> None:
        self.stage.bag.write(f"{ACTION}/feedback", message)
        name, errors = message.status.goal_id.id, message.feedback
        self.add("feedback", rec.Feedback(self.stage.now, name, errors.position_error, errors.angle_error))

    def _on_result(self, message: GoToPositionActionResult) -> None:
        self.stage.bag.write(f"{ACTION}/result", message)
        name, result = message.status.goal_id.id, message.result
        self.add("results", rec.Result(self.stage.now, name, message.status.status, result.success, result.message))
        self.ended.add(name)

    def _on_status(self, message: GoalStatusArray) -> None:
        for entry in message.status_list:
            if self.known.get(entry.goal_id.id) != entry.status:
                self.known[entry.goal_id.id] = entry.status
                self.add("statuses", rec.Status(self.stage.now, entry.goal_id.id, entry.status))

    def _on_log(self, message: Log) -> None:
        level = "ERROR" if message.level >= Log.ERROR else "WARN" if message.level >= Log.WARN else "INFO"
        self._on_line(f"[{level}] {message.msg}")

    def _on_line(self, text: str) -> None:
        self._printed += max(SHORT, len(text))
        if self._printed <= MAX_PRINTED:
            self.entries["lines"].append(rec.Line(self.stage.now, text))
