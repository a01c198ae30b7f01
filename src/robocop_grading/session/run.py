"""Advances simulated time for one node, and records what it does."""

from typing import Callable, Optional

from aro_robocop_goto_as.errors import GraderLostError
from aro_robocop_goto_as.ros.rospy_internals import shutdown_has_begun

from .. import record as rec
from ..sandbox import memory_group
from ..sandbox.guard import exceeded_memory
from .node import Node
from .recording import Recording
from .stage import Stage

TICK = 0.1  # [s]
NODE_LOST = "the grader's ROS node was shut down while the submission ran"


class Run(Recording):
    """The recording of the current scenario, and the ticks that both parts share."""

    def __init__(self, stage: Stage, part: str) -> None:
        super().__init__(stage, part)
        self.death_recorded = False

    @property
    def node(self) -> Optional[Node]:
        """The node that is graded."""
        return self.stage.node

    @node.setter
    def node(self, node: Optional[Node]) -> None:
        self.stage.node = node

    def tick(self, real_time: bool = True) -> None:
        """One control tick; a watched run is shown at real time."""
        if shutdown_has_begun():
            raise GraderLostError(NODE_LOST)
        sample = self.stage.tick(real_time)
        self.add("samples", sample)
        if self.stage.watch is not None:
            self.stage.watch.show(sample, self.parts["goals"], self.parts["clicks"])
        self._record_death()

    def digest(self) -> None:
        """Let the node do what it does at once, in no simulated time."""
        self.stage.digest()

    def settle(self, seconds: float) -> None:
        """Let time pass."""
        for _ in range(int(round(seconds / TICK))):
            self.tick()

    def wait_for(self, condition: Callable[[], bool], timeout: float) -> bool:
        """Let time pass until a condition holds, the node is dead or `timeout` [s] is over; whether it holds."""
        for _ in range(int(round(timeout / TICK))):
            if condition() or self._dead():
                break
            self.tick(real_time=False)
        return condition()

    def _dead(self) -> bool:
        return self.node is None or self.node.status() is not None

    def _record_death(self) -> None:
        if self.node is None or self.death_recorded:
            return
        status = self.node.status()
        if status is not None:
            self.death_recorded = True
            reason = self.node.guard.reason or self.node.ended
            if not reason and status in rec.OUT_OF_TIME:
                reason = "it used more processor time than a node may"
            elif not reason and status in rec.KILLED and memory_group.has_killed():
                reason = exceeded_memory(memory_group.LIMIT)
            self.add("deaths", rec.Death(self.stage.now, status, reason))
