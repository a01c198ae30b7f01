"""Holds simulated time while the submission's node works on what it has received."""

import time
from typing import Callable, List, Optional, Sequence, Tuple

from . import thread_activity
from .nodes import Node
from .stage import Stage

# [s, wall] how long time is held at most while the node's threads are busy; a loaded machine needs some of it:
REST_TIMEOUT = 2.0
RESTLESS_TIMEOUT = 0.02  # of a node that was busy throughout RESTLESS such waits: it polls in a busy loop
RESTLESS = 3
DIGEST = 0.003  # before a tick's clock, of a node that has nothing to do with a goal or never rests
POLL = 0.001  # [s, wall]
POLLING_AFTER = 0.1  # [s, wall] a node that has not come to rest by then may poll, with a short sleep in between
TREE_PERIOD = 0.5  # [s, wall] between two looks for the node's child processes


class NodeRest:
    """Whether a node, and what else has to be idle before time may pass, has nothing left to do."""

    def __init__(
        self,
        stage: Stage,
        node: Callable[[], Optional[Node]],
        others: Sequence[int],
        waits_for_message: Callable[[], bool],
    ) -> None:
        """`others` are process ids of the grader; `waits_for_message` tells whether the node needs one to go on."""
        self._stage = stage
        self._node = node
        self._others = list(others)
        self._waits_for_message = waits_for_message
        self._threads = thread_activity.Threads()
        self._tree: Tuple[float, List[int]] = (0.0, [])  # when it was read, the node's processes
        self._restless = 0  # waits in a row at whose end the node was still busy
        self._polls = False  # it came to rest only by the weaker criterion

    def hold(self, timeout: float = REST_TIMEOUT) -> bool:
        """Hold simulated time until the node is idle, for `timeout` [s, wall] at most; False if it is still busy."""
        if self._restless >= RESTLESS:
            timeout = min(timeout, RESTLESS_TIMEOUT)
        started = time.monotonic()
        if not self._comes_to_rest(timeout):
            self._restless += 1
            return False
        self._restless = 0
        self._stage.exclude_from_deadlines(time.monotonic() - started)
        return True

    def digest(self, executing: bool) -> None:
        """Let the node's callbacks finish before its loop wakes: it finds the newest data, also on a busy machine."""
        exact = executing and not self._restless and not self._polls
        self._comes_to_rest(REST_TIMEOUT if exact else DIGEST)

    def forgive(self) -> None:
        """Forget that it was busy, as a node is while it starts."""
        self._restless = 0

    def is_idle(self, polling: bool = False) -> bool:
        """Whether it has nothing to do now, by the weaker criterion if it polls."""
        node = self._node()
        if self._stage.loop.jobs_waiting or node is None:
            return not self._stage.loop.jobs_waiting
        read, pids = self._tree
        if time.monotonic() - read > TREE_PERIOD:
            pids = thread_activity.tree([node.pid])
            self._tree = time.monotonic(), pids
        return self._threads.at_rest([*self._others, *pids], polling) and not self._stage.loop.jobs_waiting

    def _comes_to_rest(self, timeout: float) -> bool:
        started, self._polls = time.monotonic(), False
        while not self.is_idle(self._polls or self._waits_for_message()):
            waited = time.monotonic() - started
            if waited >= timeout:
                return False
            self._polls = waited > POLLING_AFTER
            self._stage.loop.run_jobs_until(lambda: False, POLL)
        return True
