"""The hand-in's node as a child process: its output line by line, and simulated time with it by way of its agent."""

import contextlib
import pickle
import select
import socket
import struct
import time
from pathlib import Path
from subprocess import PIPE, STDOUT
from typing import Any, Callable, Iterator, List, Mapping, Optional, Sequence, Tuple

from aro_robocop_goto_as.errors import GraderLostError, NoTimeError
from aro_robocop_goto_as.process import child

from ..agent import wire
from ..sandbox.guard import Guard
from ..sandbox.stillness import Stillness
from ..submission import CHANNEL
from .output import Output
from .services import Services
from .topics import Topics

NEVER = 1 << 62  # [ns]
MAX_FRAME = 8 * 1024**2  # bytes
MAX_UNREAD = 16 * 1024**2  # bytes of answers that the node does not read
READ = 1 << 18  # bytes
MAX_LAST_READS = 1000  # of what an ended node has sent; its child may go on
POLL = 0.005  # [s, wall] between two looks at other things while the node's answer is waited for
MAX_IDLE = 45.0  # [s, wall] in which the node does nothing, until its answer is not waited for any more
CLOSE_TIMEOUT = 10.0  # [s, wall] for a node that has closed its connection to end
UNREADABLE = "the node's answer to the grader can't be read"
NOT_READ = "the node does not read the answers of the services that it calls"
CHILD = "rospy in a child process"
NO_TIME = 900.0  # [s, wall] for one answer


class Node:
    """One node; each line of its output is passed to `on_line`, what it publishes to `topics`."""

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        folder: Path,
        on_line: Callable[[str], Any],
        topics: Topics,
        services: Services,
        parameters: Mapping[str, Any],
        now_ns: int,
        clock_ns: int,
        cpu_time: float,
    ) -> None:
        """`cpu_time` [s] of the node and its children together, until they are ended."""
        self._channel, theirs = socket.socketpair()
        self._channel.setblocking(False)
        self._process = child.start(
            [f"{theirs.fileno()},{clock_ns}" if word == CHANNEL else word for word in command],
            environment=environment,
            folder=folder,
            stdout=PIPE,
            stderr=STDOUT,
            pass_fds=[theirs.fileno()],
        )
        theirs.close()
        self._topics, self._services, self._started_ns = topics, services, now_ns
        self._unread, self._unsent = bytearray(), bytearray()
        offered = [*topics.begin(), *services.headers()]
        self._send(wire.SETUP, pickle.dumps((dict(parameters), offered)))
        self.next_ns = now_ns  # when the node will do something without having received a message
        self.ended = ""  # why the node was ended here, if it was
        self._lost = False  # it has ended
        self._is_closed = False  # it sends nothing any more
        self.guard = Guard(self._process.pid, processor_time=cpu_time)
        assert self._process.stdout is not None
        self._output = Output(self._process.stdout, on_line)

    def status(self) -> Optional[int]:
        """The exit status of a node that ended by itself, once all that it sent has arrived; None while it runs."""
        if not self._lost and self._has_ended():
            self._lose()
        return self._process.poll()

    def end(self) -> None:
        """SIGKILL the node and its children. With SIGTERM, shutdown messages would be recorded as errors."""
        self.guard.stop()
        child.kill_tree(self._process.pid)
        self._process.wait()
        self._output.close()
        self._channel.close()

    def go_on(self, until_ns: int, clock_ns: int, meanwhile: Callable[[], object] = lambda: None) -> None:
        """Let the node live until a simulated time [ns]; when this returns, all that it did until then is handled.

        `clock_ns`: the time on /clock, which its loops see when they have handled all messages. `meanwhile` is called
        once, while the node works. GraderLostError if it answers what no agent says.
        """
        new, messages = self._topics.take()
        if self._lost:
            meanwhile()
            return
        for header in new:
            self._send(wire.TOPIC, pickle.dumps(header))
        self._send(wire.GO, wire.go(until_ns - self._started_ns, clock_ns, messages))
        meanwhile()
        answer = self._answer()
        if answer is None:
            self._lose()
            return
        done_ns, next_ns = answer
        if done_ns != until_ns - self._started_ns:
            raise GraderLostError("the node's time did not go on")
        self.next_ns = min(NEVER, next_ns + self._started_ns)
        self._topics.handle_arrived()
        self._output.pass_on()

    # -- the wire --

    def _send(self, kind: int, body: bytes) -> None:
        self._unsent += wire.frame(kind, body)
        self._write()

    def _write(self) -> None:
        with contextlib.suppress(OSError):  # it is full, or the node has ended
            del self._unsent[: self._channel.send(self._unsent)]

    def _answer(self) -> Optional[Tuple[int, int]]:
        """What the node says when it is done; None if it has ended. NoTimeError if the machine has no time for it."""
        deadline, stillness = time.monotonic() + NO_TIME, Stillness(self._process.pid)
        while True:
            for kind, body in self._frames():
                if kind == wire.DONE and len(body) == wire.ANSWER.size:
                    done_ns, next_ns, _ = wire.ANSWER.unpack(body)
                    return done_ns, next_ns
                self._handle(kind, body)
            if not self._has_more() and self._has_ended():
                return None
            now = time.monotonic()
            if self._is_closed:
                deadline = min(deadline, now + CLOSE_TIMEOUT)
            elif now > deadline:
                raise NoTimeError(f"the node's turn was not over within {NO_TIME:g} s")
            if stillness.look() > MAX_IDLE or now > deadline:
                did = "closed its connection to" if self._is_closed else "stopped answering"
                self.ended = f"it {did} the grader, which has ended it"
                self.end()
                return None

    def _handle(self, kind: int, body: bytes) -> None:
        try:
            if kind == wire.MESSAGE:
                self._topics.receive(*wire.split(body))
            elif kind == wire.CALL:
                self._send(wire.REPLY, self._services.call(*wire.split(body)))
                if len(self._unsent) > MAX_UNREAD:
                    raise GraderLostError(NOT_READ)
            elif kind == wire.TOPICS:
                self._topics.tell(body)
            elif kind == wire.CHILD:
                self._topics.programs.add(CHILD)
            else:
                raise GraderLostError(UNREADABLE)
        except (struct.error, UnicodeError) as error:
            raise GraderLostError(UNREADABLE) from error

    def _frames(self) -> Iterator[Tuple[int, bytes]]:
        """What has been read."""
        while len(self._unread) >= wire.HEAD.size:
            size, kind = wire.HEAD.unpack_from(self._unread)
            end = wire.HEAD.size + size
            if size > MAX_FRAME:
                raise GraderLostError(UNREADABLE)
            if len(self._unread) < end:
                return
            body = bytes(self._unread[wire.HEAD.size : end])
            del self._unread[:end]
            yield kind, body

    def _has_more(self) -> bool:
        """Wait a moment; whether the node has sent something. What it prints is read meanwhile."""
        channel: List[Any] = [] if self._is_closed else [self._channel]  # a closed one would always be ready
        output: List[Any] = [self._output] if self._output.is_open else []
        ready, writable, _ = select.select(channel + output, channel if self._unsent else [], [], POLL)
        if self._output in ready:
            self._output.read()
        if writable:
            self._write()
        data = b""
        if self._channel in ready:
            with contextlib.suppress(OSError):
                data = self._channel.recv(READ)
                self._is_closed = not data
            self._unread += data
        return bool(data)

    def _has_ended(self) -> bool:
        self._output.read()  # it may wait for that
        return self._process.poll() is not None

    def _lose(self) -> None:
        """The node has ended: what it has sent before counts."""
        self._lost, self.next_ns = True, NEVER
        for _ in range(MAX_LAST_READS):
            for kind, body in self._frames():
                self._handle(kind, body)
            if self.ended or not self._has_more():
                break
        self._topics.handle_arrived()
        self._output.pass_on()
