"""The hand-in's node as a child process: at each GO it lives until the simulated time that the grader names."""

import pickle
import select
import socket
import struct
from subprocess import PIPE, STDOUT
from typing import Any, Callable, List

from robocop_hosting import child

from .. import record as rec
from ..agent import wire
from ..errors import GraderLostError
from ..sandbox.guard import Guard
from ..sandbox.limits import MAX_IDLE, MIN_WORK
from ..submission import CHANNEL
from .channel import UNREADABLE_ANSWER, Channel
from .job import Job
from .output import Output
from .services import Services
from .topics import Topics

NEVER = 1 << 62  # [ns]
MAX_LAST_READS = 1000  # reads after a node has ended; a child of it may go on sending
POLL_PERIOD = 0.005  # [s, wall] between two looks at other things while the node's answer is waited for
ROS_PARAMETERS = {
    "/use_sim_time": True,
    # rospy asks the master for it with every line it logs, unless it is set.
    "/rosout_disable_topics_generation": True,
}


class Node:
    """One node; each line of its output is passed to `on_line`, what it publishes to `topics`.

    The node lives until its process ends for any reason. It has ended when everything that it sent and printed is
    handled.
    """

    def __init__(
        self,
        job: Job,
        topics: Topics,
        services: Services,
        on_line: Callable[[str], object],
        on_wait: Callable[[], object],
        now_ns: int,
        clock_ns: int,
        used: float,
    ) -> None:
        """`on_wait` is called again and again during a turn; `used`: processor time [s] of the part's earlier nodes."""
        mine, theirs = socket.socketpair()
        self._process = child.start(
            [f"{theirs.fileno()},{clock_ns}" if word == CHANNEL else word for word in job.command],
            environment=job.environment,
            folder=job.folder,
            stdout=PIPE,
            stderr=STDOUT,
            pass_fds=[theirs.fileno()],
        )
        theirs.close()
        self._topics, self._services, self._on_wait, self._started_ns = topics, services, on_wait, now_ns
        self._channel = Channel(mine)
        offered = [*topics.begin(), *services.headers()]
        self._channel.send(wire.SETUP, pickle.dumps(({**ROS_PARAMETERS, **job.parameters}, offered)))
        self.next_ns = now_ns  # when the node will do something without having received a message
        self._has_ended = False
        self._ended_because = ""  # if the grader has ended it
        self._guard = Guard(self._process.pid, processor_time=job.cpu_time, used=used)
        assert self._process.stdout is not None
        self._output = Output(self._process.stdout, on_line)

    def has_ended(self) -> bool:
        """Return whether the node has ended; if so, everything that it has sent is handled first."""
        if not self._has_ended and self._has_exited():
            self._finish()
        return self._has_ended

    def how_ended(self, now: float) -> rec.NodeEnd:
        """How the node ended, once it has; `now` is the simulated time [s]."""
        status, reason = self._process.wait(), self._guard.reason or self._ended_because
        if not reason and status in rec.OUT_OF_TIME:
            reason = "it used more processor time than a node may"
        return rec.NodeEnd(now, status, reason)

    @property
    def used(self) -> float:
        """Processor time [s] of this node and the part's earlier nodes."""
        return self._guard.used

    def end(self) -> None:
        """SIGKILL the node and its children. With SIGTERM, shutdown messages would be recorded as errors."""
        self._guard.stop()
        child.kill_tree(self._process.pid)
        self._process.wait()
        self._output.close()
        self._channel.close()

    def run_until(self, until_ns: int, clock_ns: int, meanwhile: Callable[[], object]) -> None:
        """Let the node live until a simulated time [ns], and handle everything that it does until then.

        `clock_ns`: the time on /clock, which the node's loops see when all messages are handled. `meanwhile` is
        called once, while the node works. GraderLostError if the node's answer is one that no agent gives.
        """
        new, messages = self._topics.take()
        if self._has_ended:
            meanwhile()
            return
        for header in new:
            self._channel.send(wire.TOPIC, pickle.dumps(header))
        self._channel.send(wire.GO, wire.go(until_ns - self._started_ns, clock_ns, messages))
        meanwhile()
        self._wait_for_done(until_ns - self._started_ns)
        self._topics.handle_arrived()
        self._output.pass_on()

    def _wait_for_done(self, until_ns: int) -> None:
        """Handle what the node sends, until it says DONE for this time, or has ended."""
        used, idle = self._guard.used, 0  # polls since it has worked
        while True:
            self._on_wait()
            has_more = self._has_more()
            if self._is_done(until_ns):
                break
            if not has_more and self._has_exited():
                self._finish()
                break
            idle += not has_more
            if self._guard.used > used + MIN_WORK:
                used, idle = self._guard.used, 0
            # Not by a clock: on a busy machine it may be the grader that does not run.
            if idle * POLL_PERIOD > MAX_IDLE:
                did = "stopped answering" if self._channel.is_open else "closed its connection to"
                self._ended_because = f"it {did} the grader, which has ended it"
                self.end()
                self._finish()
                break

    def _is_done(self, until_ns: int) -> bool:
        """Handle the frames that have come; return whether the node said DONE for this time."""
        for kind, body in self._channel.frames():
            if kind == wire.DONE and len(body) == wire.TIMES.size:
                done_ns, next_ns = wire.TIMES.unpack(body)
                if done_ns != until_ns:
                    raise GraderLostError("the node's time did not go on")
                self.next_ns = min(NEVER, next_ns + self._started_ns)
                return True
            self._handle(kind, body)
        return False

    def _handle(self, kind: int, body: bytes) -> None:
        try:
            if kind == wire.MESSAGE:
                self._topics.receive(*wire.split(body))
            elif kind == wire.CALL:
                self._channel.send(wire.REPLY, self._services.call(*wire.split(body)))
            elif kind == wire.TOPICS:
                self._topics.update_node_topics(body)
            else:
                raise GraderLostError(UNREADABLE_ANSWER)
        except (struct.error, UnicodeError) as error:
            raise GraderLostError(UNREADABLE_ANSWER) from error

    def _has_more(self) -> bool:
        """Wait a moment; return whether the node has sent something. What it prints is read meanwhile."""
        channel: List[Any] = [self._channel] if self._channel.is_open else []  # a closed one would always be ready
        output: List[Any] = [self._output] if self._output.is_open else []
        ready, writable, _ = select.select(channel + output, channel if self._channel.unsent else [], [], POLL_PERIOD)
        if self._output in ready:
            self._output.read()
        if writable:
            self._channel.write()
        return self._channel in ready and self._channel.read()

    def _has_exited(self) -> bool:
        self._output.read()  # the node may be blocked on a full pipe
        return self._process.poll() is not None

    def _finish(self) -> None:
        """Note that the node has ended, and handle everything that it sent before its end."""
        self._has_ended, self.next_ns = True, NEVER
        for _ in range(MAX_LAST_READS):
            for kind, body in self._channel.frames():
                if kind != wire.DONE:  # of an answer that came as the node was ended
                    self._handle(kind, body)
            if not self._has_more():
                break
        self._topics.handle_arrived()
        self._output.pass_on()
